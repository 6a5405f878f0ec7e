"""What a table that was printed with few digits can and cannot say."""

from collections.abc import Callable, Sequence
from decimal import Decimal
from itertools import product

Bounds = tuple[float, float]


def half_digit(printed: str) -> float:
    """Return half a unit of the last printed digit: what rounding may have taken away."""
    exponent = Decimal(printed).as_tuple().exponent
    return 0.5 * 10.0 ** int(exponent)


def rounds_to(value: float, printed: str) -> bool:
    """Say whether a number shows as `printed` when it is rounded to the same digits (a tie may go either way)."""
    return abs(value - float(printed)) <= half_digit(printed) * (1.0 + 1e-9)


def cut_to(value: float, printed: str) -> bool:
    """Say whether a positive number shows as `printed` when the digits behind the last one are left away."""
    cut = (Decimal(repr(value)) - Decimal(printed)) / Decimal(repr(2.0 * half_digit(printed)))
    return 0 <= cut < 1


def reachable(function: Callable[..., float], inputs: Sequence[str]) -> Bounds:
    """Return the lowest and highest value that inputs give which round to the printed ones.

    Taken over the corners: right where the function is monotonic in each input over these small ranges, as all here.
    """
    ranges = [(float(text) - half_digit(text), float(text) + half_digit(text)) for text in inputs]
    values = [function(*corner) for corner in product(*ranges)]
    return min(values), max(values)
