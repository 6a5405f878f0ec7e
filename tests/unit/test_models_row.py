"""What compiled code does with a record is what Python does with it, for each record that the step takes or gives."""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from hilplant.declaration import declared
from hilplant.jit import compiled
from hilplant.models.records import Blade, Brush, Friction, MotorMemory, State
from hilplant.models.row import all_finite, changed, guarded, summed, unpack, write
from hilplant.signals import Inputs, Outputs


def all_of(record: Any) -> Callable[[Any, Any, Any], bool]:
    """Return a function that fills two rows: with a row unpacked and written, and with what the guard makes of it."""

    def check(row: Any, kept: Any, safe: Any) -> bool:
        named = unpack(record, row)
        write(named, kept)
        write(guarded(named), safe)
        return all_finite(named)

    return check


class Other(NamedTuple):
    mode: float
    brush: float


@compiled
def changed_in_compiled_code(row: Any, kept: Any) -> None:
    write(changed(unpack(MotorMemory, row), Other(7.0, 8.0)), kept)


@pytest.mark.parametrize("record", [Inputs, Outputs, State])
def test_compiled_code_and_python_agree_on_every_element(record: type[Any]) -> None:
    signals, in_python = declared(record), all_of(record)
    in_compiled_code = compiled(in_python)
    for index in range(len(signals)):
        for wrong in (1.5, math.nan, -math.inf):
            row = np.arange(1.0, len(signals) + 1.0)
            row[index] = wrong
            kept, safe = np.empty((2, 2, len(row)))
            answers = in_compiled_code(row, kept[0], safe[0]), in_python(row, kept[1], safe[1])
            assert answers[0] == answers[1] == (math.isfinite(wrong) or not signals[index].watched)
            assert kept[0].tobytes() == kept[1].tobytes() == row.tobytes()
            assert safe[0].tobytes() == safe[1].tobytes() and np.isfinite(safe).all()
            fixed = [row[k] if signal.guarded is None else signal.guarded for k, signal in enumerate(signals)]
            assert safe[0].tolist() == [value if math.isfinite(value) else 0.0 for value in fixed]


def test_a_change_is_by_name_and_leaves_the_rest() -> None:
    row, kept = np.arange(6.0), np.empty(6)
    changed_in_compiled_code(row, kept)
    assert kept.tolist() == [0.0, 1.0, 2.0, 3.0, 8.0, 7.0]
    assert changed(unpack(MotorMemory, row), Other(7.0, 8.0)) == unpack(MotorMemory, kept)


@pytest.mark.parametrize("record", [Brush, Friction, Blade])
def test_the_sum_is_the_same_compiled_and_tells_each_element_that_changes(record: type[Any]) -> None:
    in_python = summed.py_func if hasattr(summed, "py_func") else summed
    in_compiled_code = compiled(lambda row: summed(unpack(record, row)))
    row = np.arange(1.0, len(declared(record)) + 1.0)
    whole = in_python(unpack(record, row))
    assert in_compiled_code(row) == whole
    for index in range(len(row)):
        other = row.copy()
        other[index] += 1e-6
        assert in_python(unpack(record, other)) == in_compiled_code(other) != whole
