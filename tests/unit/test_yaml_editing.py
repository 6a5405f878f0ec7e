"""Values changed in YAML text: the data change as asked, and nothing else does, comments least of all."""

import copy
import random
import re
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from hilplant.checked_yaml.editing import EditError, flow, with_value, without
from hilplant.checked_yaml.yaml_reader import read_text
from hilplant.resources import shipped

FILES = sorted(
    path for folder in ("benches", "motors", "linkages", "screens") for path in shipped("config", folder).glob("*.yaml")
)

TEXT = """# head
a: 1 # one
b:
  # inner
  c: 2 # two

f: {x: 1, y: [1, 2]} # flow
l: [1, 2] # list
e:
s: >-
  folded
  words

# before
z: last # end"""

VALUES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(10**9), 10**9)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(max_size=12),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.text("abc_", min_size=1, max_size=4), inner, max_size=3)
    ),
    max_leaves=6,
)


def data_of(text: str) -> Any:
    document = read_text(text, "t")
    assert not document.problems, document.problems
    return document.data


def comments(text: str) -> list[str]:
    return [token for line in text.splitlines() for token in re.findall(r"(?:^|\s)(#.*)$", line)]


def leaves(data: Any, place: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    pairs = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    found = [leaf for key, inner in pairs for leaf in leaves(inner, (*place, key))]
    return found or [place]


def put(data: Any, place: tuple[Any, ...], value: Any) -> Any:
    changed = copy.deepcopy(data)
    inner = changed
    for step in place[:-1]:
        inner = inner[step]
    inner[place[-1]] = value
    return changed


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_any_number_of_any_shipped_file_changes_alone(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    data, draw = data_of(text), random.Random(path.name)
    for place in draw.sample(leaves(data), min(4, len(leaves(data)))):
        value = draw.choice([1.25e-7, -3, "other words", True])
        changed = with_value(text, place, value)
        assert data_of(changed) == put(data, place, value)
        assert comments(changed) == comments(text)


@pytest.mark.parametrize("path", FILES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_ten_edits_after_one_another_keep_every_comment_and_the_order(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    data, draw = data_of(text), random.Random(path.name)
    changed = text
    for number in range(10):
        place = draw.choice([leaf for leaf in leaves(data) if leaf[0] != "extends"])
        changed, data = with_value(changed, place, number + 0.5), put(data, place, number + 0.5)
    assert data_of(changed) == data
    assert comments(changed) == comments(text)
    assert len(changed.splitlines()) <= len(text.splitlines())


@settings(max_examples=60, deadline=None)
@given(VALUES)
def test_a_value_on_one_line_is_read_as_itself(value: Any) -> None:
    assert data_of(f"key: {flow(value)}\n") == {"key": value}
    assert "\n" not in flow(value)


@settings(max_examples=60, deadline=None)
@given(
    VALUES,
    st.sampled_from(
        [
            ("a",),
            ("new",),
            ("b", "c"),
            ("b", "new"),
            ("b", "new", "deep"),
            ("f", "x"),
            ("f", "new"),
            ("l", 1),
            ("e",),
            ("s",),
            ("x", "y", "z"),
        ]
    ),
)
def test_any_value_anywhere(value: Any, place: tuple[Any, ...]) -> None:
    text = TEXT
    changed = with_value(text, place, value)
    if place == ("b", "new", "deep"):
        expected = {**data_of(text), "b": {"c": 2, "new": {"deep": value}}}
    elif place == ("x", "y", "z"):
        expected = {**data_of(text), "x": {"y": {"z": value}}}
    else:
        expected = put(data_of(text), place, value)
    assert data_of(changed) == expected
    assert comments(changed) == comments(text)


@pytest.mark.parametrize(("text", "place", "expected"), [
    ("a: 1 # gone\nb: 2 # stays\n", ("a",), "b: 2 # stays\n"),
    ("a: {x: 1, y: 2}\n", ("a", "x"), "a: {y: 2}\n"),
    ("a: {x: 1, y: 2}\n", ("a", "y"), "a: {x: 1}\n"),
    ("a: {x: 1}\n", ("a", "x"), "a: {}\n"),
    ("a:\n  x: 1\n  y: # head\n    z: 1\n# tail\n", ("a", "y"), "a:\n  x: 1\n# tail\n"),
])  # fmt: skip
def test_a_key_is_taken_out_with_its_line(text: str, place: tuple[str, ...], expected: str) -> None:
    assert without(text, place) == expected


def test_an_empty_text_takes_its_first_key() -> None:
    assert with_value("", ("plant", "motor"), "motor.yaml") == "plant:\n  motor: motor.yaml\n"
    assert with_value("# only words\n", ("a",), 1) == "# only words\na: 1\n"


@pytest.mark.parametrize(("text", "place"), [
    ("a: &x {b: 1}\nc: *x\n", ("a", "b")),  # would change c too
    ("a: &x 1\nc: *x\n", ("c",)),
    ("a: [1, 2]\n", ("a", "b")),
    ("a: 1\n", ("a", "b")),
    ("a: [\n", ("a",)),
    ("a: 1\na: 2\n", ("a",)),
])  # fmt: skip
def test_what_cannot_be_changed_alone_is_refused(text: str, place: tuple[str, ...]) -> None:
    with pytest.raises(EditError):
        with_value(text, place, 3)


def test_other_readers_see_the_same_numbers() -> None:
    text = with_value("a: 1\n", ("a",), 1.2e-05)
    assert float(yaml.safe_load(text)["a"]) == 1.2e-05
