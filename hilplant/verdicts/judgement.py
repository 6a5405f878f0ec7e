"""What came of an expectation: the verdict, how far from the limit, and where it was decided."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

#: pass; fail; blocked: what it waits for did not come, so nothing was judged; inconclusive: time or data were lost, or
#: the run ended, before it was decided.
Ruling = Literal["pass", "fail", "blocked", "inconclusive"]


class Piece(NamedTuple):
    """One stretch of a window, judged.

    `holds` is None where the stretch was too short to tell, because the window closed (`cut` false) or the run ended
    (`cut` true). `tick` is where it was decided, the violating tick if it does not hold.
    """

    holds: bool | None
    margin: float
    tick: int
    cut: bool = False


@dataclass(frozen=True, slots=True)
class Judgement:
    """The verdict on an expectation.

    `robustness` is the smallest distance from the limit, in the signal's unit, negative beyond it; nan when nothing
    was judged. `tick` is the first violating tick, else the one at which the last stretch was decided; None where
    none was. `values` are the signals at the ticks around it.
    """

    ruling: Ruling
    robustness: float = math.nan
    tick: int | None = None
    reason: str = ""
    values: dict[str, tuple[float, ...]] = field(default_factory=dict, compare=False)


#: Reasons, by which both evaluators say the same.
NO_WINDOW = "what it waits for did not come"
TOO_SHORT = "the window closed before it could be decided"
RUN_ENDED = "the run ended before it could be decided"
LOST = "ticks or frames were lost before it was decided"


def combine(pieces: Sequence[Piece], lost: Sequence[bool]) -> Judgement:
    """Return the verdict on all stretches; `lost` says for each whether something was lost before it was decided."""
    if not pieces:
        return Judgement("blocked", reason=NO_WINDOW)
    judged = [piece for piece in pieces if piece.holds is not None]
    robustness = min((piece.margin for piece in judged), default=math.nan)
    for piece, gap in zip(pieces, lost, strict=True):
        if piece.holds is False and not gap:
            return Judgement("fail", robustness, piece.tick)
    for piece, gap in zip(pieces, lost, strict=True):
        if gap:
            return Judgement("inconclusive", robustness, piece.tick, LOST)
    for piece in pieces:
        if piece.holds is None and piece.cut:
            return Judgement("inconclusive", robustness, piece.tick, RUN_ENDED)
    if not judged:
        return Judgement("blocked", reason=TOO_SHORT)
    return Judgement("pass", robustness, judged[-1].tick)


def unless_hidden(judgement: Judgement, lost: bool) -> Judgement:
    """Return the verdict where ticks of the window that were `lost` may have hidden what it looks for."""
    if lost and judgement.ruling in ("pass", "blocked"):
        return Judgement("inconclusive", judgement.robustness, judgement.tick, LOST)
    return judgement
