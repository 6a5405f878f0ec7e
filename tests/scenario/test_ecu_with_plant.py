"""Controller and plant together in virtual time: shipped motor, linkage and load.

Truth is physics: where the crank is, whether the park contact is closed, how many turns were made.
"""

import math

import pytest
from support.driven_car import FAST, FLICK, INT, OFF, SLOW, WASH, drive_until, park, parked, turn_time_s
from support.ecu_closed_loop import ClosedLoop

from hilplant.bench import load_bench
from hilplant.ecu.vocabulary import Fault, Master, Stalk
from hilplant.signals import INPUT_INDEX

STALKS = {"off": OFF, "slow": SLOW, "fast": FAST, "intermittent": INT}
BRAKE, SUPPLY, SCREEN = (INPUT_INDEX[name] for name in ("brake_torque_n_m", "supply_v", "screen"))


@pytest.fixture(scope="module")
def light():
    """The no-load torque, whatever the screen."""
    return load_bench("polynomial")


@pytest.fixture(scope="module")
def loaded():
    """Blades, masses and a dry screen."""
    return load_bench("default")


@pytest.fixture
def car(light) -> ClosedLoop:
    return ClosedLoop(light)


def test_slow_and_fast_run_at_wiper_speeds_and_fast_is_faster(car):
    slow, fast = turn_time_s(car, SLOW), turn_time_s(car, FAST)
    assert 1.0 < slow < 2.4
    assert 0.66 < fast < slow / 1.2
    assert turn_time_s(car, SLOW) == pytest.approx(slow, rel=0.02)


@pytest.mark.parametrize("before", ["slow", "fast", "intermittent"])
@pytest.mark.parametrize("after", ["off", "slow", "fast", "intermittent"])
def test_whatever_the_stalk_does_at_any_of_360_angles_off_ends_in_park(light, before, after):
    car = ClosedLoop(light)
    drive_until(car, 1.0, STALKS[before])  # intermittent has its pause there: the wiper stands at -3 degrees
    for degree in range(360):
        drive_until(car, 1.0 + degree / 360.0, STALKS[before])
        trial = car.copy()
        trial.drive(0.1, STALKS[after])
        park(trial)
        assert trial.turns < car.turns + 2.1
        assert abs(math.remainder(trial["crank_angle_rad"], 2.0 * math.pi)) < math.radians(7.5)


@pytest.mark.parametrize("supply_v", [9.0, 16.0])
@pytest.mark.parametrize("wetness", [0.0, 1.0])
@pytest.mark.parametrize("before", ["slow", "fast"])
def test_off_ends_in_park_with_blades_at_low_and_high_supply_on_dry_and_wet_glass(loaded, supply_v, wetness, before):
    car = ClosedLoop(loaded, delay_ticks=5)
    car.inputs[SUPPLY], car.inputs[SCREEN] = supply_v, wetness
    for degree in range(0, 360, 30):
        drive_until(car, 1.0 + degree / 360.0, STALKS[before])
        park(car.copy())


@pytest.mark.parametrize("before", ["slow", "fast"])
def test_off_at_any_of_360_angles_ends_in_park_with_blades_on_dry_glass(loaded, before):
    car = ClosedLoop(loaded)
    drive_until(car, 1.0, STALKS[before])
    for degree in range(360):
        drive_until(car, 1.0 + degree / 360.0, STALKS[before])
        trial = car.copy()
        park(trial)
        assert trial.turns < car.turns + 2.1
        assert abs(math.remainder(trial["crank_angle_rad"], 2.0 * math.pi)) < math.radians(7.5)


def test_speeds_change_at_park_and_only_there(car):
    drive_until(car, 0.3, SLOW)
    changes = []
    for stalk in (FAST, SLOW, FAST):
        before = car.relays
        while car.relays == before:
            car.step(stalk)
        changes.append(math.degrees(math.remainder(car["crank_angle_rad"], 2.0 * math.pi)))
        car.drive(0.4, stalk)
    assert changes == pytest.approx([-6.0, -6.0, -6.0], abs=1.5), "the window begins at -7"


@pytest.mark.parametrize("tap_ms", [5, 20, 50, 100, 200])
@pytest.mark.parametrize("tap", [SLOW, FLICK], ids=["slow", "flick"])
def test_a_tap_on_stalk_or_button_makes_one_whole_wipe(car, tap_ms, tap):
    car.drive(0.1, OFF)
    car.drive(tap_ms / 1000.0, tap)
    car.drive(4.0, OFF)
    assert parked(car)
    assert round(car.turns) == 1


def test_flick_is_fast_and_goes_on_while_it_is_held(car):
    car.drive(0.1, OFF)
    car.step(FLICK)
    assert car.relays.fast
    drive_until(car, 2.5, FLICK)
    park(car)
    assert round(car.turns) == 3


def test_washing_wipes_while_pressed_and_three_times_after(car):
    car.drive(0.1, OFF)
    drive_until(car, 1.3, WASH)
    park(car)
    assert round(car.turns) == 4, "the wipe that had begun is the first of the three"


def test_a_wiper_that_stands_in_park_stays_there_while_the_stalk_is_off(car):
    car.drive(10.0, OFF)
    assert parked(car)
    assert car.turns == 0.0


@pytest.mark.parametrize("interval", [1, 2, 3, 4, 5, 6])
def test_intermittent_repeats_with_the_time_of_a_wipe_and_the_pause_of_its_switch(car, interval):
    stalk, starts, ends = Stalk(Master.INTERMITTENT, interval), [], []
    while len(starts) < 3:
        on = car.relays.on
        car.step(stalk)
        if car.relays.on is not on:
            (starts if car.relays.on else ends).append(car.time_s)
    pause_s = car.settings.pauses_s[interval - 1]
    for start, end, again in zip(starts, ends, starts[1:], strict=False):
        assert 1.3 < end - start < 1.7
        assert again - end == pytest.approx(pause_s, abs=0.0051), "one look of the controller"


@pytest.mark.parametrize("circuit", ["mechanical", "depressed"])
@pytest.mark.parametrize("before", ["slow", "fast", "intermittent"])
def test_motors_that_park_themselves_are_parked_and_started_again_without_a_fault(circuit, before):
    car = ClosedLoop(load_bench(circuit))
    low_deg, high_deg = (-25.0, -7.5) if circuit == "depressed" else (-7.5, 7.5)
    for degree in range(0, 360, 20):
        drive_until(car, 1.0 + degree / 360.0, STALKS[before])
        trial, turns = car.copy(), car.turns
        trial.drive(5.0, OFF)
        assert low_deg < math.degrees(math.remainder(trial["crank_angle_rad"], 2.0 * math.pi)) < high_deg
        assert trial["crank_speed_rad_s"] == pytest.approx(0.0, abs=1e-6)
        assert trial.turns < turns + 2.1
        parked_at = trial.turns
        trial.drive(0.1, FLICK)
        trial.drive(4.0, OFF)
        assert trial.turns - parked_at == pytest.approx(1.0, abs=0.02), "a flick from where it rests is one turn"
        assert trial.fault is Fault.NONE
