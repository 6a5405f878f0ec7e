"""Switching circuit between battery and motor: what drives the armature, and what its terminals show.

Voltage, current and speed are positive in the wiping direction in every circuit. Which end of the armature is the
positive one then is the circuit's matter (:mod:`hilplant.models.wiring`), and seen at the terminals.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.park_phase import next_phase, phase_at_rest
from hilplant.models.park_switch import Contact
from hilplant.models.records import Brush, Motor, Parameters, State
from hilplant.models.row import changed
from hilplant.models.wiring import CIRCUITS, DEPRESSED, MECHANICAL, Leads, depressed, digital, mechanical
from hilplant.signals import Inputs

__all__ = ["CIRCUITS", "Connection", "connect", "next_phase", "phase_at_rest"]


class Connection(NamedTuple):
    """What the armature sees, and the motor's terminals against ground [V].

    `terminal_v` lies between the brush in the circuit and the common one and drives the motor in the wiping
    direction where it is positive. `closed` is 0 where the armature is open: its current is 0 then.
    """

    brush: Brush
    terminal_v: float
    closed: float
    terminal_53_v: float
    terminal_53b_v: float
    terminal_53e_v: float
    terminal_31_v: float


class Interrupted(NamedTuple):
    """What a cut in the armature's lead changes."""

    terminal_v: float
    closed: float


@compiled
def connect(inputs: Inputs, parameters: Parameters, contact: Contact, park_phase: float, state: State) -> Connection:
    """Return what the circuit of the park switch connects at this instant.

    `park_phase` is what :func:`next_phase` returned for this instant; only the depressed circuit reads it. While the
    guard is set the armature is cut out: no park contact may drive it then.
    """
    motor, circuit, speed = parameters.motor, parameters.park_switch.circuit, state.motor_speed_rad_s
    if circuit == MECHANICAL:
        connection = seen_by_armature(mechanical(inputs, contact), motor, 1.0, speed)
    elif circuit == DEPRESSED:
        connection = seen_by_armature(depressed(inputs, contact, park_phase), motor, -1.0, speed)
    else:
        connection = seen_by_armature(digital(inputs), motor, 1.0, speed)
    return interrupted(connection) if state.guard > 0.5 else connection


@compiled
def interrupted(connection: Connection) -> Connection:
    """Return the connection with its armature cut out: no voltage drives it, no current flows."""
    return changed(connection, Interrupted(terminal_v=0.0, closed=0.0))


@compiled
def seen_by_armature(leads: Leads, motor: Motor, polarity: float, motor_speed_rad_s: float) -> Connection:
    """Return brush, voltage and terminals; `polarity` is -1 where the motor wipes with its common brush positive.

    A brush that nothing drives shows the common brush's potential and the back-EMF of its own constant; the
    reaction of the armature current on it is neglected. What else nothing drives is shown at ground: the common
    brush, and the line from the park contact unless it is joined to the slow brush.
    """
    common_v, slow_v, fast_v = leads.common.potential_v, leads.slow.potential_v, leads.fast.potential_v
    if leads.slow.driven < 0.5:
        slow_v = common_v + polarity * motor.slow.constant_v_s * motor_speed_rad_s
    if leads.fast.driven < 0.5:
        fast_v = common_v + polarity * motor.fast.constant_v_s * motor_speed_rad_s
    park_v = slow_v if leads.joined > 0.5 else leads.park.potential_v
    brush, terminal_v, closed = motor.slow, polarity * (slow_v - common_v), leads.slow.driven
    if leads.fast.driven > 0.5:
        brush, terminal_v, closed = motor.fast, polarity * (fast_v - common_v), 1.0
    if closed * leads.common.driven < 0.5:
        return Connection(brush, 0.0, 0.0, slow_v, fast_v, park_v, common_v)
    return Connection(brush, terminal_v + 0.0, 1.0, slow_v, fast_v, park_v, common_v)
