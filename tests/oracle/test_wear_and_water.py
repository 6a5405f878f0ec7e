"""Wear against motors that were worn beforehand, and the water film against an adaptive solver and on paper."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from support.closed_form import ClosedFormWiper

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.models.records import Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.slow_records import Water, WaterState, Wear, WearState
from hilplant.models.water import wetness
from hilplant.signals import OUTPUT_INDEX
from hilplant.thesis.solver import WET, Rows, run_step

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
FRICTION = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02
)
WIPER = ClosedFormWiper()
SWITCH, SIDES = ParkSwitch(0.0, 0.1, 0.02, 0.0), (Arm(0.3, 0.69), Arm(-0.4, 0.54))
#: Rain of 36 mm/h on a screen that catches all of it is 0.01 mm/s.
WATER = Water(1.0, 1.0, 0.1, 0.2, 0.05, 1e-4, 0.9, 0.001, 0.005, 0.02, 0.01)


def plant(motor: Motor = MOTOR, wear_factor: float = 1.0, switch: ParkSwitch = SWITCH, **slow: object) -> Parameters:
    blade = Blade(7.615, wear_factor)
    load = Load(2.0, friction=FRICTION, left_blade=blade, right_blade=blade)
    return Parameters(1e-3, motor, switch, load, *SIDES)._replace(**slow)


def shown(outputs: Floats, name: str) -> Floats:
    return outputs[:, OUTPUT_INDEX[name]]


def test_a_worn_wiper_moves_as_one_that_was_built_so() -> None:
    """500 wipes: friction times 1.25, 0.1 ohm at each brush, 0.03 rad from each end of the window."""
    wear = Wear(1.0, blades=5e-4, brushes_ohm=2e-4, cam_rad=6e-5)
    rows = Rows(900, screen=WET, relay_on=1).rows
    ours = run_step(plant(wear=wear), WIPER.tables(), rows, State(wear=WearState(500.0)))
    slow, fast = (brush._replace(resistance_ohm=brush.resistance_ohm + 0.1) for brush in (MOTOR.slow, MOTOR.fast))
    built = plant(MOTOR._replace(slow=slow, fast=fast), 1.25, SWITCH._replace(half_window_rad=0.07))
    theirs = run_step(built, WIPER.tables(), rows, State())
    new = run_step(plant(), WIPER.tables(), rows, State())
    for name in ("current_a", "motor_speed_rad_s", "crank_angle_rad"):
        # half a wipe more of wear meanwhile is 1e-3 of what 500 did
        apart = np.abs(shown(ours, name) - shown(theirs, name)).max()
        assert apart < 2e-3 * np.abs(shown(new, name) - shown(theirs, name)).max(), name
    assert (shown(ours, "park_contact") == shown(theirs, "park_contact")).all()


def test_wear_grows_by_the_turns_of_the_crank_and_stalls_the_wiper_in_the_end() -> None:
    """By the time that 3 ohm stand before each brush the current of a stall is V/R, on paper."""
    wear = Wear(1.0, brushes_ohm=1.0)
    outputs = run_step(plant(wear=wear, load=Load(0.0)), WIPER.tables(), Rows(4000, relay_on=1).rows)
    turns = np.unwrap(shown(outputs, "crank_angle_rad")) / (2.0 * np.pi)
    assert turns[-1] > 1.0
    speed, ohm = shown(outputs, "motor_speed_rad_s"), 1.237 + turns
    k, b, dry = 4.579e-2, 1.582e-4, 0.045
    settled = (13.5 * k - ohm * dry) / (ohm * b + k * k)  # the slow change is followed at once
    assert speed[1500:] == pytest.approx(settled[1500:], rel=0.02)


def test_the_film_follows_an_adaptive_solver_through_rain_washer_wipes_and_pauses() -> None:
    rows = Rows(6000, rain_mm_h=30.0, vehicle_speed_m_s=5.0)
    rows.set(500, 3500, relay_on=1).set(2000, 2500, washer_pump=1).set(3000, 6000, rain_mm_h=0.0)
    outputs = run_step(plant(water=WATER), WIPER.tables(), rows.rows)
    crank = np.abs(shown(outputs, "crank_speed_rad_s"))
    times = np.arange(6000) * 1e-3

    def rate(t: float, h: Floats) -> Floats:
        k = min(5999, int(t * 1000.0 + 1e-9))
        rain, pump = (30.0 if k < 3000 else 0.0) / 3600.0, 0.2 if 2000 <= k < 2500 else 0.0
        speed = np.interp(t, times, crank)
        gain = rain * (1.0 + 0.1 * 5.0) + pump - (1e-4 if h[0] > 0.0 else 0.0)
        return np.array(gain - (0.05 + 0.9 * speed / math.pi) * h)

    truth = [0.0]
    for first, last in ((0, 500), (500, 2000), (2000, 2500), (2500, 3000), (3000, 3500), (3500, 5999)):
        run = solve_ivp(rate, (times[first], times[last] - 1e-9), [truth[-1]], "LSODA",
                        np.minimum(times[first + 1 : last + 1], times[last] - 1e-9), rtol=1e-9, atol=1e-12,
                        max_step=5e-3)  # fmt: skip
        truth.extend(run.y[0])
    film = shown(outputs, "water_film_mm")
    assert film == pytest.approx(np.array(truth), abs=2e-3 * max(truth))
    assert film[2499] > 5.0 * film[1999] and film[-1] < 0.5 * film[3000]


def test_a_steady_film_has_the_thickness_on_paper_and_leaves_its_wetness_and_the_sensor_s_signal() -> None:
    fast_film = WATER._replace(runoff_per_s=3.0)
    outputs = run_step(plant(water=fast_film), WIPER.tables(), Rows(6000, rain_mm_h=72.0).rows)
    expected = (72.0 / 3600.0 - 1e-4) / 3.0
    assert shown(outputs, "water_film_mm")[-1] == pytest.approx(expected, rel=1e-6)
    assert shown(outputs, "rain_sensor")[-1] == pytest.approx(1.0 - math.exp(-expected / 0.01), rel=1e-6)
    assert shown(outputs, "wetness")[-1] == pytest.approx(np.interp(expected, [0.001, 0.005, 0.02], [0.0, 0.5, 1.0]))


def test_wetness_is_the_straight_line_between_its_three_thicknesses() -> None:
    for film in np.linspace(0.0, 0.03, 61):
        assert wetness(film, WATER) == pytest.approx(np.interp(film, [0.001, 0.005, 0.02], [0.0, 0.5, 1.0]), abs=1e-12)


def test_a_screen_that_dries_while_it_is_wiped_passes_through_tacky_and_costs_current() -> None:
    wet = State(water=WaterState(0.05))
    outputs = run_step(plant(water=WATER), WIPER.tables(), Rows(9000, relay_on=1).rows, wet)
    level, current = shown(outputs, "wetness"), shown(outputs, "current_a")
    assert level[0] == 1.0 and level[-1] == 0.0 and (np.diff(level) <= 0.0).all()
    tacky = np.abs(level - 0.5) < 0.3
    assert current[tacky].mean() > 1.5 * current[(level == 1.0) & (np.arange(9000) > 300)].mean()
    by_hand = run_step(plant(), WIPER.tables(), Rows(9000, relay_on=1).set(0, 9000, screen=level).rows)
    assert np.array_equal(shown(by_hand, "current_a"), current)  # the film acts by the wetness alone


def test_the_screen_catches_what_falls_on_it_and_what_the_vehicle_runs_into() -> None:
    keys = ("washer_mm_s: 0.05, runoff_percent_s: 5, evaporation_mm_h: 0.5, wiped_percent: 60, dry_mm: 0.001, "
            "tacky_mm: 0.004, wet_mm: 0.02, sensor_mm: 0.05")  # fmt: skip
    water = load_bench(f"extends: default.yaml\nname: x\nplant: {{water: {{{keys}}}}}\n").parameters.water
    assert (water.catch, water.catch_s_m) == pytest.approx((math.sin(0.57), math.cos(0.57) / 6.5))
    assert math.exp(-water.wiped) == pytest.approx(0.4)
    assert (water.runoff_per_s, water.evaporation_mm_s) == pytest.approx((0.05, 0.5 / 3600.0))


def test_without_water_and_wear_rain_and_washer_change_no_bit() -> None:
    calm, storm = (run_step(plant(), WIPER.tables(), Rows(600, relay_on=1, rain_mm_h=r, washer_pump=p).rows)
                   for r, p in ((0.0, 0.0), (90.0, 1.0)))  # fmt: skip
    assert np.array_equal(calm, storm)
