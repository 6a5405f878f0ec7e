"""What the controller does when something is wrong with the real plant: blocked, a dip of the supply, a bad switch."""

import pytest
from support.driven_car import FAST, OFF, SLOW, drive_until, park
from support.ecu_closed_loop import ClosedLoop

from hilplant.bench import load_bench
from hilplant.ecu.chart import Phase
from hilplant.ecu.vocabulary import Fault
from hilplant.signals import INPUT_INDEX

BRAKE, SUPPLY, SCREEN = (INPUT_INDEX[name] for name in ("brake_torque_n_m", "supply_v", "screen"))


@pytest.fixture(scope="module")
def light():
    """The no-load torque, whatever the screen."""
    return load_bench("polynomial")


@pytest.fixture
def car(light) -> ClosedLoop:
    return ClosedLoop(light)


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
