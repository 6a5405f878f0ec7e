"""In virtual time quiet ticks are taken several at once: rows, frames and events are those of tick by tick."""

from pathlib import Path

import pytest

from hilplant.bench import Bench, load_bench
from hilplant.simulation.scenario import load_scenario
from hilplant.testing.virtual_bench import VirtualBench
from hilplant.testing.wiper import WiperUnderTest

FILES = sorted((Path(__file__).parents[1] / "data" / "on_a_bus").glob("0[2467]_*.yaml"))
#: What changes between two polls of the ECU: contacts that bounce, frames that wait, a supply that steps, a lost link.
LIVELY = """
seconds: 1.5
stalk: [[0.1, slow]]
signals: {supply_v: [[0, 13], [0.503, 8], [0.704, {ramp_to: 14, seconds: 0.05}]], screen: [[0.301, wet]]}
faults:
  - {fault: park_bounces, with: {time_s: 0.006}, at: 0.2, for: 0.6}
  - {fault: frames_delayed, with: {time_s: 0.003}, message: MotorStatus, at: 0.4, for: 0.3}
  - {fault: open_53, at: 0.853, for: 0.1}
  - {fault: weak_magnets, with: {factor: 0.7}, at: 1.0, for: 0.2, ramp: 0.1}
  - {fault: bus_off, direction: from plant, at: 1.2, for: 0.1}
"""


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("polynomial")


def ended(virtual: VirtualBench) -> tuple[bytes, bytes, bytes]:
    tape = virtual.tape
    return tape.read_rows().tobytes(), tape.read_frames().tobytes(), tape.read_events().tobytes()


def both_ways(bench: Bench, path: Path) -> tuple[VirtualBench, VirtualBench]:
    scenario = load_scenario(path)
    quiet, each = VirtualBench(bench, scenario), VirtualBench(bench, scenario)
    quiet.run_scenario()
    player = each.player
    assert player is not None
    while each.ticks < quiet.ticks:
        each._loop.tick(each.now_ns)
        each._poll()
    return quiet, each


@pytest.mark.parametrize("path", FILES, ids=[path.stem for path in FILES])
def test_files_run_as_tick_by_tick(bench: Bench, path: Path) -> None:
    quiet, each = both_ways(bench, path)
    assert ended(quiet) == ended(each)


def test_lively_runs_are_as_tick_by_tick(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "lively.yaml"
    path.write_text(LIVELY)
    quiet, each = both_ways(bench, path)
    assert ended(quiet) == ended(each)
    assert len(quiet.tape.events) > 6


def test_many_ticks_are_taken_at_once(bench: Bench) -> None:
    """Else nothing is compared above."""
    virtual, calls = VirtualBench(bench), 0
    while virtual.ticks < 1000:
        virtual.step(1000 - virtual.ticks)
        calls += 1
    assert calls < 300


def test_a_test_that_lets_time_pass_sees_what_single_ticks_show(bench: Bench) -> None:
    runs = []
    for at_once in (True, False):
        wiper = WiperUnderTest(bench)
        for signals in ({"RelayOn": 1}, {"RelayOn": 1, "RelayFast": 1}, {"RelayOn": 0}):
            wiper.send("RelayCommand", **signals)
            for _ in range(1 if at_once else 333):
                wiper.run(0.333 if at_once else 0.001)
            wiper.set(supply_v=11.0)
        runs.append(ended(wiper.virtual))
    assert runs[0] == runs[1]
