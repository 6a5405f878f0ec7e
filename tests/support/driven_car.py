"""Drive controller and plant together as a driver does: until so many turns are made, into park."""

import math

from support.ecu_closed_loop import ClosedLoop

from hilplant.ecu.vocabulary import Fault, Master, Stalk

OFF, SLOW, FAST, INT = Stalk(), Stalk(Master.SLOW), Stalk(Master.FAST), Stalk(Master.INTERMITTENT, 2)
FLICK, WASH = Stalk(flick=True), Stalk(wash=True)
LONGEST_S = 12.0


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
