"""Slow, fast, off, with each circuit: what Figures 3-17 and 3-22 of Dooner (2016) are told to show.

Two seconds slow, two seconds fast, off at 4 s. The wipers go on slowly to park. There the mechanical circuit shorts
the motor, which stops at once; the depressed one turns it back by the given angle and disconnects it. The digital one
stops where it is, unless an ECU waits for the contact. Judged by physics, with the shipped benches.
"""

import math
from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from hilplant import Bench, Result, load_bench, simulate
from hilplant.models.records import Load
from hilplant.models.row import pack
from hilplant.simulation.entries import Entry
from hilplant.simulation.scenario import load_scenario
from hilplant.units import TURN_RAD

SUPPLY, HALF_WINDOW, REVERSE = 13.5, math.radians(7.0), math.radians(11.46)
FIGURES = {"mechanical": "3-17", "depressed": "3-22"}


@cache
def bench(name: str) -> Bench:
    return load_bench(name)


@cache
def run(name: str) -> Result:
    return simulate(bench(name), "slow_fast_off")


def from_park(result: Result) -> NDArray[np.float64]:
    """Return the crank angle in [-pi, pi), 0 at park."""
    return (result["crank_angle_rad"] + math.pi) % TURN_RAD - math.pi


def changes(result: Result) -> list[tuple[float, float]]:
    """Return when the drive of the motor changed, and to what."""
    volts = result["terminal_v"]
    return [(float(result.time_s[k]), float(volts[k])) for k in np.flatnonzero(np.diff(volts)) + 1]


@pytest.mark.parametrize("name", FIGURES)
def test_off_goes_on_with_the_slow_brush_to_park(name: str) -> None:
    """The speed is that of a run which was slow all the time, when it came by the same angle."""
    scenario = load_scenario("slow_fast_off")
    slow_only = scenario.entries | {0: (Entry(0.0, 1.0),), 1: ()}
    result, slow = run(name), simulate(bench(name), replace(scenario, entries=slow_only))
    (arrived, _), *_ = changes(result)
    assert 4.5 < arrived < 6.5
    assert from_park(result)[round(arrived * 1000)] == pytest.approx(-HALF_WINDOW, abs=0.005)
    assert (result["terminal_v"][: round(arrived * 1000)] == SUPPLY).all()
    turned, speed = np.unwrap(slow["crank_angle_rad"]), result["motor_speed_rad_s"]
    ours = np.unwrap(result["crank_angle_rad"])
    expected = np.interp(ours - TURN_RAD * (ours > turned[-1]), turned, slow["motor_speed_rad_s"])
    running, on_the_way = slice(2200, 4000), slice(4200, round(arrived * 1000))
    assert (speed[running] / expected[running]).min() > 1.1
    assert np.abs(speed[on_the_way] / expected[on_the_way] - 1.0).max() < 0.02


def test_mechanical_at_park_the_motor_is_shorted_and_stops_within_the_window() -> None:
    result = run("mechanical")
    ((arrived, drive),) = changes(result)
    tick = round(arrived * 1000)
    assert drive == 0.0
    assert np.argmax(result["park_contact"][4200:]) + 4200 == tick
    braking = result["current_a"][tick : tick + 40]
    assert braking.min() < -0.3 * result["motor_speed_rad_s"][tick] * 4.579e-2 / 1.237  # K w / R, less what L takes
    assert (np.diff(np.abs(result["motor_speed_rad_s"][tick + 1 :])) <= 1e-12).all()
    assert result["motor_speed_rad_s"][-1] == pytest.approx(0.0, abs=1e-6)
    assert result["park_contact"][-1] == 1.0
    for terminal in ("53", "53e", "31"):
        assert (result[f"terminal_{terminal}_v"][tick:] == 0.0).all()


def test_depressed_at_park_the_motor_turns_back_by_the_angle_and_is_disconnected() -> None:
    result = run("depressed")
    (arrived, reversed_v), (parked, drive) = changes(result)
    back, end = round(arrived * 1000), round(parked * 1000)
    assert (reversed_v, drive) == (-SUPPLY, 0.0)
    assert 0.03 < parked - arrived < 1.0
    assert result["motor_speed_rad_s"][end] < 0.0
    assert from_park(result)[end] == pytest.approx(-HALF_WINDOW - REVERSE, abs=0.01)
    assert (result["current_a"][end:] == 0.0).all()
    assert result["current_a"][back:end].min() < -SUPPLY / 1.237 * 0.5
    assert (np.diff(np.abs(result["motor_speed_rad_s"][end:])) <= 0.0).all()
    assert -math.pi / 2 < from_park(result)[-1] <= from_park(result)[end]
    running, turning = slice(100, back), slice(back, end)
    assert (result["terminal_31_v"][running] == SUPPLY).all()
    assert (result["terminal_53_v"][4000:back] == 0.0).all()
    assert (result["terminal_31_v"][turning] == 0.0).all()
    assert (result["terminal_53_v"][turning] == SUPPLY).all()
    assert (result["terminal_53e_v"][turning] == SUPPLY).all()


def test_digital_off_stops_where_it_is() -> None:
    result = run("default")
    assert changes(result) == [(4.0, 0.0)]
    turned = (result["crank_angle_rad"][-1] - result["crank_angle_rad"][4000]) % TURN_RAD
    assert 0.0 < turned < 0.15
    assert result["motor_speed_rad_s"][-1] == pytest.approx(0.0, abs=1e-6)


def test_the_three_circuits_wipe_alike() -> None:
    """Only the terminals differ: in the depressed circuit the common brush is the positive one."""
    runs = [run(name) for name in ("default", "mechanical", "depressed")]
    for one, other in pairwise(runs):
        for signal in ("current_a", "motor_speed_rad_s", "crank_angle_rad", "terminal_v", "park_contact"):
            assert (one[signal][:4000] == other[signal][:4000]).all(), signal
    assert (runs[0]["terminal_31_v"] == 0.0).all()
    assert (runs[2]["terminal_31_v"][:4000] == SUPPLY).all()


def commanded(
    name: str, relay_on: list[tuple[float, float]], supply: list[tuple[float, float]], **plant: float
) -> Result:
    """Run a bench with other commands: each list has times [s] and values; `plant` replaces park switch parameters."""
    chosen, base = bench(name), load_scenario("slow_fast_off")
    parameters = chosen.parameters._replace(park_switch=chosen.parameters.park_switch._replace(**plant))
    motor = parameters.motor._replace(coulomb_torque_n_m=0.045)
    parameters = parameters._replace(motor=motor, load=Load(1.0, 0.0035, 0.2738))
    entries = {0: tuple(Entry(*pair) for pair in relay_on), 2: tuple(Entry(*pair) for pair in supply)}
    chosen = replace(chosen, parameters=parameters, parameter_row=pack(parameters))
    return simulate(chosen, replace(base, entries=entries, initial={}))


def parked_at(result: Result) -> float:
    assert result["motor_speed_rad_s"][-1] == 0.0
    return float(from_park(result)[-1])


def test_depressed_the_run_begins_parked_and_stays_so() -> None:
    result = commanded("depressed", [(0.0, 0.0)], [(0.0, SUPPLY)])
    assert (result["motor_speed_rad_s"] == 0.0).all()
    assert changes(result) == []


def test_depressed_started_at_park_it_turns_back_first() -> None:
    result = simulate(
        bench("depressed"), replace(load_scenario("slow_fast_off"), entries={}, initial={"crank_angle_rad": 0.0})
    )
    assert changes(result)[-1][1] == 0.0
    assert result["terminal_v"][0] == -SUPPLY
    assert from_park(result)[-1] <= -HALF_WINDOW - REVERSE


def test_depressed_switched_on_while_turning_back_it_wipes_and_parks_again() -> None:
    plain = commanded("depressed", [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)])
    (arrived, _), *_ = changes(plain)
    again = round(arrived + 0.05, 3)
    result = commanded("depressed", [(0.0, 1.0), (1.0, 0.0), (again, 1.0), (again + 0.5, 0.0)], [(0.0, SUPPLY)])
    assert [volts for _, volts in changes(result)] == [-SUPPLY, SUPPLY, -SUPPLY, 0.0]
    assert changes(result)[1][0] == again
    assert parked_at(result) == pytest.approx(parked_at(plain), abs=0.01)


@pytest.mark.parametrize(("low", "why"), [(0.0, "lost"), (6.0, "brown-out")])
def test_depressed_turning_back_goes_on_when_the_supply_is_back(low: float, why: str) -> None:
    plain = commanded("depressed", [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)])
    (arrived, _), (parked, _) = changes(plain)
    supply = [(0.0, SUPPLY), (round(arrived + 0.02, 3), low), (round(arrived + 0.5, 3), SUPPLY)]
    result = commanded("depressed", [(0.0, 1.0), (1.0, 0.0)], supply)
    (_, reversed_v), (_, during), *_, (end, last) = changes(result)
    assert (reversed_v, during, last) == (-SUPPLY, -low, 0.0)
    assert end > parked + 0.02
    assert parked_at(result) == pytest.approx(parked_at(plain), abs=0.12), why


@pytest.mark.parametrize("name", FIGURES)
def test_a_brown_out_on_the_way_to_park_delays_it_only(name: str) -> None:
    plain = commanded(name, [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)])
    low = commanded(name, [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY), (1.1, 6.0), (2.0, SUPPLY)])
    assert changes(low)[-1][0] > changes(plain)[-1][0] + 0.1
    assert parked_at(low) == pytest.approx(parked_at(plain), abs=0.02)


def test_mechanical_off_within_the_window_it_stops_there() -> None:
    arriving = commanded("mechanical", [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)])
    (arrived, _), *_ = changes(arriving)
    inside = round(arrived + 0.02, 3)
    result = commanded("mechanical", [(0.0, 1.0), (inside, 0.0)], [(0.0, SUPPLY)])
    assert changes(result) == [(inside, 0.0)]
    assert -HALF_WINDOW < parked_at(result) < HALF_WINDOW


@pytest.mark.parametrize("name", FIGURES)
def test_a_bouncing_contact_parks_as_well_a_little_later(name: str) -> None:
    plain = commanded(name, [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)])
    result = commanded(name, [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)], bounce_ticks=6.0)
    first = round(changes(result)[0][0] * 1000)
    lifted = result["park_contact"][first : first + 6] == 0.0
    assert lifted.sum() == 3
    assert (result["current_a"][first : first + 6][lifted] == 0.0).all()
    assert (result["terminal_v"][first : first + 6][lifted] == 0.0).all()
    assert parked_at(result) == pytest.approx(parked_at(plain), abs=0.03)


def test_mechanical_a_window_shorter_than_the_braking_way_never_parks() -> None:
    """As in a real one: the motor runs out of the window and is fed again. docs/park.md gives the least window."""
    result = commanded(
        "mechanical", [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY)], half_window_rad=0.006, hysteresis_rad=0.0
    )
    assert len(changes(result)) > 6
    assert result["motor_speed_rad_s"][-1] > 50.0


@pytest.mark.parametrize("name", FIGURES)
def test_the_guard_holds_the_wiper_although_the_park_contact_feeds_it(name: str) -> None:
    result = commanded(name, [(0.0, 1.0), (1.0, 0.0)], [(0.0, SUPPLY), (1.1, math.nan), (1.2, SUPPLY)])
    held = slice(1101, None)
    assert (result["guard"][1100:] == 1.0).all()
    assert (result["motor_speed_rad_s"][held] == 0.0).all()
    assert np.ptp(result["crank_angle_rad"][held]) == 0.0
    assert (result["current_a"][held] == 0.0).all()
    assert (result["terminal_53_v"][1300:] == {"mechanical": SUPPLY, "depressed": 0.0}[name]).all()
