"""Smooth float64 columns as small whole numbers, bit for bit: fourth differences of their bits.

What a wiper does at 1 kHz is smooth, so that the next number follows nearly from the four before it; the rest is a
small whole number, which compresses to half of what the number itself does. Nothing is rounded: any 64 bits come back,
NaN too.
"""

import numpy as np

from hilplant.arrays import Floats, Whole

ORDER = 4


def encode(values: Floats) -> Whole:
    """Return the differences along the first axis, as whole numbers from 0 on where they are small: 0, -1, 1, -2 ..."""
    differences = np.ascontiguousarray(values).view(np.int64).copy()
    for _ in range(ORDER):
        differences[1:] -= differences[:-1].copy()
    zigzag: Whole = (differences << 1) ^ (differences >> 63)
    return zigzag


def decode(stored: Whole) -> Floats:
    """Return the numbers that :func:`encode` was given."""
    bits = ((stored >> 1) & np.int64(2**63 - 1)) ^ -(stored & 1)
    for _ in range(ORDER):
        bits = np.cumsum(bits, axis=0, dtype=np.int64)
    values: Floats = bits.view(np.float64)
    return values
