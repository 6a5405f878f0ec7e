"""The demonstration's own process: the plant's loop, and beside it the ECU as a thread.

An in-memory bus does not reach beyond its process, so the ECU must be in here; it wakes every 5 ms.
"""

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import NamedTuple

from hilplant.bench import Bench, load_bench
from hilplant.bus.transport import open_transport
from hilplant.channel.beside_loop import announced, door_begun
from hilplant.companion import Companion
from hilplant.demo.sequence import DemoSequence
from hilplant.ecu.node import EcuNode, run_ecu
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import StalkSource, TypedStalk, stalk_at
from hilplant.ecu.vocabulary import INTERVALS
from hilplant.operator_page.beside_run import PageOptions, page_beside
from hilplant.recording.beside_loop import RecordTo, recording
from hilplant.runtime.clock import WallClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.server import StopRequest, Summary, serve
from hilplant.signals import INPUT_INDEX
from hilplant.units import MILLISECOND_NS

BENCH = "virtual"
_ECU_PAUSE_NS = 5 * MILLISECOND_NS


class Started(NamedTuple):
    """The loop runs; its newest row is in this ring, its page, if there is one, at this address."""

    ring: str
    page: str = ""


class Failed(NamedTuple):
    """The loop did not start, or ended early, for this reason."""

    reason: str


Message = Started | Failed | Summary


class DemoPlace(NamedTuple):
    """What the demonstration leaves and shows: the recording's path, or a page on which the driver sits."""

    recording: Path | None
    page: PageOptions | None = None


def serve_demo(plan: DemoSequence, place: DemoPlace, pipe: "Connection[Message, None]") -> None:
    """Run the demonstration; say what happens through `pipe`."""
    # Until the loop runs, and ends on Ctrl-C by itself, the parent decides what Ctrl-C means.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.setswitchinterval(0.0005)  # how long the ECU's thread can keep the loop waiting
    with contextlib.suppress(BrokenPipeError):
        try:
            pipe.send(_serve(plan, place, pipe.send))
        except Exception as error:
            pipe.send(Failed(str(error) or type(error).__name__))


def _serve(plan: DemoSequence, place: DemoPlace, say: Callable[[Message], None]) -> Summary:
    with door_begun(place.page is not None) as door:
        return _beside(_raining(load_bench(BENCH)), plan, place, door, say)


def _beside(
    bench: Bench, plan: DemoSequence, place: DemoPlace, door: Companion | None, say: Callable[[Message], None]
) -> Summary:
    record = None if place.recording is None else RecordTo(place.recording)
    with (
        recording(bench, record) as ring,
        announced(bench, ring, door) as run,
        page_beside(bench, run, place.page) as served,
    ):
        return _run(bench, plan, ring, served, say)


def _run(
    bench: Bench, plan: DemoSequence, ring: Ring, served: Companion | None, say: Callable[[Message], None]
) -> Summary:
    ended, stop = threading.Event(), StopRequest()
    parent = os.getppid()
    stalk = _stalk(plan, served)

    def drive() -> None:
        run_ecu(node, stalk, WallClock(), lambda: ended.is_set() or os.getppid() != parent, pause_ns=_ECU_PAUSE_NS)
        node.close()
        stop.ask()  # an orphan has nobody left to show anything to

    node = _ecu_node(bench, plan)
    ecu = threading.Thread(target=drive, name="ecu", daemon=True)

    def on_start(_: object) -> None:
        # The thread inherits the loop's priority; at a lower one, what interrupts it while it holds the
        # interpreter would hold up the loop.
        ecu.start()
        say(Started(ring.name, served.said if served is not None else ""))

    try:
        return serve(bench, plan.seconds, ring, stop, on_start)
    finally:
        ended.set()
        if ecu.is_alive():
            ecu.join()


def _stalk(plan: DemoSequence, served: Companion | None) -> StalkSource:
    """Return the driver: the plan, or who sits at the page, whose process writes the stalk's moves as lines."""
    if served is None or served.child.stdout is None:
        return lambda elapsed_s: stalk_at(plan.turns, elapsed_s)
    return TypedStalk(served.child.stdout.fileno(), lambda _: None)


def _raining(bench: Bench) -> Bench:
    """Return the bench with a wet screen."""
    input_row = bench.input_row.copy()
    input_row[INPUT_INDEX["screen"]] = 1.0
    return replace(bench, input_row=input_row)


def _ecu_node(bench: Bench, plan: DemoSequence) -> EcuNode:
    settings = controller_settings(bench.ecu)._replace(pauses_s=(plan.pause_s,) * len(INTERVALS))
    side = replace(bench.ecu_side(), stalk=())  # nobody else is on this bus
    return EcuNode(side, open_transport(bench.interface), settings)
