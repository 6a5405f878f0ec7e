"""What the translation to C takes means the same there."""

import ctypes
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from hilplant.c_source.compiler import compile_library
from hilplant.c_source.plant_files import ROW, WRITABLE_ROW, translated
from hilplant.jit import compiled

LIMIT, WHOLE, BELOW = 2.5, 3, -1


class Pair(NamedTuple):
    """Two numbers."""

    first: float
    second: float


class Big(NamedTuple):
    """More numbers than go into a function by value."""

    pair: Pair
    other: Pair
    count: int
    row: Any


START = Pair(-1.5, 4.0)


@compiled
def remainders(x: float, y: float) -> tuple[float, float, float]:
    """Negative numbers, zero and what is not finite, as Python has them."""
    return x % y, (x % 2.0) * x, float(int(8.0 * y) % WHOLE) if -100.0 < y < 100.0 else 0.0


@compiled
def extremes(x: float, y: float) -> tuple[float, float, float]:
    """The first of two stays where neither is greater: a number before not-a-number, and 0.0 before -0.0."""
    return min(x, y), max(x, y), min(max(0.0, x), LIMIT)


@compiled
def powers(x: float, y: float) -> tuple[float, float, float]:
    """A power is a product, and binds before a minus."""
    return x**2, -(x**3), y**4 - x**1


@compiled
def terms(x: float, y: float) -> tuple[float, float, float]:
    """No sum and no quotient is put together in another way."""
    return x - (y - 1.0) - (x + y), x / (y / 3.0) * y, -(0.0 - x) * (1 - WHOLE / 2) + WHOLE * y


@compiled
def comparisons(x: float, y: float) -> tuple[float, float, float]:
    """Chains, membership, not; not-a-number is unequal to itself."""
    inside = 0.0 <= x < LIMIT and not y > 1.0
    among = x in (0.0, 1.0, y) or (x != x and y == y)  # noqa: PLR0124
    return 1.0 if inside else 0.0, 2.0 if among else -2.0, 3.0 if (x < y) != (y <= x) else 0.0


@compiled
def swapped(x: float, y: float) -> tuple[float, float, float]:
    """What is assigned side by side is read before any of it is written."""
    a, b = x, y
    a, b = b, a + b
    a, b, c = a + 1.0, a, b
    return a, b, c


@compiled
def loops(x: float, y: float) -> tuple[float, float, float]:
    """Counting up, down and in steps; a bound that the loop changes; break, continue; whole numbers become floats."""
    total, count, last = 0, 3, 0.0
    for k in range(count):
        count += k
        total += count
    for k in range(7, BELOW, -2):
        if k == 3:
            continue
        last = last * 2.0 + k
        if last > 40.0 + y:
            break
    while total > 0:
        total -= 4
    for _ in range(2):
        for _ in range(3):
            last += x
    return float(total), last, count / 2


@compiled
def choose(pair: Pair, x: float) -> Pair:
    """A record is given back early, or changed."""
    if x > 0.0:
        return Pair(second=x, first=pair.second)
    pair = Pair(x, 1.0)
    return pair


@compiled
def totals(big: Big, scale: int) -> tuple[Pair, float]:
    """A record within a record within a tuple."""
    inner = big.pair
    sums, share = 0.0, 0.0
    for k in range(big.row.shape[0] - 1):
        sums += big.row[k] * scale
    if sums > 1.0:
        share = big.other.second
    return (inner if share > 0.0 else Pair(sums, inner.first)), share * big.count


@compiled
def records(x: float, y: float) -> tuple[float, float, float]:
    """Records as arguments, results, constants and elements."""
    pair = choose(START, x)
    other = choose(pair, y) if x < y else START
    return pair.first + other.second, choose(pair, -1.0).second, other.first


@compiled
def functions(x: float, y: float) -> tuple[float, float, float]:
    """Floor and ceiling are whole numbers; a sign of zero is kept."""
    near = x if abs(x) < 1e6 else 7.25
    whole = math.floor(near / 3.0) + math.ceil(near) + int(near)
    waves = math.exp(-abs(near) / 1e5) * math.sin(near) + math.expm1(1e-3 * math.cos(near)) + math.sqrt(abs(y))
    return math.copysign(whole, y), waves, 1.0 if math.isfinite(y) else math.inf


@compiled
def arrays(row: Any, out: Any) -> None:
    """What is written to the caller's array, and the rest of a row."""
    big, count = Big(START, Pair(row[0], row[1]), 2, row[1:]), 3
    pair, share = totals(big, count)
    out[0], out[1] = pair.first, pair.second
    out[2] = share


NUMBERS = [0.0, -0.0, 1.0, -1.0, 2.5, -7.25, 3.7, 1e-310, 1e300, math.inf, -math.inf, math.nan]


def three(function: Callable[..., tuple[float, float, float]]) -> Callable[[Any, Any], None]:
    @compiled
    def entry(row: Any, out: Any) -> None:
        out[0], out[1], out[2] = function(row[0], row[1])

    return entry


@pytest.mark.parametrize(
    "function", [remainders, extremes, powers, terms, comparisons, swapped, loops, records, functions]
)
def test_a_construct_means_the_same_in_c(function: Callable[..., Any], tmp_path: Path) -> None:
    differing = [case for case in outcomes(three(function), tmp_path) if not same(*case[1:])]
    assert not differing, differing[0]


def test_arrays_are_read_cut_and_written_alike(tmp_path: Path) -> None:
    assert all(ours.tobytes() == theirs.tobytes() for _, ours, theirs in outcomes(arrays, tmp_path))


def same(ours: NDArray[np.float64], theirs: NDArray[np.float64]) -> bool:
    """Bit for bit; of two that are not-a-number the sign is that of either operand, which nobody defines."""
    return bool(((ours.view(np.int64) == theirs.view(np.int64)) | (np.isnan(ours) & np.isnan(theirs))).all())


def outcomes(entry: Callable[[Any, Any], None], folder: Path) -> list[tuple[Any, Any, Any]]:
    """Input, result of the compiled Python, and result in C, for all pairs of numbers."""
    text = translated({entry: (ROW, WRITABLE_ROW)})
    call = (
        f"void call(const double *row, double *out) {{ {entry.__name__}((Array_n){{row, {{3}}}}, "
        "(WritableArray_n){out, {3}}); }"
    )
    library = compile_library(f"{text}\n\n{call}\n", "", folder, "-Wall", "-Wextra", "-Werror")
    in_c = ctypes.CDLL(str(library)).call
    found = []
    for x in NUMBERS:
        for y in NUMBERS:
            row, ours, theirs = np.array([x, y, 1.0]), np.zeros(3), np.zeros(3)
            entry(row, ours)
            in_c(ctypes.c_void_p(row.ctypes.data), ctypes.c_void_p(theirs.ctypes.data))
            found.append((row, ours, theirs))
    return found
