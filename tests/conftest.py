"""Settings of all tests: random searches repeat the same examples, so that a failure is never a matter of luck.

To search anew: HILPLANT_SEARCH=1 python -m pytest tests/property
"""

import os

import pytest
from hypothesis import settings

# what an example takes depends on who else has the processor
settings.register_profile("same examples", derandomize=True, deadline=None)
settings.register_profile("new examples", derandomize=False, deadline=None)
settings.load_profile("new examples" if os.environ.get("HILPLANT_SEARCH") else "same examples")

#: The files that take longest, the longest first. One that starts last would be waited for while processors idle.
LONGEST = (
    "test_identify_twin", "test_plant_in_c", "test_benchmarks_run", "test_source_command", "test_one_declaration",
    "test_plant_reduced", "test_networks_on_the_bus", "test_surrogates_on_the_bus", "test_plant_parked",
    "test_shipped_suite", "test_networks_in_c", "test_control_against_solver",
)  # fmt: skip
#: Files whose tests wait for the machine's clock most of the time: one after the other, beside those that compute.
CLOCKED = {
    "test_channel_processes", "test_controller_inside_the_daemon", "test_daemon_ends", "test_daemon_start",
    "test_demo_run", "test_on_an_interface", "test_own_controller", "test_pages_end", "test_pytest_plugin",
    "test_recording_loss", "test_recording_processes", "test_scenario_on_the_clock",
}  # fmt: skip


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.stem in CLOCKED:
            item.add_marker(pytest.mark.clocked)
    items.sort(key=lambda item: LONGEST.index(item.path.stem) if item.path.stem in LONGEST else len(LONGEST))
