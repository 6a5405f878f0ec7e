"""Says whether a plant server runs here, for a container's health check: ``python -m hilplant.runtime.health``."""

import contextlib
import sys
import time

from hilplant.runtime.ring import Ring
from hilplant.runtime.shared_memory import names

_WITHIN_S = 2.0
_LOOK_EVERY_S = 0.05


def moves(name: str, within_s: float = _WITHIN_S) -> bool:
    """Whether the loop that writes this ring does another tick in that time."""
    try:
        ring = Ring.attach(name)
    except (OSError, ValueError):  # it has just ended, or is another user's
        return False
    with contextlib.closing(ring):
        first = ring.rows_written
        end_s = time.monotonic() + within_s
        while time.monotonic() < end_s:
            if ring.rows_written != first:
                return True
            time.sleep(_LOOK_EVERY_S)
    return False


if __name__ == "__main__":
    sys.exit(0 if any(moves(name) for name in names()) else 1)
