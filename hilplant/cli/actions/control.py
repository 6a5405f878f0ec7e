"""A velocity controller on a bench's interface."""

import math
from collections.abc import Callable

from hilplant.bench import load_bench
from hilplant.bus.transport import open_transport
from hilplant.cli.voice import Voice
from hilplant.control.reference import parse_reference
from hilplant.ecu.controller_choice import ControllerChoice, Driven, seat_on_bus
from hilplant.ecu.velocity_node import VelocityNode, VelocityReport, run_velocity_node, status_period_ns
from hilplant.runtime.clock import clock_at
from hilplant.runtime.server import StopRequest, ended_by_signals
from hilplant.units import SECOND_NS


def control_command(
    bench_name: str, wanted: tuple[str, str, int | None], seconds: float | None, channel: str | None = None
) -> bool:
    """Be a controller until the time is up, or SIGTERM or Ctrl-C ends it; the relays are released at the end.

    `wanted` are its name, its reference as written and its time budget [us]. Say whether it was sound to the end.
    """
    name, reference, budget_us = wanted
    choice, bench = ControllerChoice(name, parse_reference(reference), budget_us), load_bench(bench_name).at(channel)
    period_ns = status_period_ns(bench.send)
    side, seat = bench.ecu_side(), seat_on_bus(choice, Driven(bench.parameters.motor, period_ns / SECOND_NS))
    node = VelocityNode(side, open_transport(bench.interface), seat)
    voice = Voice()
    node.report = _printer(voice)
    stop, clock = StopRequest(), clock_at(bench.pace)
    end_ns = math.inf if seconds is None else clock.now_ns() + seconds * SECOND_NS
    with ended_by_signals(stop):
        try:
            run_velocity_node(node, clock, lambda: bool(stop() or seat.stopped) or clock.now_ns() >= end_ns, period_ns)
        finally:
            node.close()
    if seat.stopped:
        voice.say(f"{seat.stopped}; relays opened", err=True)
    return not seat.stopped


def _printer(voice: Voice) -> Callable[[VelocityReport], None]:
    """Return what prints a line each second, and whenever the plant falls silent or speaks again."""
    last: list[object] = [None]

    def tell(report: VelocityReport) -> None:
        told = (int(report.time_s), report.lost)
        if told != last[0]:
            last[0] = told
            voice.say(_line(report))

    return tell


def _line(report: VelocityReport) -> str:
    speed, brush = report.measured.speed_rad_s, "fast" if report.command.fast > 0.5 else "slow"
    state = "no frame in this period" if math.isnan(speed) else f"speed {speed:6.3f} rad/s"
    if report.lost:
        state = "no word from the plant"
    wanted, voltage = report.reference_rad_s, report.command.voltage_v
    return f"{report.time_s:8.3f} s  wanted {wanted:6.3f} rad/s, {state}, {voltage:6.3f} V, {brush} brush"
