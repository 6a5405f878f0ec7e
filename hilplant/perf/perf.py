"""All benchmarks: runs the parts that are wanted, and returns what each came to."""

from importlib import import_module
from typing import NamedTuple

from hilplant.failure import Failure
from hilplant.perf.machine import machine
from hilplant.perf.results import NotMeasurable, PartResult
from hilplant.progress import OnProgress, ProgressReport, unseen

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


class Benchmarks(NamedTuple):
    """What was measured on which machine: parts by name in their order."""

    machine: dict[str, float | str]
    parts: dict[str, PartResult]

    @property
    def figures(self) -> dict[str, float | str]:
        """The flat figures of machine and parts."""
        figures = dict(self.machine)
        for measured in self.parts.values():
            figures |= measured.figures
        return figures


def measure(only: str | None = None, on_progress: OnProgress = unseen) -> Benchmarks:
    """Measure the parts in `only`, names with commas between, or all."""
    names = chosen_parts(only)
    described, parts = machine(), dict[str, PartResult]()
    for done, name in enumerate(names):
        on_progress(ProgressReport(f"measuring {name}", done, len(names)))
        parts[name] = _measured(name)
    return Benchmarks(described, parts)


def chosen_parts(only: str | None) -> list[str]:
    """Return the names of the wanted parts, in their order."""
    if only is None:
        return [name for name in PARTS if name not in _ONLY_WHEN_NAMED]
    wanted = [word.strip() for word in only.split(",") if word.strip()]
    unknown = [word for word in wanted if word not in PARTS]
    if unknown or not wanted:
        raise Failure(f"--only: no part {', '.join(unknown) or 'named'}; there are {', '.join(PARTS)}")
    return [name for name in PARTS if name in wanted]


def _measured(name: str) -> PartResult:
    """Measure one part; what cannot be measured here leaves its reason behind."""
    module, _, function = PARTS[name].partition(".")
    try:
        result: PartResult = getattr(import_module(f"hilplant.perf.{module}"), function)()
    except NotMeasurable as reason:
        return PartResult(remarks=[f"not measured: {reason}"])
    return result
