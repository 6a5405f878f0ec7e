"""A wanted speed while a controller runs: by scenario, by channel, by frame; and what a controller sees of the current.

All in virtual time. The truth is the plant's own speed and the command that the controller gave.
"""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.channel_rig import Run
from support.driven_wiper import joined

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.control.closed_loop import measure
from hilplant.control.reference import parse_reference
from hilplant.ecu.controller_choice import ControllerChoice, Driven, seat_on_bus
from hilplant.ecu.loop_controller import Inside, seated
from hilplant.ecu.velocity_node import VelocityNode, VelocityReport
from hilplant.models.records import Parameters, State
from hilplant.models.row import unpack
from hilplant.runtime import commands as c
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.server import build_loop
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, WANTED
from hilplant.simulation.player import ScenarioPlayer
from hilplant.simulation.scenario import load_scenario
from hilplant.units import MILLISECOND_NS

SPEED = 2 + len(INPUTS) + OUTPUT_INDEX["crank_speed_rad_s"]
SPEED_COMMAND = 294


class Controlled(Run):
    """A loop with a controller inside that was started with 2 rad/s, and a mailbox."""

    def __init__(self, bench: str = "default") -> None:
        super().__init__(bench=bench)
        changed, seat = seated(self.bench, Inside("cascade", "2"))
        self.bench = changed
        self.loop.control = seat.drive
        self.loop._node._supervised.clear()  # as the changed bench has it: nobody waits for relay frames
        self.loop._node.lost = False
        assert self.loop.intake is not None
        self.loop.intake.controlled = True

    def speed_after(self, ticks: int) -> float:
        return float(np.mean([self.tick()[SPEED] for _ in range(ticks)][-20:]))


@pytest.fixture
def run() -> Iterator[Controlled]:
    made = Controlled()
    yield made
    made.close()


def test_hand_scenario_and_frames_ask_for_a_speed_in_the_order_of_their_rank(run: Controlled, tmp_path: Path) -> None:
    assert run.speed_after(200) == pytest.approx(2.0, abs=0.03)
    run.post(c.REFERENCE, 0, 2.5)
    assert run.speed_after(150) == pytest.approx(2.5, abs=0.03)
    text = "seconds: 1\nsignals:\n  reference_rad_s: [[0, 3], [0.2, {ramp_to: 3.5, seconds: 0.1}], [0.6, own]]\n"
    (tmp_path / "own.yaml").write_text(text)
    intake = run.loop.intake
    assert intake is not None
    scenario = load_scenario(tmp_path / "own.yaml")
    intake.source = ScenarioPlayer(scenario, run.bench, (intake.faults, intake.faults.transport, run.loop.line))
    assert run.speed_after(200) == pytest.approx(3.0, abs=0.03)
    assert run.owner(WANTED) == "scenario"
    run.post(c.REFERENCE, 0, 1.0)
    assert run.speed_after(250) == pytest.approx(3.5, abs=0.03)
    run.post(c.OVERRIDE, WANTED, 1.5)
    assert run.speed_after(100) == pytest.approx(1.5, abs=0.03)
    run.post(c.RELEASE, WANTED)
    assert run.speed_after(300) == pytest.approx(2.0, abs=0.03), "own: what the controller was started with"
    told = [(kind, outcome) for _, kind, outcome in run.events()]
    assert [outcome for kind, outcome in told if kind == "reference"] == ["applied", "held by the scenario"]


@pytest.mark.parametrize("value", [-0.5, 20.5, math.nan])
def test_a_speed_that_nobody_can_want_is_refused(run: Controlled, value: float) -> None:
    run.post(c.REFERENCE, 0, value)
    run.tick()
    assert run.events()[0][2] == ("applied" if value == -0.5 else "out of range")


def test_a_command_that_a_hand_holds_stands_over_the_controller_s(run: Controlled) -> None:
    run.post(c.OVERRIDE, INPUT_INDEX["supply_v"], 5.0)
    run.tick(5)
    assert run.input(INPUT_INDEX["supply_v"]) == 5.0


def test_a_frame_asks_the_controller_inside_the_loop() -> None:
    run = Controlled("speed_command")
    run.transport.arrived.append(Frame(SPEED_COMMAND, (3000).to_bytes(2, "little"), False, False))
    assert run.speed_after(250) == pytest.approx(3.0, abs=0.05)
    run.close()


def test_a_frame_asks_the_controller_on_the_bus() -> None:
    bench = load_bench("speed_command")
    side = bench.ecu_side()
    plant, controller = joined()
    seat = seat_on_bus(ControllerChoice("pid", parse_reference("2")), Driven(bench.parameters.motor, 0.01))
    node, loop = VelocityNode(side, controller, seat), build_loop(bench, plant, VirtualClock())
    reports: list[VelocityReport] = []
    node.report = reports.append
    speeds = []
    for tick in range(4000):
        if tick == 1500:
            controller.coming.append(Frame(SPEED_COMMAND, (3140).to_bytes(2, "little"), False, False))
        if tick % 10 == 1:
            node.poll(tick * MILLISECOND_NS)
        loop.tick(tick * MILLISECOND_NS)
        speeds.append(loop.line[SPEED])
    assert {report.reference_rad_s for report in reports[:149]} == {2.0}
    assert {report.reference_rad_s for report in reports[151:]} == {3.14}
    assert np.mean(speeds[2500:]) == pytest.approx(3.14, rel=0.05)


def test_a_controller_in_the_loop_sees_what_sensor_and_contact_show_in_that_tick() -> None:
    """Noise and ripple are those of the output `measured_current_a`, to the last digit; so is a stuck contact."""
    bench, asked = load_bench("speed_command"), []

    def look(now_ns: int, state: Any, inputs: Any, parameters: Any) -> bool:
        asked.append(measure(unpack(State, state), unpack(Parameters, parameters)))
        inputs[INPUT_INDEX["relay_on"]] = 1.0
        return True

    loop = build_loop(bench, joined()[0], VirtualClock())
    loop._node._supervised.clear()
    loop._node.lost = False
    loop.control = look
    shown = []
    for tick in range(400):
        loop.tick(tick * MILLISECOND_NS)
        outputs = loop.line[2 + len(INPUTS) :]
        shown.append([outputs[OUTPUT_INDEX[name]] for name in ("measured_current_a", "park_contact", "current_a")])
    measured, contact, true = np.array(shown).T
    assert [each.current_a for each in asked] == measured.tolist()
    assert [each.park_contact for each in asked] == contact.tolist()
    assert np.std(measured - true) > 0.08
    sensors = bench.parameters.sensors._replace(park_stuck=2.0)
    stuck = replace(bench, parameters=bench.parameters._replace(sensors=sensors))
    assert measure(State(crank_angle_rad=3.0), stuck.parameters).park_contact == 1.0
