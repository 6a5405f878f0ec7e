"""Random hands, faults and supplies on controller and plant, 100,000 looks of the controller each, always the same.

What must hold whatever happens: relays are never on without a way to park, and a wiper that stands off park with its
relays off has a fault reported. Truth is the plant's crank, not what the controller believes.
"""

import math
import random

import pytest
from support.ecu_closed_loop import ClosedLoop

from hilplant.bench import load_bench
from hilplant.ecu.chart import PAUSES, RESTING, Phase
from hilplant.ecu.relay_controller import ControllerState, advance
from hilplant.ecu.vocabulary import EcuInputs, Fault, Master, RelaySettings, Stalk
from hilplant.signals import INPUT_INDEX

LOOKS = 100_000
OFF, FLICK = Stalk(), Stalk(flick=True)
BRAKE, SUPPLY = INPUT_INDEX["brake_torque_n_m"], INPUT_INDEX["supply_v"]
#: Short times, so that much happens: everything else is as shipped.
SETTINGS = RelaySettings(pauses_s=(0.2, 0.4, 0.6, 0.8, 1.0, 1.2), retry_pause_s=0.5, turn_timeout_s=4.0)
#: From relays off to rest, and from there to the debounced word of the contact.
COASTING_S = 0.15


@pytest.fixture(scope="module")
def bench():
    return load_bench("polynomial")


def some_stalk(chance: random.Random) -> Stalk:
    return Stalk(Master(chance.randrange(4)), chance.randint(1, 6), chance.random() < 0.1, chance.random() < 0.1)


def some_trouble(chance: random.Random, car: ClosedLoop) -> None:
    """Let something go wrong, or right again."""
    car.park_known = chance.random() > 0.05
    car.inputs[BRAKE] = 1000.0 if chance.random() < 0.07 else 0.0
    car.inputs[SUPPLY] = chance.choice([5.0, 7.0, 9.0, 16.0]) if chance.random() < 0.2 else 13.5


def way_to_park(car: ClosedLoop) -> bool:
    """Say whether the wiper comes to park once all is well: stalk off, and a flick where it is locked out."""
    car = car.copy()
    car.park_known, car.inputs[BRAKE], car.inputs[SUPPLY] = True, 0.0, 13.5
    return parks(car, OFF) or (car.ecu.phase is Phase.LOCKOUT and parks(car, FLICK))


def parks(car: ClosedLoop, first: Stalk) -> bool:
    """Say whether the wiper comes to rest in park within 6 s after a tenth of a second with another stalk."""
    car.drive(0.1, first)
    for _ in range(1200):
        car.step(OFF)
        if not car.relays.on and car["park_contact"] > 0.5 and abs(car["crank_speed_rad_s"]) < 1e-6:
            return True
    return False


def search(bench, seed: int, troubled: bool) -> ClosedLoop:
    """Drive at random; check at each look."""
    chance, car = random.Random(seed), ClosedLoop(bench, SETTINGS, delay_ticks=seed % 6)
    stalk, left, faults, stops = OFF, 0, set(), 0
    off_park_s = on_since_s = 0.0
    for look in range(LOOKS):
        if left == 0:
            stalk, left = some_stalk(chance), chance.choice([1, 3, 10, 40, 150, 600])
            if troubled:
                some_trouble(chance, car)
        left -= 1
        was_on = car.relays.on
        car.step(stalk)
        faults.add(car.fault)
        stops += was_on and not car.relays.on
        resting = not car.relays.on and car["park_contact"] < 0.5
        off_park_s = off_park_s + car.period_s if resting and car.fault is Fault.NONE else 0.0
        assert off_park_s < COASTING_S, f"stands off park unreported in look {look}: {car.ecu}"
        on_since_s = on_since_s + car.period_s if car.relays.on and not car.ecu.senses.arrived else 0.0
        assert on_since_s < SETTINGS.turn_timeout_s + 0.1, f"drives without end in look {look}: {car.ecu}"
        if look % 400 == 0:
            assert way_to_park(car), f"no way to park from look {look}: {car.ecu}"
    print(f"seed {seed}: {car.turns:.0f} turns, {stops} stops, faults {sorted(fault.value for fault in faults)}")
    assert faults == {Fault.NONE} or troubled
    return car


def test_hands_alone_cause_no_fault_and_every_stop_is_in_park(bench):
    assert search(bench, seed=1, troubled=False).turns > 100


@pytest.mark.parametrize("seed", [2, 3])
def test_no_mishap_leaves_relays_on_without_a_way_to_park_or_a_wiper_off_park_unreported(bench, seed):
    assert search(bench, seed, troubled=True).turns > 50


def test_no_sequence_of_inputs_however_absurd_drives_for_ever_or_is_left_for_good():
    """The controller alone with contacts and currents that no wiper could make."""
    chance, state, on_s, phases = random.Random(4), ControllerState(), 0.0, set()
    stalk, contact, current_a, supply_v = OFF, True, 1.0, 13.5
    for look in range(LOOKS):
        if chance.random() < (0.02, 0.003)[look // 500 % 2]:
            stalk = some_stalk(chance)
        if chance.random() < (0.005, 0.02, 0.0, 0.0, 0.05, 0.5)[look // 1000 % 6]:  # at 0 it is stuck, for 10 s
            contact = chance.choice([True, True, False, False, None])
        if chance.random() < 0.01:
            current_a = chance.choice([1.0, 1.0, 11.0, math.nan])
            supply_v = chance.choice([13.5, 13.5, 5.0, math.nan])
        inputs = EcuInputs(stalk, contact, current_a, supply_v)
        state, relays, fault = advance(state, inputs, look * 0.005, SETTINGS)
        phases.add(state.phase)
        on_s = on_s + 0.005 if relays.on and not state.senses.arrived else 0.0
        assert on_s < SETTINGS.turn_timeout_s + 0.1
        assert not (relays.on and (contact is None or supply_v < SETTINGS.brown_out_v))
        assert fault is not Fault.NONE or relays.on or state.phase in RESTING
    assert phases | set(PAUSES) == set(Phase), f"never came to {set(Phase) - phases}"
    assert phases & set(PAUSES)


def test_a_wiper_blocked_for_good_is_driven_for_less_than_two_seconds_whatever_is_tried(bench):
    """Each lockout costs three tries of half a second, and only the driver's asking anew begins another."""
    car = ClosedLoop(bench, SETTINGS)
    car.drive(0.7, Stalk(Master.SLOW))
    car.inputs[BRAKE] = 1000.0
    for stalk in (Stalk(Master.SLOW), OFF, Stalk(Master.FAST), OFF):
        driven = 0
        for _ in range(4000):
            car.step(stalk)
            driven += car.relays.on
        assert car.ecu.phase is Phase.LOCKOUT
        assert 0.0 < driven * car.period_s < 2.0
