"""The whole wiper at 1 ms against an adaptive solver of the full equations, and against itself at a tenth of the step.

The wiper is known in closed form and has the size of the default bench: motor and friction of Table 5-9, F = 7.615 N,
blades at 0.69 and 0.54 m. The step reads it from tables, the reference from its formulas.
"""

import numpy as np
import pytest
from support.closed_form import ClosedFormWiper

from hilplant.bench.description import LONGEST_STEP_S
from hilplant.models.records import Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch, State
from hilplant.signals import OUTPUT_INDEX
from hilplant.thesis.reference import Reference
from hilplant.thesis.solver import DRY, SCENARIOS, TACKY, WET, Rows, compare, errors_percent, run_step

LIMIT_PERCENT = 0.5
MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
FRICTION = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02
)
SPEED, ANGLE = OUTPUT_INDEX["motor_speed_rad_s"], OUTPUT_INDEX["crank_angle_rad"]
#: As published; dry friction in the motor; a gear that the load can drive, friction along the blade, damped pivots.
VARIANTS = {
    "as published": (MOTOR, ClosedFormWiper()),
    "dry friction": (MOTOR._replace(coulomb_torque_n_m=0.045), ClosedFormWiper()),
    "driven gear": (
        MOTOR._replace(gear_efficiency=0.7, gear_back_efficiency=0.4),
        ClosedFormWiper(points=3, pivot_damping_n_m_s=0.1),
    ),
}


def plant(motor: Motor = MOTOR, points: int = 1, step_s: float = 1e-3) -> Parameters:
    blade = Blade(7.615, 1.0)
    load = Load(2.0, points=points, friction=FRICTION, left_blade=blade, right_blade=blade)
    return Parameters(step_s, motor, ParkSwitch(0.0, 0.1, 0.02, 3.0), load, Arm(0.3, 0.69), Arm(-0.4, 0.54))


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("scenario", SCENARIOS)
def test_the_step_agrees_with_the_adaptive_solver(scenario: str, variant: str) -> None:
    motor, wiper = VARIANTS[variant]
    errors = compare(plant(motor, wiper.points), wiper.tables(), wiper.channels, SCENARIOS[scenario]())
    print(f"\n{scenario:<18} {variant:<13} RMS of range: current {errors.current_percent:.1e} %, "
          f"speed {errors.speed_percent:.1e} %, angle {errors.angle_percent:.1e} %", end="")  # fmt: skip
    assert errors.worst_percent < LIMIT_PERCENT / 10.0


@pytest.mark.parametrize("scenario", ["brown-out to 6 V", "park"])
def test_sticking_in_place_of_the_steep_curves_as_printed_makes_no_difference(scenario: str) -> None:
    wiper = ClosedFormWiper()
    motor = MOTOR._replace(coulomb_torque_n_m=0.045)
    errors = compare(plant(motor), wiper.tables(), wiper.channels, SCENARIOS[scenario](), slowest_rad_s=0.0)
    print(f"\n{scenario:<18} curves as printed: {errors.worst_percent:.1e} %", end="")
    assert errors.worst_percent < LIMIT_PERCENT / 10.0


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_a_tenth_of_the_step_gives_the_same_motion(scenario: str) -> None:
    tables, rows = ClosedFormWiper().tables(), SCENARIOS[scenario]()
    fine = run_step(plant(step_s=1e-4), tables, np.repeat(rows, 10, axis=0))[::10]
    truth = np.stack([fine[:, OUTPUT_INDEX["current_a"]], fine[:, SPEED], np.unwrap(fine[:, ANGLE])], axis=1)
    assert max(errors_percent(run_step(plant(), tables, rows), truth)) < LIMIT_PERCENT / 10.0


@pytest.mark.parametrize("screen", [DRY, TACKY, WET])
def test_the_longest_step_of_a_bench_stays_within_the_limit_from_any_start(screen: float) -> None:
    tables, times, worst = ClosedFormWiper().tables(), round(LONGEST_STEP_S / 1e-3), 0.0
    rows = Rows(3000, screen=screen, relay_on=1).set(1200, 1500, relay_on=0).set(2100, 3000, relay_fast=1)
    rows.set(2400, 2700, brake_torque_n_m=500.0)
    for angle in np.linspace(0.0, 6.28, 40):
        start = State(0.0, 0.0, angle, 0.0, 0.0, 0.0)
        fine = run_step(plant(), tables, rows.rows, start)[::times]
        truth = np.stack([fine[:, OUTPUT_INDEX["current_a"]], fine[:, SPEED], np.unwrap(fine[:, ANGLE])], axis=1)
        coarse = run_step(plant(step_s=LONGEST_STEP_S), tables, rows.rows[::times], start)
        worst = max(worst, *errors_percent(coarse, truth))
    print(f"\n{1e3 * LONGEST_STEP_S:.0f} ms, wetness {screen}: {worst:.1e} %", end="")
    assert worst < LIMIT_PERCENT


def test_backwards_from_a_start_at_speed_agrees_as_well() -> None:
    wiper, rows = ClosedFormWiper(), Rows(600, screen=WET, relay_on=1, supply_v=-12.0).rows
    start = State(-1.5, -180.0, 2.0, 0.0, 0.0, 0.0)
    outputs = run_step(plant(), wiper.tables(), rows, start)
    truth = Reference(plant(), wiper.channels).run(rows, (-1.5, -180.0, 2.0))
    assert truth[-1, 2] < 0.0
    truth[:, 2] += np.unwrap(outputs[:, ANGLE])[0] - truth[0, 2]
    assert max(errors_percent(outputs, truth)) < LIMIT_PERCENT / 10.0


@pytest.mark.parametrize("screen", [DRY, WET])
def test_standing_is_exact_rest_without_chatter(screen: float) -> None:
    """A voltage that falls to nothing and rises again: the shaft stops once and starts once."""
    volts = np.abs(np.linspace(-8.0, 8.0, 4000))
    rows = Rows(4000, screen=screen, relay_on=1, supply_v=0.0).set(0, 4000, supply_v=volts)
    motor = MOTOR._replace(coulomb_torque_n_m=0.045)
    speed = run_step(plant(motor), ClosedFormWiper().tables(), rows.rows)[:, SPEED]
    standing = speed == 0.0
    assert np.count_nonzero(np.diff(standing.astype(int))) == 3  # rest, run, rest, run
    assert (speed >= 0.0).all()


@pytest.mark.parametrize(("back", "moves"), [(0.0, False), (0.9, True)])
def test_gravity_turns_a_standing_crank_only_through_a_gear_that_it_can_drive(back: float, moves: bool) -> None:
    wiper = ClosedFormWiper()
    motor = MOTOR._replace(gear_back_efficiency=back)
    slippery = plant(motor)._replace(load=Load(2.0))  # no friction on the screen
    outputs = run_step(slippery, wiper.tables(), Rows(2000).rows, State(0.0, 0.0, 1.0, 0.0, 0.0, 0.0))
    assert (outputs[-1, ANGLE] != 1.0) == moves
    assert (outputs[:, ANGLE] <= 1.0).all()  # downhill: gravity opposes positive speed there
    assert wiper.channels(1.0)[3, 0] > 0.0


def test_the_shown_torque_moves_what_the_crank_carries() -> None:
    """Work of the shown torque = change of the wiper's energy + heat of friction; here without friction."""
    wiper = ClosedFormWiper()
    frictionless = plant(MOTOR._replace(gear_back_efficiency=1.0), step_s=1e-4)._replace(load=Load(2.0))
    outputs = run_step(frictionless, wiper.tables(), Rows(5000, relay_on=1).set(3000, 5000, relay_on=0).rows)
    crank, torque = outputs[:, OUTPUT_INDEX["crank_speed_rad_s"]], outputs[:, OUTPUT_INDEX["load_torque_n_m"]]
    power = torque * np.abs(crank)
    work = np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1])) * 1e-4])
    energy = np.array([wiper.energy(a, v) for a, v in zip(outputs[:, ANGLE], crank, strict=True)])
    assert np.ptp(energy) > 0.5
    # where the relay switches the torque jumps within a step, which the trapezium rule cannot see
    assert np.abs(work - (energy - energy[0])).max() < 1e-3 * np.ptp(energy)
