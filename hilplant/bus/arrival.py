"""How long a frame has waited to be received, by the time of day that somebody stamped on it."""

import time

from hilplant.units import SECOND_NS

#: A frame that is said to have waited for longer has a stamp that is not of this clock.
_PLAUSIBLE_NS = 30 * 86_400 * SECOND_NS


def waited_ns(stamp_ns: int) -> int | None:
    """Return how long ago the stamp was made [ns]; None where it lies ahead, or counts from elsewhere than 1970."""
    waited: int = time.time_ns() - stamp_ns
    return waited if 0 <= waited < _PLAUSIBLE_NS else None
