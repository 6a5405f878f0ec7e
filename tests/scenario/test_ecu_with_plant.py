"""Controller and plant together in virtual time: shipped motor, linkage and load.

Truth is physics: where the crank is, whether the park contact is closed, how many turns were made.
"""

import math

import pytest
from support.ecu_closed_loop import ClosedLoop

from hilplant.bench import load_bench
from hilplant.ecu.chart import Phase
from hilplant.ecu.vocabulary import Fault, Master, Stalk
from hilplant.signals import INPUT_INDEX

OFF, SLOW, FAST, INT = Stalk(), Stalk(Master.SLOW), Stalk(Master.FAST), Stalk(Master.INTERMITTENT, 2)
FLICK, WASH = Stalk(flick=True), Stalk(wash=True)
STALKS = {"off": OFF, "slow": SLOW, "fast": FAST, "intermittent": INT}
BRAKE, SUPPLY, SCREEN = (INPUT_INDEX[name] for name in ("brake_torque_n_m", "supply_v", "screen"))
LONGEST_S = 12.0


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


def parked(car: ClosedLoop) -> bool:
    """The contact is closed, the crank at rest, the relays are off, nothing is reported."""
    at_rest = abs(car["crank_speed_rad_s"]) < 1e-6
    return car["park_contact"] > 0.5 and at_rest and not car.relays.on and car.fault is Fault.NONE


def drive_until(car: ClosedLoop, turns: float, stalk: Stalk) -> None:
    """Drive until the crank has come this many turns from where it started."""
    while car.turns < turns:
        car.step(stalk)
        assert car.time_s < 60.0


def park(car: ClosedLoop) -> None:
    """Put the stalk off and wait until the wiper has come to rest."""
    begin_s = car.time_s
    while not parked(car):
        car.step(OFF)
        assert car.time_s - begin_s < LONGEST_S, f"{math.degrees(car['crank_angle_rad']):.1f} deg, {car.fault}"


def turn_time_s(car: ClosedLoop, stalk: Stalk) -> float:
    """Return how long a settled turn takes."""
    drive_until(car, math.ceil(car.turns) + 2.5, stalk)
    begin_s, turns = car.time_s, car.turns
    drive_until(car, turns + 2.0, stalk)
    return (car.time_s - begin_s) / 2.0


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


def test_a_blocked_wiper_is_released_tried_again_and_locked_out_until_the_driver_asks_anew(car):
    drive_until(car, 0.4, SLOW)
    car.inputs[BRAKE] = 1000.0
    begin_s, driven = car.time_s, 0
    while car.ecu.phase is not Phase.LOCKOUT:
        car.step(SLOW)
        driven += car.relays.on
        assert car.time_s - begin_s < 30.0
    assert car.fault is Fault.STALL
    assert driven * car.period_s < 3 * 0.6, "three tries of half a second"
    car.drive(20.0, SLOW)
    assert not car.relays.on
    car.inputs[BRAKE] = 0.0
    car.drive(0.3, OFF)
    assert car.relays.on, "off asks anew, and the wiper is on the screen"
    park(car)


def test_a_blocked_wiper_without_a_measured_current_is_found_by_its_time(light):
    settings = ClosedLoop(light).settings._replace(stall_current_a=1e9, warm_stall_current_a=1e9)
    car = ClosedLoop(light, settings)
    drive_until(car, 0.4, SLOW)
    car.inputs[BRAKE] = 1000.0
    car.drive(settings.turn_timeout_s, SLOW)
    assert car.fault is Fault.PARK_NEVER_CLOSES
    car.inputs[BRAKE] = 0.0
    park(car)


def test_a_dip_of_the_supply_stops_the_wiper_and_it_goes_on_when_the_supply_is_back(car):
    drive_until(car, 1.4, SLOW)
    car.inputs[SUPPLY] = 5.0
    car.drive(1.0, SLOW)
    assert car.fault is Fault.BROWN_OUT
    assert not car.relays.on
    car.inputs[SUPPLY] = 7.0
    car.drive(2.0, SLOW)
    assert not car.relays.on, "it waits for 8 V"
    car.inputs[SUPPLY] = 12.0
    car.drive(0.6, SLOW)
    assert car.relays.on
    car.drive(3.0, SLOW)
    assert car.fault is Fault.NONE
    park(car)


def test_a_wiper_found_on_the_screen_at_power_on_is_parked(tmp_path):
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: polynomial.yaml\nname: found\ninitial: {crank_angle_rad: 2.0}\n")
    car = ClosedLoop(load_bench(bench))
    park(car)
    assert 0.5 < car.turns < 0.8


def test_a_wiper_that_coasts_out_of_the_window_while_the_switch_falls_silent_is_reported_and_parked(tmp_path):
    bench = tmp_path / "bench.yaml"
    switch = "{park_angle_deg: 0, window_deg: 4.5, hysteresis_deg: 0.5, bounce_ms: 0}"
    bench.write_text(f"extends: polynomial.yaml\nname: narrow\nplant:\n  park_switch: {switch}\n")
    car = ClosedLoop(load_bench(bench), delay_ticks=5)
    drive_until(car, 1.5, FAST)
    while car.relays.on:
        car.step(OFF)
    car.park_known = False
    car.drive(1.0, OFF)
    assert car["park_contact"] < 0.5, "it has coasted out"
    assert car.fault is Fault.PARK_UNKNOWN
    car.park_known = True
    park(car)


@pytest.mark.parametrize("bounce_ms", [2, 5, 10])
def test_a_contact_that_bounces_within_reason_is_no_fault(tmp_path, bounce_ms):
    bench = tmp_path / "bench.yaml"
    switch = f"{{park_angle_deg: 0, window_deg: 14, hysteresis_deg: 0.5, bounce_ms: {bounce_ms}}}"
    bench.write_text(f"extends: polynomial.yaml\nname: bouncing\nplant:\n  park_switch: {switch}\n")
    car = ClosedLoop(load_bench(bench))
    for _ in range(5):
        drive_until(car, car.turns + 1.4, FAST)
        assert car.fault is Fault.NONE
        park(car)


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
