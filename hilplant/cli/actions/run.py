"""What `hilplant run` does: a bench on its interface, with a recorder beside it when one is asked for."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hilplant.bench import Bench, load_bench
from hilplant.bench.assembly import initial_state
from hilplant.bus.mapping import NO_CHOICE
from hilplant.channel.beside_loop import announced, door_begun
from hilplant.cli.voice import Voice
from hilplant.companion import Companion
from hilplant.ecu.loop_controller import Inside, seated
from hilplant.failure import Failure
from hilplant.operator_page.beside_run import PageOptions, page_beside
from hilplant.recording.beside_loop import RecordTo, recording
from hilplant.runtime.loop import Loop
from hilplant.runtime.ring import Ring
from hilplant.runtime.scheduling import Privilege
from hilplant.runtime.server import StopRequest, Summary, ended_by_signals, serve
from hilplant.units import MILLISECOND_NS

#: Counts that the line before the faults has told already.
_NO_FAULTS = ("tick", "overruns", "worst_latency_us")

if TYPE_CHECKING:
    from hilplant.cli.actions.live_judge import Verdict
    from hilplant.control.own import OwnLoopSeat
    from hilplant.control.seat import LoopSeat
    from hilplant.simulation.scenario import Scenario


class Played(NamedTuple):
    """A scenario that the loop is to play, and whether it is judged beside it."""

    path: Path
    judged: bool


def run_daemon(  # noqa: PLR0913, PLR0917
    name: str,
    seconds: float | None,
    record: RecordTo | None,
    channel: str | None,
    inside: Inside | None = None,
    door: bool = True,
    page: PageOptions | None = None,
    scenario: Played | None = None,
    pace: float | None = None,
) -> Summary:
    """Serve a bench and say on the terminal how it started and how it ended."""
    with door_begun(door) as opening:
        return _run(name, seconds, record, channel, inside, opening, page, scenario, pace)


def _run(  # noqa: PLR0913, PLR0917
    name: str,
    seconds: float | None,
    record: RecordTo | None,
    channel: str | None,
    inside: Inside | None,
    door: Companion | None,
    page: PageOptions | None,
    scenario: Played | None,
    pace: float | None,
) -> Summary:
    played = None if scenario is None else _read(scenario.path)
    bench = _loaded(name, played).at(channel, pace)
    seat: LoopSeat | OwnLoopSeat | None = None
    if inside is not None:
        bench, seat = seated(bench, inside)
    summary: Summary | None = None
    stop, voice = StopRequest(), Voice()
    with ended_by_signals(stop):  # they end the run, not the recorder's work, nor what is said of it
        try:
            with (
                recording(bench, record) as ring,
                announced(bench, ring, door) as run,
                page_beside(bench, run, page) as served,
            ):
                if served is not None:
                    voice.say(f"page: {served.said}")
                on_start, prepare = partial(_say_start, bench, voice), partial(_prepare, seat)
                if played is None:
                    summary = serve(bench, seconds, ring, stop, on_start, prepare)
                else:
                    with _judge(name, scenario, played, ring, bench.loop.cpu) as verdict:
                        play = partial(_play, played, bench, stop, prepare)
                        summary = serve(bench, seconds, ring, stop, on_start, play)
                        ring.close_writer()
                    summary.scenario_ruling = "" if verdict is None else verdict.ruling
        except Failure as failure:
            if summary is None:
                raise
            summary.recording_complete = False  # the run itself is told all the same
            voice.say(str(failure), err=True)
        _say_end(summary, record, voice)
        if seat is not None and summary.controller_stopped:
            voice.say(f"{seat.stopped}; relays opened", err=True)
    return summary


def _read(path: Path) -> "Scenario":
    """Read a scenario; what it takes is loaded for those that play one."""
    from hilplant.simulation.scenario import load_scenario

    return load_scenario(path)


def _loaded(name: str, played: "Scenario | None") -> Bench:
    """Return the bench, at the scenario's start if one is played."""
    bench = load_bench(name)
    if played is not None:
        bench = replace(bench, state_row=initial_state(bench.parameters, bench.initial | played.initial))
    return bench


def _judge(
    name: str, scenario: Played | None, played: "Scenario", ring: Ring, loop_cpu: int | None
) -> "AbstractContextManager[Verdict | None]":
    """Return what judges beside the loop, if there is anything to judge."""
    if scenario is None or not scenario.judged or not played.expect:
        return nullcontext()
    from hilplant.cli.actions.live_judge import judging

    return judging(name, played.path, ring, loop_cpu)


def _prepare(seat: "LoopSeat | OwnLoopSeat | None", loop: Loop) -> None:
    """Give the loop what is inside it."""
    if seat is None:
        return
    loop.control = seat.drive
    if loop.intake is not None:
        loop.intake.controlled = True


def _play(scenario: "Scenario", bench: Bench, stop: StopRequest, prepare: Callable[[Loop], None], loop: Loop) -> None:
    """Let the loop play a scenario, and end with it."""
    from hilplant.simulation.player import ScenarioPlayer

    prepare(loop)
    if loop.intake is not None:
        faults = loop.intake.faults
        loop.intake.source = ScenarioPlayer(scenario, bench, (faults, faults.transport, loop.line), stop.ask)


def _say_start(bench: Bench, voice: Voice, privileges: list[Privilege]) -> None:
    interface = " ".join(str(value) for value in bench.interface.values())
    missing = [f"  without {p.name}: {p.fix}" for p in privileges if not p.granted]
    step_ms = bench.step_ns / MILLISECOND_NS
    voice.say(f"{bench.name} serves on {interface}, a tick every {step_ms:g} ms; Ctrl-C ends it")
    if bench.pace != 1.0:
        voice.say(
            f"  pace {bench.pace:g}: a second here takes {1 / bench.pace:g} s; what else is on the bus must be as slow"
        )
    if bench.interface.get("interface") == "virtual":
        voice.say(
            "  interface virtual: no other process can reach it; hilplant vcan, or the bench multicast, can be reached",
            err=True,
        )
    for line in missing:
        voice.say(line, err=True)
    if missing:
        voice.say("  punctuality is not what it could be: hilplant doctor says more", err=True)


def _say_end(summary: Summary, record: RecordTo | None, voice: Voice) -> None:
    voice.say(
        f"{summary.ticks} ticks, {summary.overruns} overruns, late by p50 {summary.latency_p50_us:g} us, "
        f"p99 {summary.latency_p99_us:g} us, at most {summary.latency_max_us:.0f} us"
    )
    faults = {name: count for name, count in summary.counts.items() if count and name not in _NO_FAULTS}
    if faults:
        voice.say("faults: " + ", ".join(f"{name} {count}" for name, count in faults.items()))
    for name, value in summary.out_of_range.items():
        said = "a value without a choice" if value == NO_CHOICE else f"{value:g}"
        voice.say(f"  out of range: {name}, last {said}")
    if record is not None and summary.recording_complete:
        voice.say(f"recorded to {record.path}" + (", in parts" if record.rotation.in_parts else ""))
    if summary.stopped_by_overrun:
        voice.say("stopped: a tick came late and the bench says on_overrun: stop", err=True)
    if summary.fell_behind:
        voice.say("behind: more of a second was lost than lost_time of the bench's loop allows", err=True)
