"""The controller's chart as a table: what runs is this table, and what is drawn is this table.

Off, flick, intermittent with its six pauses, slow, fast and the waits are those of Figures 8-7 and 8-8 of Dooner
(2016) as section 8.4 tells them; wash-wipe and everything that happens when something is wrong are added.
"""

from enum import Enum
from typing import NamedTuple

from hilplant.ecu import conditions as when
from hilplant.ecu.conditions import Condition, interval, master, pause_over
from hilplant.ecu.vocabulary import INTERVALS, Fault, Master


class Phase(Enum):
    """What the controller is doing."""

    OFF = "off"
    FLICK = "flick"  # one fast wipe
    SINGLE_WIPE = "single_wipe"  # one slow wipe of the intermittent stage
    PAUSE_1 = "pause_1"
    PAUSE_2 = "pause_2"
    PAUSE_3 = "pause_3"
    PAUSE_4 = "pause_4"
    PAUSE_5 = "pause_5"
    PAUSE_6 = "pause_6"
    SLOW = "slow"
    FAST = "fast"
    WAIT = "wait"  # goes on as before until park, then off
    INT_WAIT = "int_wait"  # goes on as before until park, then intermittent
    SLOW_WAIT = "slow_wait"
    FAST_WAIT = "fast_wait"
    WASHING = "washing"  # wipes slowly while the wash button is pressed
    WASH_WIPES = "wash_wipes"  # the wipes after it was released
    BLIND = "blind"  # the park switch is silent
    BROWN_OUT = "brown_out"  # the supply is too low
    RETRY = "retry"  # rests after a fault, then tries again
    LOCKOUT = "lockout"  # tried in vain too often; the driver must ask anew


PAUSES = tuple(Phase(f"pause_{number}") for number in INTERVALS)
WAITS = (Phase.WAIT, Phase.INT_WAIT, Phase.SLOW_WAIT, Phase.FAST_WAIT)
WIPING = (Phase.FLICK, Phase.SINGLE_WIPE, Phase.SLOW, Phase.FAST, *WAITS, Phase.WASHING, Phase.WASH_WIPES)
RESTING = (Phase.OFF, *PAUSES)

#: Speed of the phases that drive: true is fast, None goes on with the speed of the phase before (slow after a rest).
SPEEDS: dict[Phase, bool | None] = {
    phase: None if phase in WAITS else phase in (Phase.FLICK, Phase.FAST) for phase in WIPING
}

#: What the wait for each position of the stalk is, and where it leads.
WAIT_FOR = {
    Master.OFF: (Phase.WAIT, Phase.OFF),
    Master.INTERMITTENT: (Phase.INT_WAIT, Phase.SINGLE_WIPE),
    Master.SLOW: (Phase.SLOW_WAIT, Phase.SLOW),
    Master.FAST: (Phase.FAST_WAIT, Phase.FAST),
}


class Transition(NamedTuple):
    """A row of the table: from any of `sources`, when the condition holds, to the target.

    `fault` is reported from then on; None leaves what is reported. `failed` counts as a try that went wrong.
    """

    sources: tuple[Phase, ...]
    condition: Condition
    target: Phase
    fault: Fault | None = None
    failed: bool = False


def _troubles() -> list[Transition]:
    """Return what ends driving, or keeps it from beginning, before anything that the driver wants."""
    failures = (
        (when.STALLED, Fault.STALL),
        (when.BOUNCES, Fault.PARK_BOUNCES),
        (when.NEVER_OPENS, Fault.PARK_NEVER_OPENS),
        (when.NEVER_CLOSES, Fault.PARK_NEVER_CLOSES),
    )
    return [
        Transition(WIPING, when.SUPPLY_LOW, Phase.BROWN_OUT, Fault.BROWN_OUT),
        Transition(WIPING, when.UNKNOWN, Phase.BLIND, Fault.PARK_UNKNOWN),
        *(Transition(WIPING, condition, Phase.RETRY, fault, failed=True) for condition, fault in failures),
        Transition(RESTING, when.WANTED_OR_AWAY, Phase.BROWN_OUT, Fault.BROWN_OUT),
        Transition(RESTING, when.UNKNOWN & when.WANTED_OR_RESTED, Phase.BLIND, Fault.PARK_UNKNOWN),
        Transition(RESTING, when.AWAY & when.TRIED_OUT, Phase.LOCKOUT, Fault.OFF_PARK),
        Transition(RESTING, when.AWAY, Phase.WAIT, Fault.OFF_PARK, failed=True),
    ]


def _recoveries() -> list[Transition]:
    """Return how the wiper is taken up again after trouble: parked where it stands on the screen."""
    return [
        Transition((Phase.BLIND,), when.SUPPLY_LOW, Phase.BROWN_OUT, Fault.BROWN_OUT),
        Transition((Phase.BLIND,), when.CLOSED, Phase.OFF),
        Transition((Phase.BLIND,), when.OPEN, Phase.WAIT),
        Transition((Phase.RETRY,), when.TRIED_OUT, Phase.LOCKOUT),
        *(
            Transition(sources, ready & contact, target, fault)
            for sources, ready in (((Phase.BROWN_OUT,), when.SUPPLY_BACK), ((Phase.RETRY,), when.RETRY_DUE))
            for contact, target, fault in (
                (when.UNKNOWN, Phase.BLIND, Fault.PARK_UNKNOWN),
                (when.CLOSED, Phase.OFF, None),
                (when.OPEN, Phase.WAIT, None),
            )
        ),
        Transition((Phase.LOCKOUT,), when.DRIVER_RESETS, Phase.OFF),
    ]


def _from_off() -> list[Transition]:
    return [
        Transition((Phase.OFF,), when.FLICK, Phase.FLICK),
        Transition((Phase.OFF,), when.WASH, Phase.WASHING),
        *(
            Transition((Phase.OFF,), master(position), target)
            for position, (_, target) in WAIT_FOR.items()
            if position is not Master.OFF
        ),
        Transition((Phase.FLICK,), when.PARK & when.NO_FLICK, Phase.OFF),
    ]


def _arrivals() -> list[Transition]:
    """Return what happens at park."""
    wiped = (Phase.SINGLE_WIPE, Phase.WASH_WIPES)
    done = when.PARK & when.LAST_WIPE
    return [
        *(Transition((wait,), when.PARK, target) for wait, target in WAIT_FOR.values()),
        Transition((Phase.WASH_WIPES,), done & master(Master.OFF), Phase.OFF),
        *(Transition(wiped, done & interval(number), pause) for number, pause in zip(INTERVALS, PAUSES, strict=True)),
    ]


def _stalk_moves() -> list[Transition]:
    """Return what the driver's hand does to a wiper that moves, or pauses."""
    own = {
        Phase.SLOW: Master.SLOW,
        Phase.FAST: Master.FAST,
        Phase.SINGLE_WIPE: Master.INTERMITTENT,
        **{wait: position for position, (wait, _) in WAIT_FOR.items()},
    }
    moves = [Transition((Phase.SINGLE_WIPE, *PAUSES), when.WASH, Phase.WASHING)]
    for position, (wait, target) in WAIT_FOR.items():
        sources = tuple(phase for phase, at in own.items() if at is not position)
        moves.append(Transition(sources, master(position), wait))
        if position is not Master.INTERMITTENT:
            moves.append(Transition(PAUSES, master(position), target))
        if position in (Master.SLOW, Master.FAST):
            moves.append(Transition((Phase.WASHING, Phase.WASH_WIPES), master(position), wait))
    moves.append(Transition((Phase.WASHING,), when.NO_WASH, Phase.WASH_WIPES))
    moves.append(Transition((Phase.WASH_WIPES,), when.WASH, Phase.WASHING))
    pauses = zip(INTERVALS, PAUSES, strict=True)
    return moves + [Transition((pause,), pause_over(number), Phase.SINGLE_WIPE) for number, pause in pauses]


#: All transitions; where several hold, the first is taken.
CHART: tuple[Transition, ...] = (*_troubles(), *_recoveries(), *_from_off(), *_arrivals(), *_stalk_moves())

#: The same by source, in the same order.
EXITS: dict[Phase, tuple[Transition, ...]] = {
    phase: tuple(row for row in CHART if phase in row.sources) for phase in Phase
}
