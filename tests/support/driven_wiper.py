"""A velocity controller in the loop and on the bus, in virtual time: what the plant itself does, tick by tick."""

import math
from collections import deque
from typing import Any

import numpy as np

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.control.reference import parse_reference
from hilplant.ecu.controller_choice import ControllerChoice, Driven, seat_on_bus
from hilplant.ecu.loop_controller import Inside, seated
from hilplant.ecu.velocity_node import VelocityNode, status_period_ns
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.server import build_loop
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX
from hilplant.units import MILLISECOND_NS, SECOND_NS

BENCH = load_bench("default")


class End:
    up, missed = True, 0
    other: "End"

    def __init__(self) -> None:
        self.coming: deque[Frame] = deque()

    def receive(self, limit: int) -> list[Frame]:
        return [self.coming.popleft() for _ in range(min(limit, len(self.coming)))]

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, 0) for frame in self.receive(limit)]

    def send(self, frame: Frame) -> SendResult:
        self.other.coming.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        self.up = False


def joined() -> tuple[End, End]:
    plant, controller = End(), End()
    plant.other, controller.other = controller, plant
    return plant, controller


def in_the_loop(
    name: str, reference: str, wet: float, seconds: float, budget_us: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return speed of the crank and FAST relay of each tick."""
    bench, seat = seated(BENCH, Inside(name, reference, budget_us))
    loop = build_loop(bench, joined()[0], VirtualClock())
    loop.control = seat.drive
    return ticked(loop, wet, seconds, lambda _: None)


def on_the_bus(
    name: str, reference: str, wet: float, seconds: float, budget_us: int | None = None
) -> tuple[np.ndarray, np.ndarray]:
    period_ns = status_period_ns(BENCH.send)
    choice = ControllerChoice(name, parse_reference(reference), budget_us)
    seat, side = seat_on_bus(choice, Driven(BENCH.parameters.motor, period_ns / SECOND_NS)), BENCH.ecu_side()
    plant, controller = joined()
    node = VelocityNode(side, controller, seat)
    loop = build_loop(BENCH, plant, VirtualClock())
    polls = period_ns // MILLISECOND_NS
    return ticked(loop, wet, seconds, lambda tick: node.poll(tick * MILLISECOND_NS) if tick % polls == 1 else None)


def ticked(loop: Any, wet: float, seconds: float, between: Any) -> tuple[np.ndarray, np.ndarray]:
    loop.commanded[INPUT_INDEX["screen"]] = wet
    found = []
    for tick in range(round(seconds * 1000)):
        between(tick)
        loop.tick(tick * MILLISECOND_NS)
        found.append([loop._outputs[OUTPUT_INDEX[name]] for name in ("crank_speed_rad_s", "relay_fast")])
    speed, fast = np.array(found).T
    return speed, fast


def mean_of_turns(speed: np.ndarray) -> float:
    """Mean speed over the last whole turns of a piece."""
    turned = np.cumsum(speed[::-1]) * 1e-3
    whole = 2.0 * math.pi * (turned[-1] // (2.0 * math.pi))
    last = int(np.searchsorted(turned, whole))
    return float(speed[::-1][:last].mean())
