"""The body ECU on a bench's interface, its stalk given as a text, received from the bus, or typed."""

import math
import os
import sys
from collections.abc import Callable
from dataclasses import replace

import typer

from hilplant.bench import load_bench
from hilplant.bus.transport import open_transport
from hilplant.cli.voice import Voice
from hilplant.ecu.node import EcuNode, EcuReport, run_ecu
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import StalkSource, TypedStalk, parse_stalk, stalk_at, stalk_words
from hilplant.ecu.vocabulary import Fault, Stalk
from hilplant.runtime.clock import clock_at
from hilplant.runtime.server import StopRequest, ended_by_signals
from hilplant.signals import STATUS
from hilplant.units import MILLISECOND_NS, SECOND_NS


def ecu_command(
    bench_name: str, seconds: float | None, stalk: str | None, place: tuple[str | None, float | None] = (None, None)
) -> None:
    """Be the ECU until the time is up, or SIGTERM or Ctrl-C ends it; the relays are released at the end.

    A written stalk goes before the one on the bus, and that before a typed one. `place` are another channel and pace
    than the bench's.
    """
    source = _source(stalk)
    bench = load_bench(bench_name).at(*place)
    side = bench.ecu_side() if stalk is None else replace(bench.ecu_side(), stalk=())
    node = EcuNode(side, open_transport(bench.interface), controller_settings(bench.ecu))
    voice = Voice()
    node.report = _printer(voice)
    stop, clock = StopRequest(), clock_at(bench.pace)
    end_ns = math.inf if seconds is None else clock.now_ns() + seconds * SECOND_NS

    def ended() -> bool:
        return stop() or clock.now_ns() >= end_ns

    with ended_by_signals(stop):
        try:
            run_ecu(node, source, clock, ended, pause_ns=round(bench.ecu.period_ms * MILLISECOND_NS))
        finally:
            node.close()
    _print_counts(node.counts, voice)


def _source(text: str | None) -> StalkSource:
    """Choose where the hand's stalk comes from: the text, else lines on standard input."""
    if text is not None:
        turns = parse_stalk(text)
        return lambda elapsed_s: stalk_at(turns, elapsed_s)
    if sys.stdin is None:  # closed, as some that start daemons leave it
        return _untouched
    descriptor = sys.stdin.fileno()
    if os.isatty(descriptor):
        typer.echo("type off, slow, fast, intermittent (a first letter will do), i1 to i6, flick or wash; Ctrl-C ends")
        if os.tcgetpgrp(descriptor) != os.getpgrp():  # in the background, reading would stop this program
            typer.echo("in the background: the stalk comes from the bus, or with --stalk", err=True)
            return _untouched
    return TypedStalk(descriptor, Voice().say)


def _untouched(elapsed_s: float) -> Stalk:
    """Return the stalk where it is without a hand: off."""
    return stalk_at((), elapsed_s)


def _printer(voice: Voice) -> Callable[[EcuReport], None]:
    """Return what prints a line whenever the ECU changes its mind."""
    last: list[object] = [None]

    def tell(report: EcuReport) -> None:
        told = (report.stalk, report.state.phase, report.relays, report.fault, report.park_known)
        if told != last[0]:
            last[0] = told
            voice.say(_line(report))

    return tell


def _line(report: EcuReport) -> str:
    relays = "OFF" if not report.relays.on else "FAST" if report.relays.fast else "SLOW"
    silent = "" if report.park_known else "; no word from the park switch"
    fault = "" if report.fault is Fault.NONE else f"; fault {report.fault.value}"
    stalk, phase = stalk_words(report.stalk), report.state.phase.value
    return f"{report.time_s:8.3f} s  stalk {stalk}: {phase}, relays {relays}{fault}{silent}"


def _print_counts(counts: list[int], voice: Voice) -> None:
    """Say what the ECU refused or lost on the bus; frames of others are none of its business."""
    found = zip(STATUS, counts, strict=True)
    words = [f"{signal.name} {count}" for signal, count in found if count and signal.name != "unknown_frame"]
    if words:
        voice.say(f"on the bus: {', '.join(words)}")
