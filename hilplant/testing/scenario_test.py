"""One scenario as a test: run it, or take a recording of it, and judge all that it expects."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hilplant.bench import Bench, load_bench
from hilplant.ecu.loop_controller import Inside, seated
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.simulation.player import commands_relays
from hilplant.simulation.scenario import Scenario, load_scenario
from hilplant.testing.evidence import Evidence, recorded
from hilplant.testing.known_signals import DatabaseSignals, database_signals, protections_of
from hilplant.testing.virtual_bench import VirtualBench
from hilplant.units import SECOND_NS
from hilplant.verdicts.arrays import judge
from hilplant.verdicts.binding import bind
from hilplant.verdicts.expectations import Expectation
from hilplant.verdicts.judgement import Judgement, Ruling

#: From the worst to the best: a test is what the worst of its expectations is.
RULINGS: tuple[Ruling, ...] = ("fail", "inconclusive", "blocked", "pass")


@dataclass(frozen=True)
class Judged:
    """An expectation and what came of it."""

    expectation: Expectation
    judgement: Judgement


def ruling_of(judged: Sequence[Judged]) -> Ruling:
    """Return the worst ruling; blocked where nothing was expected, because nothing was tested."""
    found = {each.judgement.ruling for each in judged}
    return next((ruling for ruling in RULINGS if ruling in found), "blocked")


@dataclass(frozen=True)
class ScenarioTest:
    """A scenario that was run, with its evidence, and what came of each expectation.

    `rerun` is the command line that does it again; `record` writes the run to a file where it is not from one. `faults`
    are the times at which faults came and went, by their names; `drawn` are the expectations as a report shows them,
    where they were drawn in another process and the evidence has stayed there.
    """

    scenario: Scenario
    bench_name: str
    step_s: float
    evidence: Evidence
    database: DatabaseSignals
    judged: tuple[Judged, ...]
    rerun: str
    record: Callable[[Path], None] | None = None
    faults: Mapping[str, float] = field(default_factory=dict)
    drawn: Sequence[Mapping[str, Any]] | None = None

    @property
    def name(self) -> str:
        """The scenario's title, or its file's name."""
        return self.scenario.title or self.scenario.path.stem

    @property
    def ruling(self) -> Ruling:
        """The worst ruling of all that is expected."""
        return ruling_of(self.judged)


def run_virtually(
    scenario: Scenario,
    bench: Bench,
    stand_in: bool = True,
    bench_name: str | None = None,
    inside: Inside | None = None,
) -> ScenarioTest:
    """Run a scenario in virtual time, and judge it; `bench_name` is what the user has called the bench.

    With a controller `inside` the loop no stand-in ECU joins.

    Raises
    ------
    Failure
        When the scenario commands relays, which a controller does, or when the controller was stopped.

    """
    seat = None
    if inside is not None:
        if commands_relays(scenario):
            raise Failure(
                f"{scenario.path}: it commands relays, as the controller {inside.controller} does; leave one out"
            )
        bench, seat = seated(bench, inside)
    database = database_signals(bench.sources, protections_of(bench))
    expectations = expected(scenario, database, bench.step_ns)
    virtual = VirtualBench(bench, scenario, stand_in and seat is None)
    if seat is not None:
        virtual.seat(seat.drive)
    virtual.run_scenario()
    if seat is not None and seat.stopped:
        raise Failure(f"{scenario.path}: {seat.stopped}")
    options = (f" --bench {bench_name}" if bench_name else "") + ("" if stand_in else " --ecu external")
    options += "" if inside is None else f" --controller {inside.controller} --reference {inside.reference}"
    rerun = f"hilplant test {scenario.path}{options}"
    done = judged(scenario, bench.name, virtual.evidence(), database, expectations, rerun)
    return replace(done, record=virtual.record)


def judge_recording(path: Path, scenario_name: str, bench_name: str | None = None) -> ScenarioTest:
    """Judge a recording by what a scenario expects; its first tick is time 0.

    The database is the recording's own. Only rules about counters and checksums need the bench.
    """
    recording, scenario = read_recording(path), load_scenario(scenario_name)
    named = bench_name or scenario.bench
    protections = protections_of(load_bench(named)) if named else {}
    database = database_signals(recording.run.sources, protections)
    expectations = expected(scenario, database, recording.run.step_ns)
    rerun = f"hilplant judge {path} {scenario.path}" + (f" --bench {bench_name}" if bench_name else "")
    return judged(scenario, recording.run.name, recorded(recording), database, expectations, rerun)


def expected(scenario: Scenario, database: DatabaseSignals, step_ns: int) -> list[Expectation]:
    """Return what a scenario expects, on the signals that there are; BenchError for what there is not."""
    return bind(scenario.expect, database.known(step_ns / SECOND_NS, scenario.seconds, scenario.marks))


def ticks_of(scenario: Scenario, step_ns: int) -> int:
    """Return the length of a scenario in ticks."""
    return round(scenario.seconds * SECOND_NS / step_ns)


def judged(  # noqa: PLR0913, PLR0917
    scenario: Scenario,
    bench_name: str,
    evidence: Evidence,
    database: DatabaseSignals,
    expectations: list[Expectation],
    rerun: str,
) -> ScenarioTest:
    """Judge what was expected on what was found."""
    trace = evidence.trace(expectations, database, ticks_of(scenario, evidence.step_ns))
    found = tuple(Judged(each, judge(each, trace)) for each in expectations)
    return ScenarioTest(
        scenario, bench_name, trace.step_s, evidence, database, found, rerun, faults=evidence.fault_marks()
    )
