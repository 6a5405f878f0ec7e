"""Lines in a terminal: a canvas of Braille characters, two dots wide and four high each."""

import math
from itertools import pairwise

_FIRST_BRAILLE = 0x2800
#: Bit of each dot within its character, by column and row from the top left.
_BITS = ((0x01, 0x02, 0x04, 0x40), (0x08, 0x10, 0x20, 0x80))

Point = tuple[float, float]


class Canvas:
    """Dots in a rectangle of the plane, X to the right and Y upwards, shown as characters."""

    def __init__(self, columns: int, rows: int, lower_left: Point, dots_per_unit: float) -> None:
        """Make an empty canvas of `columns` by `rows` characters."""
        self._cells = [[0] * columns for _ in range(rows)]
        self._lower_left = lower_left
        self._dots_per_unit = dots_per_unit

    def dot(self, point: Point) -> None:
        """Set the dot nearest to a point; points outside are left out."""
        across = round((point[0] - self._lower_left[0]) * self._dots_per_unit)
        up = round((point[1] - self._lower_left[1]) * self._dots_per_unit)
        down = 4 * len(self._cells) - 1 - up
        if 0 <= across < 2 * len(self._cells[0]) and 0 <= down < 4 * len(self._cells):
            self._cells[down // 4][across // 2] |= _BITS[across % 2][down % 4]

    def line(self, start: Point, end: Point) -> None:
        """Draw a straight line."""
        across, up = end[0] - start[0], end[1] - start[1]
        points = 1 + math.ceil(2.0 * max(abs(across), abs(up)) * self._dots_per_unit)
        for index in range(points + 1):
            share = index / points
            self.dot((start[0] + share * across, start[1] + share * up))

    def path(self, points: list[Point]) -> None:
        """Draw straight lines from point to point."""
        for start, end in pairwise(points):
            self.line(start, end)

    def __str__(self) -> str:
        """Return the rows of characters, from the top."""
        return "\n".join("".join(chr(_FIRST_BRAILLE + cell) for cell in row) for row in self._cells)
