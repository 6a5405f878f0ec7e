"""What `hilplant run` does: a bench on its interface, with a recorder beside it when one is asked for."""

import contextlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

from hilplant.bench import Bench, load_bench
from hilplant.cli.voice import Voice
from hilplant.extras import need
from hilplant.failure import Failure
from hilplant.recording.rotation import Rotation
from hilplant.runtime.loop import ROW_WIDTH, Control
from hilplant.runtime.ring import Ring
from hilplant.runtime.scheduling import Privilege
from hilplant.runtime.server import StopRequest, Summary, ended_by_signals, serve
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: Counts that the line before the faults has told already.
_NO_FAULTS = ("tick", "overruns", "worst_latency_us")


class Record(NamedTuple):
    """Where to record to, and where its parts end."""

    path: Path
    rotation: Rotation = Rotation()


@contextmanager
def recording(bench: Bench, record: Record | None) -> Iterator[Ring]:
    """Give the loop a ring, which another process drains into files where the run is to be recorded.

    Raises
    ------
    Failure
        At the end, when something of the run was not recorded.
    """
    if record is None:
        with contextlib.closing(Ring.create(ROW_WIDTH)) as ring:  # for whoever wants to look
            yield ring
        return
    need("recording")
    from hilplant.recording.recorder import start_recorder

    ring = Ring.create(ROW_WIDTH)
    try:
        recorder = start_recorder(ring, record.path, bench, bench.loop.cpu, record.rotation)
        try:
            yield ring
        finally:
            recorder.finish()
            if not ring.rows_written:  # nothing has started: an empty recording would be in the way of the next attempt
                recorder.remove()
    finally:
        ring.close()


class Inside(NamedTuple):
    """A velocity controller inside the loop: its name in the catalogue, and the wanted speed as it is written."""

    controller: str
    reference: str


def run_daemon(
    name: str, seconds: float | None, record: Record | None, channel: str | None, inside: Inside | None = None
) -> Summary:
    """Serve a bench and say on the terminal how it started and how it ended."""
    bench = load_bench(name)
    if channel is not None:
        bench = replace(bench, interface={**bench.interface, "channel": channel})
    control: Control | None = None
    if inside is not None:
        bench, control = seated(bench, inside)
    summary: Summary | None = None
    stop, voice = StopRequest(), Voice()
    try:
        with ended_by_signals(stop), recording(bench, record) as ring:  # signals end the run, not the recorder's work
            on_start = partial(_say_start, bench, voice)
            summary = serve(bench, seconds, ring, stop, on_start, control)
    except Failure as failure:
        if summary is None:
            raise
        summary.recording_complete = False  # the run itself is told all the same
        voice.say(str(failure), err=True)
    _say_end(summary, record, voice)
    return summary


def seated(bench: Bench, inside: Inside) -> tuple[Bench, Control]:
    """Return the bench as a controller inside its loop needs it, and what its loop calls.

    Relays and supply are the controller's alone, so nobody waits for frames that command them; what else such a frame
    carries is taken as before.
    """
    from hilplant.control.catalogue import controller_named, without_network  # slow to load, and seldom wanted
    from hilplant.control.reference import parse_reference
    from hilplant.control.seat import COMMANDED, LoopSeat

    reference = parse_reference(inside.reference)
    controller = controller_named(inside.controller, bench.parameters.motor, bench.step_ns / SECOND_NS)
    seat = LoopSeat(controller, without_network(), reference, bench.parameter_row)
    received = (replace(m, timeout_ns=0) if COMMANDED & set(m.targets) else m for m in bench.receive)
    return replace(bench, receive=tuple(received)), seat.drive


def _say_start(bench: Bench, voice: Voice, privileges: list[Privilege]) -> None:
    interface = " ".join(str(value) for value in bench.interface.values())
    missing = [f"  without {p.name}: {p.mend}" for p in privileges if not p.granted]
    step_ms = bench.step_ns / MILLISECOND_NS
    voice.say(f"{bench.name} serves on {interface}, a tick every {step_ms:g} ms; Ctrl-C ends it")
    for line in missing:
        voice.say(line, err=True)
    if missing:
        voice.say("  punctuality is not what it could be: hilplant doctor says more", err=True)


def _say_end(summary: Summary, record: Record | None, voice: Voice) -> None:
    voice.say(
        f"{summary.ticks} ticks, {summary.overruns} overruns, late by p50 {summary.latency_p50_us:g} us, "
        f"p99 {summary.latency_p99_us:g} us, at most {summary.latency_max_us:.0f} us"
    )
    faults = {name: count for name, count in summary.counts.items() if count and name not in _NO_FAULTS}
    if faults:
        voice.say("faults: " + ", ".join(f"{name} {count}" for name, count in faults.items()))
    if record is not None and summary.recording_complete:
        voice.say(f"recorded to {record.path}" + (", in parts" if record.rotation.in_parts else ""))
    if summary.stopped_by_overrun:
        voice.say("stopped: a tick came late and the bench says on_overrun: stop", err=True)
    if summary.fell_behind:
        voice.say("behind: more of a second was lost than lost_time of the bench's loop allows", err=True)
