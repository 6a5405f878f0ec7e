"""What the driver does in the demonstration."""

from typing import NamedTuple

from hilplant.ecu.relay_controller import Stalk
from hilplant.ecu.stalk import Turn
from hilplant.failure import Failure

USUAL_S = 20.0
SHORTEST_S = 8.0

#: A slow wipe takes about 1.5 s, so a stalk moved to off this long before the end still sees the wiper park.
_PARKING_S = 2.5


class Sequence(NamedTuple):
    """A demonstration: its length, the stalk over time, and the ECU's pause between intermittent wipes."""

    seconds: float
    turns: tuple[Turn, ...]
    pause_s: float


def sequence(seconds: float | None) -> Sequence:
    """Return off, slow, fast, intermittent and off again, spread over `seconds`.

    Raises
    ------
    Failure
        When the time is too short to show them all.
    """
    length_s = USUAL_S if seconds is None else seconds
    if not SHORTEST_S <= length_s <= 86400.0:
        raise Failure(f"demo: --seconds must be from {SHORTEST_S:g} to 86400, not {length_s:g}")
    active_s = length_s - _PARKING_S
    turns = (
        Turn(0.0, Stalk.OFF),
        Turn(0.06 * active_s, Stalk.SLOW),
        Turn(0.36 * active_s, Stalk.FAST),
        Turn(0.56 * active_s, Stalk.INTERMITTENT),
        Turn(active_s, Stalk.OFF),
    )
    return Sequence(length_s, turns, pause_s=min(2.0, 0.08 * active_s))
