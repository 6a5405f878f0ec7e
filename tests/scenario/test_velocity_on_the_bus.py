"""Velocity controllers as CAN nodes: plant and controller on an in-memory bus in virtual time, with delay and loss.

The truth is the plant's own speed, not what the frames say.
"""

import math
import random
from collections import deque
from dataclasses import replace

import numpy as np
import pytest
from support.wire import Wire

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.cli.actions import control as velocity_command
from hilplant.control.catalogue import controller_named, without_network
from hilplant.control.records import Command, Measured
from hilplant.control.seat import LoopSeat, Seat
from hilplant.ecu.velocity_node import VelocityNode, VelocityReport, run_velocity_node, status_period_ns
from hilplant.failure import Failure
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.server import build_loop
from hilplant.signals import ECU_RX_INDEX, INPUT_INDEX
from hilplant.thesis.control_test import run_drive, thesis_drive
from hilplant.units import MILLISECOND_NS, SECOND_NS

BENCH = load_bench("default")
PERIOD_NS = status_period_ns(BENCH.send)
PERIOD_MS = PERIOD_NS // MILLISECOND_NS


class Cable:
    """Two interfaces; each frame takes `delay` ticks to the other one, and a part of them never arrives."""

    def __init__(self, delay: int, loss: float) -> None:
        self.delay, self.loss, self.now = delay, loss, 0
        self.chance = random.Random(5)
        self.cut = False
        self.plant, self.controller = End(self), End(self)
        self.plant.other, self.controller.other = self.controller, self.plant


class End(Wire):
    other: "End"

    def __init__(self, cable: Cable) -> None:
        super().__init__()
        self.cable = cable
        self.under_way: deque[tuple[int, Frame]] = deque()

    def receive(self, limit: int) -> list[Frame]:
        arrived = []
        while self.under_way and self.under_way[0][0] <= self.cable.now and len(arrived) < limit:
            arrived.append(self.under_way.popleft()[1])
        return arrived

    def send(self, frame: Frame) -> SendResult:
        if not self.cable.cut and self.cable.chance.random() >= self.cable.loss:
            self.other.under_way.append((self.cable.now + self.cable.delay, frame))
        return SendResult.SENT


class Drive:
    """The default bench's loop and a controller, ticked together; the screen is wet, the reference pi."""

    def __init__(self, name: str, delay: int = 0, loss: float = 0.0, blind: bool = False) -> None:
        self.cable = Cable(delay, loss)
        motor = BENCH.parameters.motor
        controller = controller_named(name + ("_sensorless" if blind else ""), motor, PERIOD_NS / SECOND_NS)
        self.seat = Seat(controller, without_network(), lambda _: math.pi)
        side = BENCH.ecu_side()
        self.node = VelocityNode(side, self.cable.controller, self.seat)
        self.loop = build_loop(BENCH, self.cable.plant, VirtualClock())
        self.loop._node.values[INPUT_INDEX["screen"]] = 1.0
        self.speeds: list[float] = []

    def run(self, seconds: float) -> np.ndarray:
        for _ in range(round(seconds * 1000)):
            tick = self.cable.now
            if tick % PERIOD_MS == 1:
                self.node.poll(tick * MILLISECOND_NS)
            self.loop.tick(tick * MILLISECOND_NS)
            self.speeds.append(float(self.loop._state[1]) / BENCH.parameters.motor.gear_ratio)
            self.cable.now += 1
        return np.array(self.speeds)


def worst(speeds: np.ndarray) -> float:
    """The largest error after the start, over two turns and more [rad/s]."""
    return float(np.abs(speeds[1500:] - math.pi).max())


@pytest.fixture(scope="module")
def clean() -> dict[str, float]:
    return {name: worst(Drive(name).run(6.0)) for name in ("pid", "cascade")}


def test_a_controller_on_the_bus_holds_the_speed(clean):
    assert clean["pid"] < 0.4
    assert clean["cascade"] < 0.3


@pytest.mark.parametrize("name", ["pid", "cascade"])
@pytest.mark.parametrize(("delay", "loss"), [(PERIOD_MS, 0.0), (0, 0.1), (PERIOD_MS, 0.1)])
def test_a_delay_of_one_frame_period_and_lost_frames_are_tolerated(clean, name, delay, loss):
    speeds = Drive(name, delay, loss).run(6.0)
    assert worst(speeds) < 1.6 * clean[name]
    assert speeds.max() < math.pi + 1.0


def test_silence_of_the_plant_releases_the_relays_and_its_return_starts_anew():
    drive = Drive("cascade")
    drive.run(2.0)
    drive.cable.cut = True
    drive.run(1.0)
    assert drive.seat.memory == Drive("cascade").seat.memory, "nothing is left of the time before"
    assert drive.speeds[-1] == pytest.approx(0.0, abs=1e-6)
    drive.cable.cut = False
    drive.node.poll(drive.cable.now * MILLISECOND_NS)
    relays = [frame for _, frame in drive.cable.plant.under_way if frame.identifier == 0x120]
    assert relays and all(frame.data[0] == 0 for frame in relays), "both relays off while the plant is not heard"
    speeds = drive.run(2.0)
    assert speeds[-200:] == pytest.approx(math.pi, abs=0.4)
    assert speeds.max() < math.pi + 1.0


def test_a_controller_that_leaves_the_bus_sends_the_relays_off_first():
    drive = Drive("pid")
    drive.run(1.0)
    drive.cable.plant.under_way.clear()
    drive.node.release()
    sent = {frame.identifier: frame.data for _, frame in drive.cable.plant.under_way}
    assert sent[0x120] == bytes(len(sent[0x120])), "neither ON nor FAST"
    assert not any(sent.pop(identifier).strip(b"\0") for identifier in list(sent)), "and no supply"
    drive.node.close()
    assert drive.cable.controller.closed


@pytest.mark.parametrize("name", ["pid", "hebb"])
def test_without_a_speed_sensor_the_observer_holds_the_speed_over_the_bus_all_the_same(name):
    speeds = Drive(name, PERIOD_MS, 0.05, blind=True).run(8.0)
    assert worst(speeds[500:]) < 0.45
    assert speeds[2000:].mean() == pytest.approx(math.pi, abs=0.01)


def test_the_cascade_without_a_speed_sensor_is_refused_at_the_period_of_the_bus():
    with pytest.raises(Failure, match="needs a tick of 1 ms, not 10 ms"):
        Drive("cascade", blind=True)


def test_a_bench_that_does_not_tell_the_speed_is_refused():
    side = BENCH.ecu_side()
    seat = Seat(controller_named("pid", BENCH.parameters.motor, 0.01), without_network(), lambda _: 3.0)
    currents = {ECU_RX_INDEX["current_a"], ECU_RX_INDEX["measured_current_a"]}
    deaf = replace(side, receive=tuple(each for each in side.receive if each.name != "MotorStatus"))
    with pytest.raises(Failure, match="do not carry crank_speed_rad_s, current_a; a controller needs them"):
        VelocityNode(deaf, Cable(0, 0.0).controller, seat)
    speed_only = tuple(
        replace(each, targets=tuple(name for name in each.targets if name not in currents)) for each in side.receive
    )
    with pytest.raises(Failure, match="do not carry current_a; a controller needs them"):
        VelocityNode(replace(side, receive=speed_only), Cable(0, 0.0).controller, seat)
    with pytest.raises(Failure, match="no message of the bench sends crank_speed_rad_s"):
        status_period_ns([message for message in BENCH.send if message.name != "MotorStatus"])


def test_the_node_polls_at_its_period_and_releases_the_relays_at_the_end():
    drive = Drive("pid")
    times: list[float] = []
    status = [message for message in BENCH.send if message.name in ("MotorStatus", "ParkSwitch")]

    def report(told: VelocityReport) -> None:
        times.append(told.time_s)
        drive.cable.controller.under_way += [(0, Frame(each.identifier, bytes(each.length))) for each in status]

    drive.node.report = report
    run_velocity_node(drive.node, VirtualClock(), lambda: len(times) == 50, PERIOD_NS)
    assert np.diff(times) == pytest.approx(PERIOD_NS / SECOND_NS)
    *_, before, last = [frame.data[0] for _, frame in drive.cable.plant.under_way if frame.identifier == 0x120]
    assert before and not last


@pytest.mark.parametrize(("late_ms", "next_ms"), [(9, 50), (10, 50), (11, 51), (35, 75), (40, 80)])
def test_a_node_that_was_held_up_leaves_whole_periods_out_and_keeps_its_grid(late_ms, next_ms):
    node, clock, times_ms = Drive("pid").node, VirtualClock(), []
    clock.sleep_until_ns(7 * SECOND_NS)  # a clock that does not begin at 0

    def report(told: VelocityReport) -> None:
        times_ms.append(round(told.time_s * 1000))
        if len(times_ms) == 5:
            clock.sleep_until_ns(clock.now_ns() + late_ms * MILLISECOND_NS)

    node.report = report
    run_velocity_node(node, clock, lambda: len(times_ms) == 8, PERIOD_NS)
    grid = next_ms // PERIOD_MS * PERIOD_MS
    assert times_ms == [0, 10, 20, 30, 40, next_ms, grid + PERIOD_MS, grid + 2 * PERIOD_MS]


@pytest.mark.parametrize("name", ["pid", "hebb_fuzzy", "cascade"])
def test_a_controller_inside_the_loop_does_what_the_study_s_loop_does(name):
    """The server's loop, tick by tick, against the compiled loop of the study: bit for bit."""
    ticks = 2000
    commands = {INPUT_INDEX[signal] for signal in ("relay_on", "relay_fast", "supply_v")}
    receive = tuple(message for message in BENCH.receive if not commands & set(message.targets))
    bench = replace(BENCH, receive=receive)
    controller = controller_named(name, bench.parameters.motor, 0.001)
    loop = build_loop(bench, Cable(0, 0.0).plant, VirtualClock())
    loop._node.values[INPUT_INDEX["screen"]] = 1.0
    loop.control = LoopSeat(controller, without_network(), lambda _: math.pi, bench.parameter_row).drive
    speeds = []
    for tick in range(ticks):
        speeds.append(float(loop._state[1]) / bench.parameters.motor.gear_ratio)
        loop.tick(tick * MILLISECOND_NS)
    drive = thesis_drive(bench, 0.0)
    study = run_drive(bench, controller, drive._replace(reference_rad_s=drive.reference_rad_s[:ticks]))
    assert np.array_equal(study["crank_speed_rad_s"], np.array(speeds))


@pytest.mark.parametrize(
    ("speed", "lost", "told"),
    [
        (3.1, False, "speed  3.100 rad/s"),
        (math.nan, False, "no frame in this period"),
        (math.nan, True, "no word from the plant"),
    ],
)
def test_a_line_tells_the_speed_or_why_there_is_none(speed, lost, told):
    report = VelocityReport(1.5, 3.14, Measured(speed, 2.0, 0.0), Command(12.0, 1.0), lost)
    assert velocity_command._line(report) == f"   1.500 s  wanted  3.140 rad/s, {told}, 12.000 V, fast brush"
