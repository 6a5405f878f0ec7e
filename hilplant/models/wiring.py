"""What switches, relays and park contacts connect: digital, mechanical, depressed; 3.6 and 7.1.1 of Dooner (2016).

Each circuit is a function from the positions of its switches and contacts to the potentials that they put on the
motor's brushes, in the order in which the text follows the current. `docs/park.md` has the tables.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.park_switch import Contact
from hilplant.signals import Inputs

#: The circuits; `ParkSwitch.circuit` is the place of one in this list.
CIRCUITS = ("digital", "mechanical", "depressed")
DIGITAL, MECHANICAL, DEPRESSED = (float(index) for index in range(len(CIRCUITS)))

#: Positions of the mutually controlled switches 1, 2 and 3.
OFF, SLOW, FAST = 0.0, 1.0, 2.0
#: Where they are while their contacts touch neither end: `inputs` then has a number below 0, see `relays.py`.
MIDWAY = -1.0

#: Positions of the mutually controlled park contacts A and B of the depressed circuit: `State.park_phase`.
WIPING, TURNING_BACK, PARKED = 0.0, 1.0, 2.0


class Lead(NamedTuple):
    """Where a wire begins: at the supply (`share` 1) or at ground (0), or nowhere (`driven` 0)."""

    share: float
    driven: float


SUPPLY, GROUND, NOTHING = Lead(1.0, 1.0), Lead(0.0, 1.0), Lead(0.0, 0.0)


class Leads(NamedTuple):
    """What the switches put on slow brush, fast brush, common brush, and on the line from the park contact.

    `joined` is 1 where a switch connects that line with the slow brush.
    """

    slow: Lead
    fast: Lead
    common: Lead
    park: Lead
    joined: float


@compiled
def switch_position(inputs: Inputs) -> float:
    """Return the position of switches 1, 2 and 3: OFF whenever the ON/OFF relay is, else as FAST/SLOW says."""
    if inputs.relay_on < 0.0:
        return MIDWAY
    if inputs.relay_on <= 0.5:
        return OFF
    if inputs.relay_fast < 0.0:
        return MIDWAY
    return FAST if inputs.relay_fast > 0.5 else SLOW


@compiled
def digital(inputs: Inputs) -> Leads:
    """Connect as in section 7.1.1 (Figure 7-1): the park contact reports and carries no current.

    The ON/OFF relay gives battery or ground, the FAST/SLOW relay takes that to one brush and leaves the other open.
    So off is a short circuit through the armature, which brakes.
    """
    on_off = SUPPLY if inputs.relay_on > 0.5 else GROUND
    if inputs.relay_on < 0.0 or inputs.relay_fast < 0.0:
        return Leads(NOTHING, NOTHING, GROUND, NOTHING, 0.0)
    if inputs.relay_fast > 0.5:
        return Leads(NOTHING, on_off, GROUND, NOTHING, 0.0)
    return Leads(on_off, NOTHING, GROUND, NOTHING, 0.0)


@compiled
def mechanical(inputs: Inputs, contact: Contact) -> Leads:
    """Connect as in section 3.6.1 (Figure 3-15): switched off, the motor is fed through the park contact.

    While the contact bounces it touches neither battery nor ground.
    """
    position = switch_position(inputs)
    # the park contact: battery on the way, ground at park
    park = GROUND if contact.closed > 0.5 else SUPPLY
    if contact.shown != contact.closed:
        park = NOTHING
    # switch 1: battery to the slow or the fast brush, or to none
    slow = SUPPLY if position == SLOW else NOTHING
    fast = SUPPLY if position == FAST else NOTHING
    # switch 2: when off, the park contact to the slow brush
    if position == OFF:
        return Leads(park, fast, GROUND, park, 1.0)
    return Leads(slow, fast, GROUND, park, 0.0)


@compiled
def depressed(inputs: Inputs, contact: Contact, park_phase: float) -> Leads:
    """Connect as in section 3.6.2 (Figure 3-19): running, the common brush is fed; at park the current turns round.

    Contacts A and B move, and bounce, when the cam reaches park. The way of the slow brush to ground while the
    motor runs to park leads through switch 1, contact B and switch 2: were it not through B, battery would meet
    ground in the next position, in which B feeds the slow brush.
    """
    position = switch_position(inputs)
    # switch 2: ground to the slow or the fast brush, when off to contact B
    slow = GROUND if position == SLOW else NOTHING
    fast = GROUND if position == FAST else NOTHING
    off = GROUND if position == OFF else NOTHING
    # park contacts: A for the common brush, B for the slow one
    contact_a, contact_b = SUPPLY, off
    if park_phase == TURNING_BACK:
        contact_a, contact_b = GROUND, SUPPLY
    bouncing = contact.closed > 0.5 and contact.shown != contact.closed
    if park_phase == PARKED or (park_phase == TURNING_BACK and bouncing):
        contact_a, contact_b = NOTHING, NOTHING
    # switches 1 and 3: when off, contact B to the slow brush and contact A to the common one; else battery to it
    if position == OFF:
        return Leads(contact_b, fast, contact_a, contact_b, 1.0)
    return Leads(slow, fast, NOTHING if position == MIDWAY else SUPPLY, contact_b, 0.0)
