"""Snow, stops, jams and ice against an adaptive solver of the full equations, and against what can be said on paper.

The solver's snow and stops are written as what pushes the arm, by its own direction, from the wiper's closed form; it
knows no torque that is split into one of the angle and one against motion.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from support.closed_form import ClosedFormWiper

from hilplant.arrays import Floats
from hilplant.models.mechanical_records import Obstacles, SideObstacles
from hilplant.models.records import Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch, State
from hilplant.signals import OUTPUT_INDEX, Inputs
from hilplant.thesis.reference import Reference
from hilplant.thesis.reference_equations import Equations
from hilplant.thesis.solver import DRY, SCENARIOS, WET, Rows, errors_percent, run_step

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
FRICTION = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02
)
WIPER, LEFT, RIGHT = ClosedFormWiper(), Arm(0.3, 0.69), Arm(-0.4, 0.54)
STALL_A = 13.5 / MOTOR.slow.resistance_ohm
#: What the stalled motor presses with onto the crank: its torque less its own friction, through the gear.
STALL_N_M = (MOTOR.slow.constant_v_s * STALL_A - MOTOR.coulomb_torque_n_m) * MOTOR.gear_ratio


def plant(obstacles: Obstacles, model: float = 2.0, motor: Motor = MOTOR) -> Parameters:
    blade = Blade(7.615, 1.0)
    load = Load(model, friction=FRICTION, left_blade=blade, right_blade=blade)
    return Parameters(1e-3, motor, ParkSwitch(0.0, 0.1, 0.02, 3.0), load, LEFT, RIGHT, obstacles=obstacles)


def shown(outputs: Floats, name: str) -> Floats:
    return outputs[:, OUTPUT_INDEX[name]]


@dataclass(frozen=True)
class WithObstacles(Equations):
    """The equations with a force on each arm that knows which way the arm moves."""

    def resisting(self, angle: float, speed: float, direction: float) -> tuple[float, float]:
        inertia, torque = super().resisting(angle, speed, direction)
        of = self.parameters.obstacles
        for side, seat, here in ((WIPER.left, LEFT, of.left), (WIPER.right, RIGHT, of.right)):
            psi, rate, _ = side.rocker(angle)
            arm_moves = direction * rate
            for depth, stiffness, sign in (
                (psi + seat.offset_rad - here.high_rad, here.high_n_m_rad, 1.0),
                (here.low_rad - psi - seat.offset_rad, here.low_n_m_rad, -1.0),
            ):
                if depth > 0.0:
                    share = 1.0 if sign * arm_moves > 0.0 else here.rebound
                    torque += share * stiffness * depth * sign * arm_moves
        return inertia, torque


@dataclass(frozen=True)
class ReferenceWithObstacles(Reference):
    """The same, ready to be integrated."""

    def _equations(self, tick: int, inputs: Inputs) -> Equations:
        return WithObstacles(self.parameters, self.channels, inputs, self._digital(tick, inputs), self.slowest_rad_s)


SNOW = SideObstacles(low_rad=-0.1, low_n_m_rad=20.0, high_rad=0.7, high_n_m_rad=30.0)
KINDS = {
    "snow left": Obstacles(1.0, left=SNOW),
    "snow on both": Obstacles(1.0, left=SNOW, right=SNOW._replace(high_rad=0.1, low_rad=-0.9)),
    "stop": Obstacles(1.0, left=SNOW._replace(rebound=1.0, high_n_m_rad=200.0)),
    "half a spring": Obstacles(1.0, right=SideObstacles(0.0, 0.0, -0.6, 60.0, 0.5)),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("scenario", ["start and run", "reverse", "park"])
def test_snow_and_stops_agree_with_the_adaptive_solver(kind: str, scenario: str) -> None:
    parameters, rows = plant(KINDS[kind]), SCENARIOS[scenario]()
    outputs = run_step(parameters, WIPER.tables(), rows)
    truth = ReferenceWithObstacles(parameters, WIPER.channels).run(rows)
    errors = errors_percent(outputs, truth)
    free = run_step(plant(Obstacles()), WIPER.tables(), rows)
    print(f"\n{scenario:<14} {kind:<14} RMS of range: current, speed, angle {errors} %", end="")
    assert max(errors) < 0.02
    assert max(errors_percent(free, truth)) > 0.1, "the obstacle does something"


@pytest.mark.parametrize("rebound", [0.0, 0.4, 1.0])
def test_a_wipe_through_snow_loses_the_energy_of_its_depth(rebound: float) -> None:
    """On paper (1 - rebound) k d^2/2 a turn; without other friction it is the work of the load over whole turns."""
    stiffness, begin = 40.0, 0.7
    side = SideObstacles(high_rad=begin, high_n_m_rad=stiffness, rebound=rebound)
    motor = MOTOR._replace(gear_back_efficiency=1.0)
    outputs = run_step(plant(Obstacles(1.0, left=side), 0.0, motor), WIPER.tables(), Rows(5000, relay_on=1).rows)
    turned, torque = np.unwrap(shown(outputs, "crank_angle_rad")), shown(outputs, "load_torque_n_m")
    turns = np.floor(turned[-1] / (2.0 * np.pi))
    work = np.trapezoid(torque[turned <= 2.0 * np.pi * turns], turned[turned <= 2.0 * np.pi * turns])
    depth = shown(outputs, "left_arm_rad").max() - begin
    assert depth > 0.2 and turns >= 3
    assert work == pytest.approx(turns * (1.0 - rebound) * 0.5 * stiffness * depth**2, abs=2e-3 * stiffness * depth**2)


def test_snow_that_is_too_high_stalls_the_motor_which_reports_what_it_presses_with() -> None:
    side = SideObstacles(high_rad=0.4, high_n_m_rad=2000.0)
    outputs = run_step(plant(Obstacles(1.0, left=side)), WIPER.tables(), Rows(3000, screen=WET, relay_on=1).rows)
    assert (shown(outputs, "motor_speed_rad_s")[1500:] == 0.0).all()
    assert shown(outputs, "current_a")[-1] == pytest.approx(STALL_A, rel=1e-9)
    assert shown(outputs, "load_torque_n_m")[-1] == pytest.approx(STALL_N_M, rel=1e-9)
    arm = shown(outputs, "left_arm_rad")[-1]
    rate = WIPER.left.rocker(shown(outputs, "crank_angle_rad")[-1])[1]
    assert 2000.0 * (arm - 0.4) * rate > 0.8 * STALL_N_M  # the rest is friction; its speed carried it deeper than that
    assert 0.4 < arm < 0.5


@pytest.mark.parametrize("supply_v", [13.5, -13.5])
def test_a_jam_stops_the_crank_within_its_angle_from_both_sides(supply_v: float) -> None:
    jam = Obstacles(1.0, jam_rad=2.0, jam_half_rad=0.05, jam_n_m=1000.0)
    rows = Rows(3000, screen=WET, relay_on=1, supply_v=supply_v).rows
    outputs = run_step(plant(jam), WIPER.tables(), rows)
    assert (shown(outputs, "motor_speed_rad_s")[2500:] == 0.0).all()
    assert abs(shown(outputs, "crank_angle_rad")[-1] - 2.0) <= 0.05
    assert abs(shown(outputs, "current_a")[-1]) == pytest.approx(STALL_A, rel=1e-9)
    assert shown(outputs, "load_torque_n_m")[-1] == pytest.approx(STALL_N_M, rel=1e-9)


def test_a_jam_that_the_motor_overcomes_costs_its_torque_by_its_width() -> None:
    jam = Obstacles(1.0, jam_rad=2.0, jam_half_rad=0.25, jam_n_m=6.0)
    outputs = run_step(plant(jam, 0.0), WIPER.tables(), Rows(5000, relay_on=1).rows)
    turned = np.unwrap(shown(outputs, "crank_angle_rad"))
    whole = turned <= 2.0 * np.pi * np.floor(turned[-1] / (2.0 * np.pi))
    work = np.trapezoid(shown(outputs, "load_torque_n_m")[whole], turned[whole])
    assert work / np.floor(turned[-1] / (2.0 * np.pi)) == pytest.approx(6.0 * 0.5, rel=0.02)


@pytest.mark.parametrize("start_rad", [0.7, 1.5, 2.4])
def test_a_frozen_blade_breaks_away_at_its_torque_and_is_free_after_its_slip(start_rad: float) -> None:
    rate, hold = WIPER.left.rocker(start_rad)[1], 12.0
    frozen = Obstacles(1.0, slip_rad=0.05, left=SideObstacles(frozen_n_m=hold))
    outputs = run_step(
        plant(frozen, 0.0), WIPER.tables(), Rows(1500, relay_on=1).rows, State(crank_angle_rad=start_rad)
    )
    moving = int(np.argmax(shown(outputs, "motor_speed_rad_s") > 0.0))
    needed_a = (MOTOR.coulomb_torque_n_m + hold * abs(rate) / MOTOR.gear_ratio) / MOTOR.slow.constant_v_s
    current = shown(outputs, "current_a")
    assert current[moving - 1] <= needed_a * (1.0 + 1e-9) < current[moving] + 13.5 / 3.148e-3 * 1e-3
    turned, arm = np.unwrap(shown(outputs, "crank_angle_rad")), shown(outputs, "left_arm_rad")
    torque = shown(outputs, "load_torque_n_m")
    held = torque > 0.0
    held[:moving] = False
    way = np.trapezoid(torque * held, turned)
    farthest = hold * np.abs(np.diff(arm)).max()  # the ice is left at a tick
    assert hold * 0.05 - farthest <= way <= hold * 0.05 + 2.0 * farthest
    assert (torque[np.abs(arm - arm[0]) > 0.1] == 0.0).all()


def test_a_frozen_blade_that_is_too_strong_stalls_the_motor() -> None:
    frozen = Obstacles(1.0, slip_rad=0.05, left=SideObstacles(frozen_n_m=500.0))
    start = State(crank_angle_rad=1.5)
    outputs = run_step(plant(frozen), WIPER.tables(), Rows(800, screen=DRY, relay_on=1).rows, start)
    assert (shown(outputs, "motor_speed_rad_s") == 0.0).all()
    assert shown(outputs, "load_torque_n_m")[-1] == pytest.approx(STALL_N_M, rel=1e-9)


def test_without_obstacles_no_bit_changes_and_those_that_are_far_away_change_none() -> None:
    rows = SCENARIOS["start and run"]()
    free = run_step(plant(Obstacles()), WIPER.tables(), rows)
    far = Obstacles(1.0, 0.1, 1.0, 0.0, 0.0, SideObstacles(-7.0, 50.0, 7.0, 50.0), SideObstacles(rebound=1.0))
    ours = run_step(plant(far), WIPER.tables(), rows)
    assert np.array_equal(free, ours)
