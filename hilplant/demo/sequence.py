"""What the driver does in the demonstration."""

from typing import NamedTuple

from hilplant.ecu.stalk import StalkTurn, move_named
from hilplant.failure import Failure

USUAL_S = 20.0
#: In less than `WHOLE_S` not every mode can be shown; such a demonstration is the beginning of one of that length.
SHORTEST_S, WHOLE_S = 1.0, 8.0

#: On a wet screen a slow wipe takes 1.6 s and a fast one 1.3 s: the last wipe has parked before the flick, and the
#: flick before the end.
_FLICK_S, _PARKING_S = 2.0, 1.8


class DemoSequence(NamedTuple):
    """A demonstration: its length, the stalk over time, and the ECU's pause between intermittent wipes."""

    seconds: float | None
    turns: tuple[StalkTurn, ...]
    pause_s: float


def sequence(seconds: float | None) -> DemoSequence:
    """Return off, slow, fast, intermittent, off and a flick, spread over `seconds`.

    Raises
    ------
    Failure
        When the time is too short to show anything.
    """
    asked_s = USUAL_S if seconds is None else seconds
    if not SHORTEST_S <= asked_s <= 86400.0:
        raise Failure(f"demo: --seconds must be from {SHORTEST_S:g} to 86400, not {asked_s:g}")
    length_s = max(WHOLE_S, asked_s)
    active_s = length_s - _FLICK_S - _PARKING_S
    turns = (
        _turn(0.0, "off"),
        _turn(0.07 * active_s, "slow"),
        _turn(0.36 * active_s, "fast"),
        _turn(0.58 * active_s, "intermittent"),
        _turn(active_s, "off"),
        _turn(length_s - _FLICK_S, "flick"),
    )
    return DemoSequence(asked_s, turns, pause_s=min(2.0, 0.08 * active_s))


def by_hand(seconds: float | None) -> DemoSequence:
    """Return a demonstration that is driven by hand, without end unless `seconds` are given."""
    return DemoSequence(seconds, (), pause_s=2.0)


def _turn(time_s: float, word: str) -> StalkTurn:
    move = move_named(word)
    assert move is not None
    return StalkTurn(time_s, move)
