"""The drawing of a signal in a report: what is written beside marks can be read, however close they are."""

import re
from itertools import combinations

import numpy as np
import pytest

from hilplant.plots.signal_svg import SignalDrawing, signal_svg

LABEL = re.compile(r'<text x="([\d.]+)" y="([\d.]+)" text-anchor="(start|end)"[^>]*>(fault_\w+|switched off)<')
LETTER, LINE = 6.0, 11.0


@pytest.mark.parametrize("apart_s", [0.0, 0.01, 0.5, 3.0])
@pytest.mark.parametrize("first_s", [0.0, 4.0, 7.9])
def test_labels_of_marks_lie_apart_and_inside(first_s: float, apart_s: float) -> None:
    names = ("switched off", "fault_open_53", "fault_open_53_ends")
    marks = {name: min(first_s + index * apart_s, 8.0) for index, name in enumerate(names)}
    drawing = SignalDrawing("current_a", "A", 0.001, np.zeros(8000), (-1.0, 1.0), (0.0, 8.0), marks)
    found = LABEL.findall(signal_svg(drawing))
    assert sorted(name for *_, name in found) == sorted(names)
    boxes = []
    for x, y, anchor, name in found:
        begin = float(x) - (len(name) * LETTER if anchor == "end" else 0.0)
        boxes.append((begin, begin + len(name) * LETTER, float(y)))
    assert all(begin >= 0.0 and end <= 760.0 for begin, end, _ in boxes)
    for one, other in combinations(boxes, 2):
        assert one[1] <= other[0] or other[1] <= one[0] or abs(one[2] - other[2]) >= LINE
