"""The relays' contacts over time: they leave late, touch neither contact on their way, and bounce where they arrive.

A relay that is between its contacts, or lifted while it bounces, interrupts the current. Where the current is carried
over instead, by an arc or a diode, set the transfer and the bounce to nothing and the delay to their sum.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import Parameters, RelayState, RelayTiming, State
from hilplant.models.row import changed
from hilplant.signals import Inputs

#: Where a contact is that touches neither end; else 1 operated, 0 released.
BETWEEN = -1.0

#: `RelayTiming.stuck`.
STUCK_RELEASED, STUCK_OPERATED = 1.0, 2.0


class Contacts(NamedTuple):
    """Where the contacts of both relays are; the names are those of the commands that they take the place of."""

    relay_on: float
    relay_fast: float


class Moved(NamedTuple):
    """The inputs with the contacts in the place of the commands, and what the relays remember."""

    inputs: Inputs
    on: RelayState
    fast: RelayState


@compiled
def move_relays(inputs: Inputs, state: State, parameters: Parameters) -> Moved:
    """Return where the relays are in this tick."""
    if parameters.relays.altered < 0.5:
        on, fast = inputs.relay_on, inputs.relay_fast
        return Moved(inputs, RelayState(on, on, 0.0), RelayState(fast, fast, 0.0))
    at_on, on_state = follow(state.relay_on, inputs.relay_on, parameters.relays.on)
    at_fast, fast_state = follow(state.relay_fast, inputs.relay_fast, parameters.relays.fast)
    return Moved(changed(inputs, Contacts(at_on, at_fast)), on_state, fast_state)


@compiled
def follow(relay: RelayState, command: float, timing: RelayTiming) -> tuple[float, RelayState]:
    """Return where one contact is in this tick, and the relay a tick later.

    A command that changes its mind begins a new movement from the contact that was touched last.
    """
    if timing.stuck > 0.0:
        at = 0.0 if timing.stuck == STUCK_RELEASED else 1.0
        return at, RelayState(at, at, 0.0)
    made, left = relay.made, relay.left
    if command != relay.target:
        delay = timing.operate_ticks if command > 0.5 else timing.release_ticks
        left = delay + timing.transfer_ticks + timing.bounce_ticks
        if made == command:  # it had not left that contact yet
            left = 0.0
    if left <= 0.0:
        return command, RelayState(command, command, 0.0)
    if left > timing.transfer_ticks + timing.bounce_ticks:
        return made, RelayState(made, command, left - 1.0)
    if left > timing.bounce_ticks:
        return BETWEEN, RelayState(made, command, left - 1.0)
    lifted = (timing.bounce_ticks - left) % 2.0 >= 1.0
    return BETWEEN if lifted else command, RelayState(command, command, left - 1.0)
