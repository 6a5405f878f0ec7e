"""The stand-in body ECU's mind: stalk, park switch, current and supply in; relays and fault out.

Pure: the state and the time are arguments, so that a second of wiping takes no time to try. What it does when is
the table in :mod:`hilplant.ecu.chart`.
"""

from typing import NamedTuple

from hilplant.ecu.automatic import RainStage, choose_stage, demanded
from hilplant.ecu.chart import EXITS, RESTING, SPEEDS, WIPING, Phase, Transition
from hilplant.ecu.conditions import View
from hilplant.ecu.sensing import Senses, sense
from hilplant.ecu.vocabulary import RELAYS_OFF, EcuInputs, Fault, RelayCommand, RelaySettings, Stalk

_RESTING, _WIPING = frozenset(RESTING), frozenset(WIPING)
_HELD_UP = frozenset((Phase.BLIND, Phase.BROWN_OUT))


class ControllerState(NamedTuple):
    """What the controller remembers; the defaults are its state at power-on.

    `since_s` is when the phase began, `turn_s` when the wiper last came to park or began to be driven. `driven_s` is
    how long it had been driven when silence or the supply held it up: that counts on when it is taken up again, or a
    blocked wiper behind a flickering message would be driven for ever. `fast` is the speed at which it drives.
    `tries` counts what went wrong since the last sound turn or rest in park. `leaving` says that it was started
    outside the park window, where it rests, and has not passed the window yet. `rain` is the stage of `automatic`.
    """

    phase: Phase = Phase.OFF
    since_s: float = 0.0
    turn_s: float = 0.0
    driven_s: float = 0.0
    fast: bool = False
    wipes_left: int = 1
    tries: int = 0
    fault: Fault = Fault.NONE
    latched_demand: bool = False
    leaving: bool = False
    senses: Senses = Senses()
    rain: RainStage = RainStage()


def advance(
    state: ControllerState, inputs: EcuInputs, now_s: float, settings: RelaySettings
) -> tuple[ControllerState, RelayCommand, Fault]:
    """Take one look at the inputs; return the relays to command and the fault to report.

    At most one transition of the chart is taken in each call. `now_s` must not run backwards.
    """
    state, _ = take(state, inputs, now_s, settings)
    driving = state.phase in _WIPING
    return state, RelayCommand(True, state.fast) if driving else RELAYS_OFF, state.fault


def take(
    state: ControllerState, inputs: EcuInputs, now_s: float, settings: RelaySettings
) -> tuple[ControllerState, Transition | None]:
    """Do what :func:`advance` does, and return the transition that was taken, None where the phase stays."""
    rain = choose_stage(state.rain, inputs.rain, now_s, settings)
    senses, leaving = sense(state.senses, inputs, now_s, settings), state.leaving
    if senses.arrived and leaving:
        senses, leaving = senses._replace(arrived=False), False
    turned_s = now_s - state.turn_s
    turn_s = now_s if senses.arrived else state.turn_s
    state = state._replace(rain=rain, senses=senses, leaving=leaving, turn_s=turn_s)
    view = _view(state, demanded(inputs.stalk, rain, inputs.rain), now_s, settings)
    row = next((row for row in EXITS[state.phase] if row.condition.holds(view)), None)
    if row is not None:
        state = _enter(state, row, view)
    elif senses.arrived:
        state = state._replace(wipes_left=state.wipes_left - 1)
    return _forgive(state, turned_s, now_s, settings), row


def _view(state: ControllerState, stalk: Stalk, now_s: float, settings: RelaySettings) -> View:
    return View(
        stalk,
        state.senses,
        settings,
        now_s,
        in_phase_s=now_s - state.since_s,
        turning_s=now_s - state.turn_s,
        wipes_left=state.wipes_left,
        tries=state.tries,
        latched_demand=state.latched_demand,
    )


def _enter(state: ControllerState, row: Transition, view: View) -> ControllerState:
    """Return the state at the beginning of a phase."""
    was_driving, now_s = state.phase in _WIPING, view.now_s
    speed = SPEEDS.get(row.target)
    if was_driving:
        state = state._replace(driven_s=view.turning_s if row.target in _HELD_UP else 0.0)
    state = state._replace(
        phase=row.target,
        since_s=now_s,
        turn_s=state.turn_s if was_driving else now_s - state.driven_s,
        fast=(was_driving and state.fast) if speed is None else speed,
        tries=state.tries + row.failed,
        fault=row.fault or state.fault,
        leaving=state.leaving if was_driving else view.settings.rests_open and view.senses.contact is False,
    )
    if row.target is Phase.WASH_WIPES:
        return state._replace(wipes_left=view.settings.wash_wipes)
    if row.target is Phase.SINGLE_WIPE:
        return state._replace(wipes_left=1)
    if row.target is Phase.LOCKOUT:
        return state._replace(latched_demand=view.stalk.demands)
    return state._replace(tries=0, driven_s=0.0) if Phase.LOCKOUT in row.sources else state


def _forgive(state: ControllerState, turned_s: float, now_s: float, settings: RelaySettings) -> ControllerState:
    """Forget what went wrong after a sound turn that goes on, or a rest in park."""
    senses = state.senses
    if state.phase in _WIPING:
        sound = senses.arrived and turned_s >= settings.settle_s
    else:
        parked_s = now_s if settings.rests_open else now_s - senses.closed_s
        sound = state.phase in _RESTING and min(parked_s, now_s - state.since_s) >= settings.settle_s
    return state._replace(tries=0, fault=Fault.NONE, driven_s=0.0) if sound else state
