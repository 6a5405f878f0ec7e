"""What is measured of the plant, where sensor or contact are not ideal."""

import math
from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.park_switch import Contact
from hilplant.models.records import Sensors

#: `Sensors.park_stuck`.
STUCK_OPEN, STUCK_CLOSED = 1.0, 2.0

#: Park and Miller's generator of random numbers (Comm. ACM 31, 1988): exact in floats of 64 bits.
MULTIPLIER, MODULUS = 16807.0, 2147483647.0


class SensorReading(NamedTuple):
    """The measured current [A], and where the noise has come to."""

    current_a: float
    noise: float


@compiled
def read_current(current_a: float, motor_angle_rad: float, noise: float, sensors: Sensors) -> SensorReading:
    """Return gain x current (1 + ripple) + offset + noise, limited to what the sensor can show.

    The noise is normal (Box and Muller), a sample a tick, and the same in every run: its seed is a state. The ripple is
    that of the commutator, a cosine over the angle of the motor shaft [rad]; of one that is quicker than half the ticks
    its alias is seen, as by any sampling sensor without a filter.
    """
    if sensors.altered < 0.5:
        return SensorReading(current_a, noise)
    rippled = current_a * (1.0 + sensors.current_ripple * math.cos(sensors.ripples_a_turn * motor_angle_rad))
    measured = sensors.current_gain * rippled + sensors.current_offset_a
    if sensors.current_noise_a > 0.0:
        first = noise * MULTIPLIER % MODULUS
        noise = first * MULTIPLIER % MODULUS
        radius = math.sqrt(-2.0 * math.log(first / MODULUS))
        measured += sensors.current_noise_a * radius * math.cos(2.0 * math.pi * noise / MODULUS)
    if sensors.current_limit_a > 0.0:
        measured = min(sensors.current_limit_a, max(-sensors.current_limit_a, measured))
    return SensorReading(measured, noise)


@compiled
def stick_contact(contact: Contact, sensors: Sensors) -> Contact:
    """Return the park contact, or one that does not move: welded, or worn away."""
    if sensors.park_stuck == STUCK_OPEN:
        return Contact(0.0, 0.0, 0.0)
    if sensors.park_stuck == STUCK_CLOSED:
        return Contact(1.0, 1.0, 0.0)
    return contact
