"""A velocity controller in every tick of the loop, on the shipped benches, in virtual time."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.wire import Wire

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.control.reference import parse_reference
from hilplant.ecu.loop_controller import Inside, seated
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import Loop
from hilplant.runtime.server import build_loop
from hilplant.units import MILLISECOND_NS


def ticked(name: str, reference: str, bench_name: str = "default") -> tuple[Loop, Wire, float]:
    """Return a loop with a controller inside, its interface, and the gear ratio."""
    bench, seat = seated(load_bench(bench_name), Inside(name, reference))
    wire = Wire()
    loop = build_loop(bench, wire, VirtualClock())
    loop.control = seat.drive
    return loop, wire, bench.parameters.motor.gear_ratio


def speeds(loop: Loop, gear_ratio: float, ticks: range) -> np.ndarray:
    found = []
    for tick in ticks:
        loop.tick(tick * MILLISECOND_NS)
        found.append(float(loop._state[1]) / gear_ratio)
    return np.array(found)


def test_it_needs_no_frames_and_does_not_mind_those_of_a_relay_ecu():
    loop, wire, gear_ratio = ticked("cascade", "0:3.14,1:2")
    first = speeds(loop, gear_ratio, range(1000))
    wire.arriving = [Frame(0x120, bytes(8), False, False)] * 3
    second = speeds(loop, gear_ratio, range(1000, 3000))
    assert first[100:] == pytest.approx(3.14, abs=0.1)
    assert second[100:] == pytest.approx(2.0, abs=0.1)


def test_nobody_waits_for_the_frames_that_would_command_relays_and_supply():
    bench = load_bench("default")
    waited_for = replace(bench, receive=tuple(replace(message, timeout_ns=7) for message in bench.receive))
    inside, _ = seated(waited_for, Inside("cascade", "3"))
    commands = {"RelayCommand", "SupplyCommand"}
    assert {message.name for message in inside.receive} > commands
    for message in inside.receive:
        assert message.timeout_ns == (0 if message.name in commands else 7)


def test_a_controller_that_was_put_aside_begins_anew():
    loop, _, gear_ratio = ticked("pid", "3")
    speeds(loop, gear_ratio, range(2000))
    seat = loop.control.__self__
    assert seat.memory.pid.integral_v > 5.0
    loop.control = None
    speeds(loop, gear_ratio, range(2000, 2500))
    loop.control = seat.drive
    speeds(loop, gear_ratio, range(2500, 2501))
    assert 0.0 < seat.memory.pid.integral_v < 0.2


def test_the_reference_is_zero_before_its_first_time():
    assert parse_reference("1:3.14")(0.999) == 0.0
    assert math.isclose(parse_reference("1:3.14")(1.0), 3.14)
