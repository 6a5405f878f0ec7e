"""The demonstration: starts the plant, shows it live, then draws and sums up what was recorded."""

import multiprocessing
import signal
from contextlib import closing
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path

from rich.console import Console

from hilplant.atomic_write import cannot_be_written, make_folder
from hilplant.cli.display import Scene, watch
from hilplant.demo.plant import DemoPlace, Failed, Message, Started, serve_demo
from hilplant.demo.sequence import WHOLE_S, DemoSequence, by_hand, sequence
from hilplant.demo.summary import summarise
from hilplant.ecu.stalk import stalk_at, stalk_words
from hilplant.failure import Failure
from hilplant.operator_page.beside_run import PageOptions
from hilplant.runtime.ring import Ring
from hilplant.runtime.server import Summary

RECORDING, PLOT = "demo.hilrec", "demo.png"


def run_demo(seconds: float | None, out: Path) -> None:
    """Run the demonstration; leaves recording and plot in `out`, those of an earlier one are replaced."""
    plan = sequence(seconds)
    folder = _clear_folder(out)
    console = Console()
    console.print(
        "hilplant demo: plant and ECU on an in-memory bus; no CAN, no privileges needed\n"
        "preparing the plant (the first run compiles it, which takes 10 to 20 s) ...",
        highlight=False,
    )
    if plan.seconds is not None and plan.seconds < WHOLE_S:
        console.print(f"{plan.seconds:g} s show the beginning alone; all modes take {WHOLE_S:g} s", highlight=False)
    summary = _serve_and_watch(plan, DemoPlace(folder / RECORDING), console)
    lines = summarise(summary, folder / RECORDING, folder / PLOT)
    console.print("\n".join(lines), highlight=False, markup=False, soft_wrap=True)


def run_demo_page(seconds: float | None, page: PageOptions) -> None:
    """Run the demonstration for the user of its page; nothing is recorded but what is logged there."""
    console = Console()
    console.print(
        "hilplant demo: plant and ECU on an in-memory bus, driven on a page\n"
        "preparing the plant (the first run compiles it, which takes 10 to 20 s) ...",
        highlight=False,
    )
    summary = _serve_and_watch(by_hand(seconds), DemoPlace(None, page), console)
    console.print(f"{summary.ticks} ticks, {summary.overruns} overruns", highlight=False)


def _clear_folder(folder: Path) -> Path:
    make_folder(folder)
    try:
        for name in (RECORDING, PLOT):
            (folder / name).unlink(missing_ok=True)
    except OSError as error:
        raise cannot_be_written(folder, error) from error
    return folder


def _serve_and_watch(plan: DemoSequence, place: DemoPlace, console: Console) -> Summary:
    """Run the plant in a process of its own and show it until it ends; Ctrl-C ends it early."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    child = context.Process(target=serve_demo, args=(plan, place, there), name="hilplant demo plant")
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    child.start()
    there.close()
    try:
        return _follow(plan, child, here, console)
    except KeyboardInterrupt:  # too early for anything to be summed up
        if place.recording is not None:
            place.recording.unlink(missing_ok=True)
        raise
    finally:
        signal.signal(signal.SIGTERM, before)
        child.join(10.0)
        if child.is_alive():
            child.kill()


def _follow(plan: DemoSequence, child: SpawnProcess, pipe: "Connection[None, Message]", console: Console) -> Summary:
    interrupted = False
    try:
        started = _next_message(pipe)
        if isinstance(started, Started):
            if started.page:
                console.print(f"page: {started.page}", highlight=False, soft_wrap=True)
            with closing(Ring.attach(started.ring)) as ring:
                watch(ring.latest, pipe.poll, lambda time_s: _scene(plan, time_s), console)
    except KeyboardInterrupt:
        interrupted = True
        child.terminate()
    ended = _next_message(pipe)
    while isinstance(ended, Started):
        ended = _next_message(pipe)
    if not isinstance(ended, Summary):
        if interrupted:
            raise KeyboardInterrupt
        raise Failure(f"demo: {ended.reason}")
    return ended


def _next_message(pipe: "Connection[None, Message]") -> Message:
    try:
        return pipe.recv()
    except EOFError:
        return Failed("ended before the plant had started")


def _scene(plan: DemoSequence, time_s: float) -> Scene:
    if plan.seconds is None:
        return Scene("hilplant demo", f"{time_s:.1f} s; Ctrl-C ends it")
    progress = f"{time_s:.1f} of {plan.seconds:g} s"
    return Scene("hilplant demo", progress, stalk_words(stalk_at(plan.turns, time_s)))
