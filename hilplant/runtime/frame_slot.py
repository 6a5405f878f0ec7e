"""How one CAN frame lies in the ring."""

import struct
from typing import Any

import numpy as np

from hilplant.bus.frame import Frame

SENT, EXTENDED, FD, BITRATE_SWITCH, REMOTE, ERROR = (1 << bit for bit in range(6))

#: One frame in the ring; the flags are the constants above.
FRAME_DTYPE = np.dtype(
    [
        ("tick", "<i8"),
        ("time_ns", "<i8"),
        ("identifier", "<u4"),
        ("flags", "u1"),
        ("length", "u1"),
        ("spare", "<u2"),
        ("data", "u1", (64,)),
    ]
)
FRAME = struct.Struct("<qqIBBH64s")
FRAME_BYTES = FRAME.size


def frame_in(slot: tuple[Any, ...]) -> tuple[Frame, bool]:
    """Return the frame of an element of ``FRAME_DTYPE``, and whether the loop has sent it."""
    _, _, identifier, flags, length, _, data = slot
    told = (bool(flags & flag) for flag in (EXTENDED, FD, BITRATE_SWITCH, REMOTE, ERROR))
    return Frame(identifier, bytes(data[:length]), *told), bool(flags & SENT)
