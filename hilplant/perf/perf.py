"""`hilplant perf`: runs the parts, prints their table, returns their figures."""

from importlib import import_module

from rich.console import Console

from hilplant.failure import Failure
from hilplant.perf.machine import machine
from hilplant.perf.results import Measured, NotMeasurable
from hilplant.perf.table import print_table

#: The parts in their order, and the function that measures each.
PARTS = {
    "step": "step_cost.measure",
    "simulate": "simulate_cost.measure",
    "batch": "batch_cost.measure",
    "torque-network": "torque_network.measure",
    "networks": "networks_cost.measure",
    "tick": "tick_cost.measure",
    "tick-vcan": "tick_vcan.measure",
    "wakeup": "wakeup.measure",
    "memory": "memory.measure",
    "startup": "startup.measure",
    "memory-10h": "memory.measure_full",
}
#: What takes longer than a coffee runs only when it is named.
_ONLY_WHEN_NAMED = ("memory-10h",)


def measure_and_print(only: str | None = None) -> dict[str, float | str]:
    """Measure the parts in `only`, or all; print each figure beside its limit and return the figures."""
    names = chosen_parts(only)
    described = machine()
    parts = {name: _measured(name) for name in names}
    print_table(parts, "{}, {} cores; {}; Python {}; numba {}; load before {}".format(*described.values()))
    figures = dict(described)
    for measured in parts.values():
        figures |= measured.figures
    return figures


def chosen_parts(only: str | None) -> list[str]:
    """Return the names of the wanted parts, in their order."""
    if only is None:
        return [name for name in PARTS if name not in _ONLY_WHEN_NAMED]
    wanted = [word.strip() for word in only.split(",") if word.strip()]
    unknown = [word for word in wanted if word not in PARTS]
    if unknown or not wanted:
        raise Failure(f"--only: no part {', '.join(unknown) or 'named'}; there are {', '.join(PARTS)}")
    return [name for name in PARTS if name in wanted]


def _measured(name: str) -> Measured:
    """Measure one part; what cannot be measured here leaves its reason behind."""
    module, _, function = PARTS[name].partition(".")
    try:
        with Console(stderr=True).status(f"measuring {name}"):
            result: Measured = getattr(import_module(f"hilplant.perf.{module}"), function)()
    except NotMeasurable as reason:
        return Measured(remarks=[f"not measured: {reason}"])
    return result
