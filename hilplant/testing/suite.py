"""Several scenarios as tests, and the files that tell what came of them."""

import math
import multiprocessing
import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from hilplant import resources
from hilplant.bench import Bench, load_bench
from hilplant.ecu.loop_controller import Inside
from hilplant.failure import Failure
from hilplant.simulation.scenario import Scenario, load_scenario
from hilplant.testing.scenario_test import RULINGS, ScenarioTest, run_virtually
from hilplant.testing.virtual_bench import VirtualBench

DEFAULT_BENCH = "default"
#: A test that takes more than this part of a process's share is a long one.
_LONG = 10


@dataclass
class Benches:
    """Benches that were loaded, by name: many scenarios share one."""

    loaded: dict[str, Bench] = field(default_factory=dict)

    def named(self, name: str) -> Bench:
        """Return a bench, loaded once."""
        if name not in self.loaded:
            self.loaded[name] = load_bench(name)
        return self.loaded[name]


def scenario_files(names: Sequence[str]) -> list[Path]:
    """Return the files that are named: files, folders of them, or shipped tests; without a name the shipped suite."""
    found: list[Path] = []
    for name in names or [str(resources.shipped("config", "tests"))]:
        if Path(name).is_dir():
            inside = sorted(Path(name).glob("*.yaml"))
            if not inside:
                raise Failure(f"{name}: no .yaml file in this folder")
            found += inside
        else:
            found.append(_shipped_scenario(name) or resources.named("tests", name))
    return found


def _shipped_scenario(name: str) -> Path | None:
    """Return the scenario of this mere name that is shipped and is no test of an ECU."""
    scenario = resources.shipped("config", "scenarios", f"{name}.yaml")
    return scenario if scenario.is_file() and not Path(name).is_file() else None


@dataclass(frozen=True)
class Where:
    """Where scenarios run: on a `channel` of the bench's interface, None for virtual time; in how many processes.

    In virtual time a velocity controller may be inside the loop; on a channel the real clock may have another `pace`
    than the bench's. `drawn` says that a report of the tests is wanted.
    """

    channel: str | None = None
    stand_in: bool = True
    jobs: int | None = None
    inside: Inside | None = None
    pace: float | None = None
    drawn: bool = False


def run_tests(
    paths: Iterable[Path], bench_name: str | None, where: Where, tell: Callable[[ScenarioTest], None]
) -> list[ScenarioTest]:
    """Run scenarios, all read before the first runs; `tell` hears of each when it is judged, in their order."""
    benches = Benches()
    scenarios: list[Scenario] = [load_scenario(path) for path in paths]
    for scenario in scenarios:
        if not scenario.expect:
            raise Failure(f"{scenario.path}: expects nothing, so that it tests nothing; give it an `expect` section")
    used = [benches.named(bench_name or each.bench or DEFAULT_BENCH).at(pace=where.pace) for each in scenarios]
    orders = [
        _Order(scenario, bench, where.stand_in, bench_name, where.inside)
        for scenario, bench in zip(scenarios, used, strict=True)
    ]
    done = []
    for test in _on_interface(orders, where.channel) if where.channel else _results(orders, benches, where):
        done.append(test)
        tell(test)
    return done


class _Order(NamedTuple):
    """A scenario that is to be run."""

    scenario: Scenario
    bench: Bench
    stand_in: bool
    bench_name: str | None
    inside: Inside | None


#: What the workers are to do; they are copies of this process and find it here.
_ORDERS: list[_Order] = []


def _on_interface(orders: list[_Order], channel: str) -> Iterator[ScenarioTest]:
    """Run all on a channel, one after the other."""
    from hilplant.testing.on_interface import run_on_interface

    for order in orders:
        yield run_on_interface(order.scenario, order.bench, channel, order.stand_in, order.bench_name)


def _results(orders: list[_Order], benches: Benches, where: Where) -> Iterator[ScenarioTest]:
    """Run all, and give them in their order; on several CPUs where the system can copy a process that is compiled.

    The long ones begin first: one that began last would keep all but one CPU waiting.
    """
    cpus = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    workers = min(where.jobs or cpus, len(orders))
    if workers < 2 or "fork" not in multiprocessing.get_all_start_methods():
        yield from (run_virtually(*order) for order in orders)
        return
    for bench in benches.loaded.values():
        VirtualBench(bench).run(1)
    _ORDERS[:] = orders
    with multiprocessing.get_context("fork").Pool(workers) as pool:
        long_s = sum(order.scenario.seconds for order in orders) / workers / _LONG
        begins = sorted(range(len(orders)), key=lambda number: orders[number].scenario.seconds < long_s)
        begun = {number: pool.apply_async(_run, (number, where.drawn)) for number in begins}
        yield from (begun[number].get() for number in range(len(orders)))


def _run(number: int, drawn: bool) -> ScenarioTest:
    """Run one test in a process of its own, and draw it there: the evidence, a megabyte a second, stays behind."""
    done = run_virtually(*_ORDERS[number])
    if drawn:
        from hilplant.testing.report import drawn_expectations

        done = replace(done, drawn=drawn_expectations(done))
    nothing = replace(done.evidence, rows=done.evidence.rows[:0], frame_ticks=done.evidence.frame_ticks[:0], frames=())
    return replace(done, record=None, evidence=nothing)


def figures_of(tests: Sequence[ScenarioTest]) -> dict[str, Any]:
    """Return counts, and each test with its expectations."""
    count = Counter(test.ruling for test in tests)
    return (
        {"tests": len(tests)} | {ruling: count[ruling] for ruling in RULINGS} | {"results": [_told(t) for t in tests]}
    )


def _told(test: ScenarioTest) -> dict[str, Any]:
    expectations = [
        {
            "place": each.expectation.place,
            "text": each.expectation.text,
            "ruling": each.judgement.ruling,
            "robustness": each.judgement.robustness if math.isfinite(each.judgement.robustness) else None,
            "unit": each.expectation.unit,
            "time_s": None if each.judgement.tick is None else each.judgement.tick * test.step_s,
            "reason": each.judgement.reason,
            "values": each.judgement.values,
        }
        for each in test.judged
    ]
    return {
        "name": test.name,
        "file": str(test.scenario.path),
        "requirement": test.scenario.requirement,
        "bench": test.bench_name,
        "ruling": test.ruling,
        "rerun": test.rerun,
        "expectations": expectations,
    }


def summary_of(tests: Sequence[ScenarioTest]) -> str:
    """Return one line: how many tests, and how many of each ruling."""
    count = Counter(test.ruling for test in tests)
    told = ", ".join(f"{count[ruling]} {ruling}" for ruling in reversed(RULINGS) if count[ruling])
    return f"{len(tests)} tests: {told}"
