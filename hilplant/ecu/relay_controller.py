"""A stand-in body ECU: decides from the stalk and the park switch what the two wiper relays do.

The states follow what the thesis tells of the classic control (7.1.1) and of its chart (8.4, Figures 8-7
and 8-8), with one pause, without the flick and without waiting for park between slow and fast. Time comes in
as an argument.
"""

import math
from enum import Enum
from typing import NamedTuple


class Stalk(Enum):
    """What the driver wants."""

    OFF = "off"
    SLOW = "slow"
    FAST = "fast"
    INTERMITTENT = "intermittent"


class Phase(Enum):
    """What the controller is doing."""

    OFF = "off"
    RUNNING = "running"  # drives until the stalk says otherwise
    WIPING = "wiping"  # drives slowly until the wiper comes to park
    PAUSING = "pausing"  # rests between two intermittent wipes
    BLIND = "blind"  # was driving when the park switch went silent
    FAULT = "fault"  # park did not come in time; latched until the stalk is moved


class Relays(NamedTuple):
    """The command to the plant: ON/OFF relay and FAST/SLOW relay."""

    on: bool
    fast: bool


class Settings(NamedTuple):
    """Times of the controller, all assumed: the thesis names none."""

    pause_s: float = 2.0
    park_timeout_s: float = 8.0
    debounce_s: float = 0.02


class State(NamedTuple):
    """What the controller remembers; the defaults are its state at power-on.

    `since_s` is when the phase began, or while driving when the latest turn began. `opened_s` is when the
    park contact opened (infinite while it is closed); `away` that it has been open for longer than a bounce.
    """

    phase: Phase = Phase.OFF
    since_s: float = 0.0
    opened_s: float = math.inf
    away: bool = False
    fault_stalk: Stalk = Stalk.OFF


RELAYS_OFF = Relays(False, False)
_DRIVING = (Phase.RUNNING, Phase.WIPING)


def advance(
    state: State, stalk: Stalk, park_contact: bool | None, now_s: float, settings: Settings
) -> tuple[State, Relays]:
    """Take one look at the stalk and the park contact (None while unknown); return the relays to command.

    The wiper has arrived at park only when the contact closes after it was open: a wiper that is still
    leaving the park window, or passing it when the stalk goes off, makes its turn to the end and stops where
    the window begins. So it never brakes at the window's far edge and coasts out of it.
    """
    if park_contact is None:
        blind = state._replace(phase=Phase.BLIND) if state.phase in _DRIVING else state
        return blind._replace(opened_s=math.inf, away=False), RELAYS_OFF
    state, arrived = _watch_contact(state, park_contact, now_s, settings)
    if state.phase in _DRIVING:
        state = _drive(state, stalk, arrived, now_s, settings)
    else:
        state = _rest(state, stalk, park_contact, now_s, settings)
    driving = state.phase in _DRIVING
    return state, Relays(driving, driving and stalk is Stalk.FAST)


def _watch_contact(state: State, contact: bool, now_s: float, settings: Settings) -> tuple[State, bool]:
    """Follow the contact through its bounces; say whether the wiper has just come to park."""
    if contact:
        return state._replace(opened_s=math.inf, away=False), state.away
    opened_s = min(state.opened_s, now_s)
    away = state.away or now_s - opened_s >= settings.debounce_s
    return state._replace(opened_s=opened_s, away=away), False


def _drive(state: State, stalk: Stalk, arrived: bool, now_s: float, settings: Settings) -> State:
    if arrived:
        state = state._replace(since_s=now_s)
    elif now_s - state.since_s > settings.park_timeout_s:
        return _enter(state, Phase.FAULT, now_s)._replace(fault_stalk=stalk)
    if stalk in (Stalk.SLOW, Stalk.FAST):
        return state._replace(phase=Phase.RUNNING)
    if arrived:
        return _enter(state, Phase.OFF if stalk is Stalk.OFF else Phase.PAUSING, now_s)
    return state._replace(phase=Phase.WIPING)


def _rest(state: State, stalk: Stalk, contact: bool, now_s: float, settings: Settings) -> State:
    """Decide whether a controller that does not drive goes on resting."""
    match state.phase:
        case Phase.FAULT if stalk is state.fault_stalk:
            return state
        case Phase.PAUSING if stalk is Stalk.INTERMITTENT and now_s - state.since_s < settings.pause_s:
            return state
        case Phase.BLIND if stalk is Stalk.OFF and not contact:
            return _enter(state, Phase.WIPING, now_s)
    return _start(state, stalk, now_s)


def _start(state: State, stalk: Stalk, now_s: float) -> State:
    if stalk is Stalk.OFF:
        return state if state.phase is Phase.OFF else _enter(state, Phase.OFF, now_s)
    return _enter(state, Phase.WIPING if stalk is Stalk.INTERMITTENT else Phase.RUNNING, now_s)


def _enter(state: State, phase: Phase, now_s: float) -> State:
    return state._replace(phase=phase, since_s=now_s)
