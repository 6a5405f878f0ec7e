"""Switching circuit between battery and motor: what drives the armature, and what its terminals show.

Voltage, current and speed are positive in the wiping direction in every circuit. Which end of the armature is the
positive one then is the circuit's matter (:mod:`hilplant.models.wiring`), and seen at the terminals.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.park_phase import next_phase, phase_at_rest
from hilplant.models.park_switch import Contact
from hilplant.models.records import Brush, Motor, Parameters, State, Wiring
from hilplant.models.terminals import NO_SECOND, Second, Shaft, bridged, cut_out, meshed, potentials, reduced, wired
from hilplant.models.wiring import CIRCUITS, DEPRESSED, MECHANICAL, Leads, depressed, digital, mechanical
from hilplant.signals import Inputs

__all__ = ["CIRCUITS", "Connection", "connect", "next_phase", "phase_at_rest"]


class Connection(NamedTuple):
    """What the armature sees, and the motor's terminals against ground [V].

    `source_v` drives the motor in the wiping direction where it is positive, through the resistance of `brush`, which
    contains that of the wires; `terminal_v` is what lies between the chosen brush and the common one. `closed` is 0
    where the armature is open: its current is 0 then. `fast` is 1 where the fast brush is the chosen one.
    """

    brush: Brush
    source_v: float
    terminal_v: float
    closed: float
    fast: float
    second: Second
    terminal_53_v: float
    terminal_53b_v: float
    terminal_53e_v: float
    terminal_31_v: float
    supply_v: float
    supply_current_a: float


@compiled
def connect(inputs: Inputs, parameters: Parameters, contact: Contact, park_phase: float, state: State) -> Connection:
    """Return what the circuit of the park switch connects at this instant.

    `park_phase` is what :func:`next_phase` returned for this instant; only the depressed circuit reads it. While the
    guard is set the armature is cut out: no park contact may drive it then. The thermal switch does the same: it lies
    inside the motor, in series with the common brush.
    """
    circuit, polarity = parameters.park_switch.circuit, 1.0
    if circuit == MECHANICAL:
        leads = mechanical(inputs, contact)
    elif circuit == DEPRESSED:
        leads, polarity = depressed(inputs, contact, park_phase), -1.0
    else:
        leads = digital(inputs)
    cut = 1.0 if state.guard > 0.5 or state.heat.opened > 0.5 else 0.0
    now = Shaft(state.current_a, state.motor_speed_rad_s, cut)
    if parameters.wiring.altered > 0.5:
        return through_wires(leads, parameters, inputs.supply_v, polarity, now)
    return seen_by_armature(leads, parameters.motor, inputs.supply_v, polarity, now)


@compiled
def seen_by_armature(leads: Leads, motor: Motor, supply_v: float, polarity: float, now: Shaft) -> Connection:
    """Return brush, voltage and terminals; `polarity` is -1 where the motor wipes with its common brush positive.

    A brush that nothing drives shows the common brush's potential and the back-EMF of its own constant; the
    reaction of the armature current on it is neglected. What else nothing drives is shown at ground: the common
    brush, and the line from the park contact unless it is joined to the slow brush.
    """
    common_v, slow_v, fast_v = leads.common.share * supply_v, leads.slow.share * supply_v, leads.fast.share * supply_v
    if leads.slow.driven < 0.5:
        slow_v = common_v + polarity * motor.slow.constant_v_s * now.speed_rad_s
    if leads.fast.driven < 0.5:
        fast_v = common_v + polarity * motor.fast.constant_v_s * now.speed_rad_s
    park_v = slow_v if leads.joined > 0.5 else leads.park.share * supply_v
    fast, brush, chosen, terminal_v = 0.0, motor.slow, leads.slow, polarity * (slow_v - common_v)
    if leads.fast.driven > 0.5:
        fast, brush, chosen, terminal_v = 1.0, motor.fast, leads.fast, polarity * (fast_v - common_v)
    closed = chosen.driven * leads.common.driven * (1.0 - now.cut)
    if closed < 0.5:
        terminal_v = 0.0
    taken = closed * polarity * (chosen.share - leads.common.share) * now.current_a
    return Connection(
        brush, terminal_v + 0.0, terminal_v + 0.0, closed, fast, NO_SECOND, slow_v, fast_v, park_v, common_v, supply_v,
        taken + 0.0,
    )  # fmt: skip


@compiled
def through_wires(leads: Leads, parameters: Parameters, supply_v: float, polarity: float, now: Shaft) -> Connection:
    """Return the same where wires, supply and ground are not ideal; see :mod:`hilplant.models.terminals`.

    The brush that the switches chose comes first; where nothing reaches it, the other one does.
    """
    wiring, motor = parameters.wiring, parameters.motor
    park = wired(leads.park.share, leads.park.driven, 0.0, 0.0, wiring.wire_53e)
    common = wired(leads.common.share, leads.common.driven, 0.0, 0.0, wiring.wire_31)
    slow, alone = wired(leads.slow.share, leads.slow.driven, 0.0, 0.0, wiring.wire_53), park.load_s
    if leads.joined > 0.5:
        slow, alone = wired(park.share, park.driven, park.resistance_ohm, park.load_s, wiring.wire_53), 0.0
    fast = wired(leads.fast.share, leads.fast.driven, 0.0, 0.0, wiring.wire_53b)
    is_fast = fast.driven > 0.5 and (leads.fast.driven > 0.5 or slow.driven < 0.5)
    first, second = (fast, slow) if is_fast else (slow, fast)
    chosen, other = (motor.fast, motor.slow) if is_fast else (motor.slow, motor.fast)
    ports = bridged(first, second, common, wiring.brushes_s, alone)
    mesh = meshed(ports, supply_v, polarity, wiring)
    if now.cut > 0.5:
        mesh = cut_out(mesh)
    seen = reduced(ports, mesh, chosen, other, now)
    current = now.current_a if mesh.closed else 0.0
    shown = potentials(ports, mesh, (current, seen.second.current_a), polarity, wiring)
    common_v = shown.common_v if ports.common.driven > 0.5 else 0.0
    first_v = shown.first_v if ports.first.driven > 0.5 else common_v + polarity * chosen.constant_v_s * now.speed_rad_s
    second_v = (
        shown.second_v if ports.second.driven > 0.5 else common_v + polarity * other.constant_v_s * now.speed_rad_s
    )
    slow_v, fast_v = (second_v, first_v) if is_fast else (first_v, second_v)
    return Connection(
        brush=seen.brush,
        source_v=seen.source_v if mesh.closed else 0.0,
        terminal_v=polarity * (first_v - common_v) if mesh.closed else 0.0,
        closed=1.0 if mesh.closed else 0.0,
        fast=1.0 if is_fast else 0.0,
        second=seen.second,
        terminal_53_v=slow_v,
        terminal_53b_v=fast_v,
        terminal_53e_v=park_potential(leads, wiring, shown.supply_v, slow_v),
        terminal_31_v=common_v,
        supply_v=shown.supply_v,
        supply_current_a=shown.supply_current_a,
    )


@compiled
def park_potential(leads: Leads, wiring: Wiring, supply_v: float, slow_v: float) -> float:
    """Return the potential of terminal 53e [V]: between where its wire begins and, where they are joined, 53."""
    from_wire = wired(leads.park.share, leads.park.driven, 0.0, 0.0, wiring.wire_53e)
    level, reached = (
        from_wire.share * (supply_v - wiring.ground_offset_v) + wiring.ground_offset_v,
        from_wire.driven > 0.5,
    )
    if leads.joined < 0.5 or wiring.wire_53.opened > 0.5:
        return level if reached else 0.0
    here, beyond = from_wire.resistance_ohm, wiring.wire_53.resistance_ohm
    if not reached or beyond == 0.0:
        return slow_v
    return (level * beyond + slow_v * here) / (beyond + here)
