"""Relays and sensors tick by tick, against tables written by hand."""

import math

import numpy as np
import pytest

from hilplant.models.park_switch import Contact
from hilplant.models.records import RelayState, RelayTiming, Sensors
from hilplant.models.relays import BETWEEN, follow
from hilplant.models.sensors import read_current, stick_contact


def contacts(timing: RelayTiming, commands: list[int]) -> list[float]:
    relay, seen = RelayState(), []
    for command in commands:
        at, relay = follow(relay, float(command), timing)
        seen.append(at)
    return seen


B = BETWEEN


@pytest.mark.parametrize(
    ("timing", "commands", "expected"),
    [
        (RelayTiming(), [0, 1, 1, 0], [0, 1, 1, 0]),
        (RelayTiming(operate_ticks=2.0), [0, 1, 1, 1, 1, 0], [0, 0, 0, 1, 1, 0]),
        (RelayTiming(release_ticks=1.0), [1, 0, 0, 0], [1, 1, 0, 0]),
        (RelayTiming(transfer_ticks=2.0), [0, 1, 1, 1, 0, 0, 0], [0, B, B, 1, B, B, 0]),
        (RelayTiming(bounce_ticks=4.0), [0, 1, 1, 1, 1, 1], [0, 1, B, 1, B, 1]),
        (RelayTiming(operate_ticks=2.0), [0, 1, 0, 0], [0, 0, 0, 0]),  # too short to leave
        (RelayTiming(operate_ticks=2.0, transfer_ticks=1.0, bounce_ticks=1.0), [0, 1, 0, 0, 0], [0, 0, 0, 0, 0]),
        (RelayTiming(stuck=1.0), [0, 1, 1], [0, 0, 0]),
        (RelayTiming(stuck=2.0), [0, 1, 0], [1, 1, 1]),
    ],
)
def test_the_contact_of_a_relay(timing: RelayTiming, commands: list[int], expected: list[float]) -> None:
    assert contacts(timing, commands) == expected


def test_a_relay_called_back_on_its_way_moves_anew_from_the_contact_that_it_left() -> None:
    timing = RelayTiming(operate_ticks=1.0, release_ticks=1.0, transfer_ticks=1.0)
    assert contacts(timing, [0, 1, 1, 1, 0, 0, 0, 0]) == [0, 0, B, 1, 1, B, 0, 0]


def test_an_ideal_sensor_shows_the_current_and_leaves_the_noise_alone() -> None:
    assert read_current(3.25, 1.0, 7.0, Sensors()) == (3.25, 7.0)


def test_gain_offset_and_limit_of_the_current_sensor() -> None:
    sensors = Sensors(altered=1.0, current_gain=1.1, current_offset_a=-0.5, current_limit_a=10.0)
    assert read_current(4.0, 0.0, 1.0, sensors).current_a == pytest.approx(3.9)
    assert read_current(40.0, 0.0, 1.0, sensors).current_a == 10.0
    assert read_current(-40.0, 0.0, 1.0, sensors).current_a == -10.0


def test_the_noise_is_normal_white_and_the_same_in_every_run() -> None:
    sensors, noise, first = Sensors(altered=1.0, current_noise_a=0.2), 1.0, []
    for _ in range(20_000):
        reading = read_current(0.0, 0.0, noise, sensors)
        noise = reading.noise
        first.append(reading.current_a)
    samples = np.array(first) / 0.2
    assert abs(samples.mean()) < 4.0 / math.sqrt(len(samples)) and samples.std() == pytest.approx(1.0, abs=0.02)
    assert np.mean(np.abs(samples) < 1.0) == pytest.approx(0.6827, abs=0.015)
    assert abs(np.mean(samples[1:] * samples[:-1])) < 0.03
    assert first[0] == read_current(0.0, 0.0, 1.0, sensors).current_a


def test_the_ripple_goes_with_the_current_and_comes_so_often_in_a_turn_of_the_motor() -> None:
    sensors = Sensors(altered=1.0, current_ripple=0.05, ripples_a_turn=12.0)
    turn = np.linspace(0.0, 2.0 * math.pi, 3600, endpoint=False)
    shown = np.array([read_current(8.0, angle, 1.0, sensors).current_a for angle in turn])
    assert (shown.min(), shown.mean(), shown.max()) == pytest.approx((7.6, 8.0, 8.4))
    assert int(np.argmax(np.abs(np.fft.rfft(shown))[1:])) + 1 == 12
    assert np.all([read_current(0.0, angle, 1.0, sensors).current_a == 0.0 for angle in turn[:50]])


def test_a_stuck_park_contact() -> None:
    moving = Contact(1.0, 0.0, 3.0)
    assert stick_contact(moving, Sensors()) == moving
    assert stick_contact(moving, Sensors(park_stuck=1.0)) == (0.0, 0.0, 0.0)
    assert stick_contact(moving, Sensors(park_stuck=2.0)) == (1.0, 1.0, 0.0)
