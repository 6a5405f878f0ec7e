"""A velocity controller's node on a bus that the test holds in its hands: what it measures and what it commands."""

from dataclasses import replace

import numpy as np
from support.wire import Wire

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.control.catalogue import controller_named, without_network
from hilplant.control.records import Command
from hilplant.control.seat import Seat
from hilplant.ecu.velocity_node import VelocityNode
from hilplant.signals import ECU_RX_INDEX
from hilplant.units import MILLISECOND_NS

BENCH = load_bench("default")
MOTOR, PARK = (next(each for each in BENCH.send if each.name == name) for name in ("MotorStatus", "ParkSwitch"))


def test_a_park_contact_that_no_message_carries_counts_as_open():
    side, told = BENCH.ecu_side(), []
    contact = ECU_RX_INDEX["park_contact"]
    without = tuple(message for message in side.receive if contact not in message.targets)
    seat = Seat(controller_named("pid", BENCH.parameters.motor, 0.01), without_network(), lambda _: 3.0)
    node = VelocityNode(replace(side, receive=without), Wire(), seat)
    node.report = told.append
    node.poll(0)
    assert [report.measured.park_contact for report in told] == [0.0]


def test_a_speed_is_measured_once_by_the_frame_that_carries_it():
    wire, told = Wire(), []
    seat = Seat(controller_named("pid", BENCH.parameters.motor, 0.01), without_network(), lambda _: 3.0)
    node = VelocityNode(BENCH.ecu_side(), wire, seat)
    node.report = lambda report: told.append(report.measured.speed_rad_s)
    for now_ms, frames in enumerate(([MOTOR, PARK], [PARK], [MOTOR], [], [])):
        wire.arriving = [Frame(message.identifier, bytes(message.length)) for message in frames]
        node.poll(now_ms * MILLISECOND_NS)
    assert np.isfinite(told).tolist() == [True, False, True, False, False]


def test_the_relay_is_on_for_any_voltage_above_0():
    class Asks:
        reference, forget = staticmethod(lambda _: 3.0), staticmethod(lambda: None)

        def decide(self, *_: object) -> Command:
            return Command(next(voltages), 0.0)

    voltages, wire, told = iter((0.0, 0.02, 0.0)), Wire(), []
    node = VelocityNode(BENCH.ecu_side(), wire, Asks())
    for now_ms in range(3):
        wire.arriving = [Frame(message.identifier, bytes(message.length)) for message in (MOTOR, PARK)]
        node.poll(now_ms * MILLISECOND_NS)
        told.append([frame.data[0] & 1 for frame in wire.sent if frame.identifier == 0x120][-1])
    assert told == [0, 1, 0]
