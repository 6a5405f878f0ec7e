"""What the translation to C does not take is refused with file and line."""

import re
from typing import Any, NamedTuple

import pytest

from hilplant.c_source.plant_files import ROW, WRITABLE_ROW, translated
from hilplant.c_source.subset import NotInSubset
from hilplant.jit import compiled


class Pair(NamedTuple):
    """Two numbers."""

    first: float
    second: float


START = Pair(-1.5, 4.0)


@compiled
def with_a_list(row: Any, out: Any) -> None:
    out[0] = sum([row[0], row[1]])


@compiled
def with_a_text(row: Any, out: Any) -> None:
    out[0] = 1.0 if str(row[0]) else 0.0


@compiled
def with_truth_of_a_number(row: Any, out: Any) -> None:
    out[0] = 1.0 if row[0] else 0.0


@compiled
def with_a_negative_index(row: Any, out: Any) -> None:
    out[0] = row[-1]


@compiled
def with_an_open_power(row: Any, out: Any) -> None:
    out[0] = row[0] ** row[1]


@compiled
def with_a_loop_over_an_array(row: Any, out: Any) -> None:
    for number in row:
        out[0] = number


@compiled
def with_a_counter_that_outlives_its_loop(row: Any, out: Any) -> None:
    for k in range(3):
        out[0] = row[k]
    out[1] = k


@compiled
def with_a_row_that_is_only_read(row: Any, out: Any) -> None:
    row[0] = out[0]


@compiled
def with_two_types(row: Any, out: Any) -> None:
    value = START if row[0] > 0.0 else row[1]
    out[0] = value


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (with_a_list, "sum"),
        (with_a_text, "str"),
        (with_truth_of_a_number, "row[0]"),
        (with_a_negative_index, "not negative"),
        (with_an_open_power, "exponent"),
        (with_a_loop_over_an_array, "range"),
        (with_a_counter_that_outlives_its_loop, "outside its loop"),
        (with_a_row_that_is_only_read, "written"),
        (with_two_types, "Pair or double"),
    ],
)
def test_what_is_not_translated_is_named_with_file_and_line(function: Any, said: str) -> None:
    first = function.py_func.__code__.co_firstlineno
    with pytest.raises(NotInSubset, match=re.escape(said)) as raised:
        translated({function: (ROW, WRITABLE_ROW)})
    name, line = str(raised.value).split(":")[:2]
    assert name == "test_c_source_refusals.py"
    assert first < int(line) < first + 5
    assert function.__name__ in str(raised.value)
    assert "\n" not in str(raised.value)
