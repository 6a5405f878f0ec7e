"""Controller and plant together in virtual time: the shipped motor, linkage and load.

Truth is physics: where the crank is, whether the park contact is closed, how many turns were made.
"""

import math

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.ecu.relay_controller import Phase, Relays, Settings, Stalk, State, advance
from hilplant.models.plant import tick
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

POLL_TICKS = 5
SETTINGS = Settings(pause_s=2.0)
ON, FAST, BRAKE = (INPUT_INDEX[name] for name in ("relay_on", "relay_fast", "brake_torque_n_m"))
ANGLE, SPEED, CONTACT = (OUTPUT_INDEX[n] for n in ("crank_angle_rad", "crank_speed_rad_s", "park_contact"))


class Car:
    """A plant and its ECU, which looks at the park contact every 5 ms; its command acts a tick later."""

    def __init__(self, bench) -> None:
        self.bench = bench
        self.plant = bench.state_row.copy()
        self.inputs = bench.input_row.copy()
        self.outputs = np.zeros(len(OUTPUTS))
        self.ecu = State()
        self.relays = Relays(on=False, fast=False)
        self.ticks = 0
        self.driven: list[bool] = []
        tick(self.plant.copy(), self.inputs, bench.parameter_row, bench.tables, self.outputs)
        self.angles = [float(self.outputs[ANGLE])]
        self.turns = 0.0

    def drive(self, seconds: float, stalk: Stalk) -> None:
        for _ in range(round(seconds / 0.001)):
            self._tick(stalk)

    def drive_until(self, turns: float, stalk: Stalk) -> None:
        """Drive until the crank has come this many turns from where it started."""
        while self.turns < turns:
            self._tick(stalk)
            assert self.ticks < 60_000

    def _tick(self, stalk: Stalk) -> None:
        bench = self.bench
        self.inputs[ON], self.inputs[FAST] = self.relays
        tick(self.plant, self.inputs, bench.parameter_row, bench.tables, self.outputs)
        if self.ticks % POLL_TICKS == 0:
            contact = bool(self.outputs[CONTACT])
            self.ecu, self.relays = advance(self.ecu, stalk, contact, self.ticks * 0.001, SETTINGS)
        self.ticks += 1
        self.driven.append(bool(self.inputs[ON]))
        angle = float(self.outputs[ANGLE])
        self.turns += math.remainder(angle - self.angles[-1], 2.0 * math.pi) / (2.0 * math.pi)
        self.angles.append(angle)

    @property
    def parked(self) -> bool:
        """The contact is closed, the crank at rest, the relays are off."""
        at_rest = abs(self.outputs[SPEED]) < 1e-6
        return bool(self.outputs[CONTACT]) and at_rest and not self.relays.on


@pytest.fixture(scope="module")
def bench():
    return load_bench("default")


@pytest.fixture
def car(bench) -> Car:
    return Car(bench)


def rate(car: Car, stalk: Stalk) -> float:
    """Return cycles a minute over four seconds of settled running."""
    car.drive(2.0, stalk)
    before = car.turns
    car.drive(4.0, stalk)
    return (car.turns - before) * 15.0


def test_slow_and_fast_run_at_wiper_speeds_and_fast_is_faster(car):
    slow, fast = rate(car, Stalk.SLOW), rate(car, Stalk.FAST)
    assert 25.0 < slow < 60.0
    assert 1.2 * slow < fast < 90.0
    assert rate(car, Stalk.SLOW) == pytest.approx(slow, rel=0.05)


@pytest.mark.parametrize("angle_deg", range(0, 360, 10))
@pytest.mark.parametrize("stalk", [Stalk.SLOW, Stalk.FAST])
def test_off_at_any_crank_angle_ends_at_rest_inside_the_park_window(bench, stalk, angle_deg):
    car = Car(bench)
    car.drive_until(1.0 + angle_deg / 360.0, stalk)
    car.drive(6.0, Stalk.OFF)
    assert car.parked
    assert car.turns < 3.1


@pytest.mark.parametrize("tap_ms", [5, 20, 50, 100, 200])
def test_a_tap_on_the_stalk_makes_one_whole_wipe(bench, tap_ms):
    car = Car(bench)
    car.drive(0.1, Stalk.OFF)
    car.drive(tap_ms / 1000.0, Stalk.SLOW)
    car.drive(5.0, Stalk.OFF)
    assert car.parked
    assert round(car.turns) == 1


def test_a_wiper_that_stands_in_park_stays_there_while_the_stalk_is_off(car):
    car.drive(10.0, Stalk.OFF)
    assert car.parked
    assert not any(car.driven)
    assert max(car.angles) == min(car.angles)


def test_intermittent_repeats_with_the_time_of_a_wipe_and_the_pause(car):
    car.drive(20.0, Stalk.INTERMITTENT)
    starts = np.flatnonzero(np.diff(np.array(car.driven, dtype=int)) == 1) * 0.001
    ends = np.flatnonzero(np.diff(np.array(car.driven, dtype=int)) == -1) * 0.001
    assert len(starts) >= 4
    assert starts[1:] - ends[: len(starts) - 1] == pytest.approx(SETTINGS.pause_s, abs=0.01)
    assert np.ptp(np.diff(starts)[1:]) < 0.02
    wipes = ends - starts[: len(ends)]
    assert np.all((wipes > 0.8) & (wipes < 3.0))


def test_a_blocked_wiper_is_released_in_a_fault_and_wipes_again_once_free(car):
    car.drive(0.7, Stalk.SLOW)
    car.inputs[BRAKE] = 1000.0
    car.drive(SETTINGS.park_timeout_s + 0.5, Stalk.SLOW)
    assert car.ecu.phase is Phase.FAULT
    assert not car.relays.on
    car.inputs[BRAKE] = 0.0
    car.drive(0.1, Stalk.OFF)
    car.drive(1.0, Stalk.SLOW)
    car.drive(5.0, Stalk.OFF)
    assert car.parked
