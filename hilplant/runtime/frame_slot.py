"""How one CAN frame lies in the ring."""

import struct

import numpy as np

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
