"""The YAML reader: core schema of YAML 1.2, and the line of every key."""

import math
from pathlib import Path

import pytest

from hilplant.checked_yaml.problems import Problem
from hilplant.checked_yaml.yaml_reader import read_text


@pytest.mark.parametrize(
    ("written", "value"),
    [
        ("true", True),
        ("False", False),
        ("on", "on"),
        ("off", "off"),
        ("no", "no"),
        ("Yes", "Yes"),
        ("y", "y"),
        ("null", None),
        ("~", None),
        ("12", 12),
        ("-7", -7),
        ("010", 10),
        ("0x1F", 31),
        ("0o17", 15),
        ("1e-3", 0.001),
        ("1.5", 1.5),
        (".5", 0.5),
        ("-2.5E+3", -2500.0),
        ("-.inf", -math.inf),
        ("1:30", "1:30"),
        ("1_000", "1_000"),
        ("2026-01-01", "2026-01-01"),
        ("'12'", "12"),
        ('"true"', "true"),
        ("wet", "wet"),
    ],
)
def test_a_plain_scalar_follows_the_core_schema_of_yaml_1_2(written: str, value: object) -> None:
    read = read_text(f"key: {written}", "f").at(("key",))
    assert read == value
    assert type(read) is type(value)


def test_not_a_number_is_read_as_one() -> None:
    assert math.isnan(read_text("[.nan]", "f").data[0])


def test_every_key_and_item_knows_its_line() -> None:
    document = read_text("a: 1\nb:\n  on: [1,\n    2]\n  c: {d: x}\n", "f.yaml")
    assert document.data == {"a": 1, "b": {"on": [1, 2], "c": {"d": "x"}}}
    lines = {location: line for location, (_, line) in document.places.items()}
    assert lines[("a",)] == 1
    assert lines[("b",)] == 2
    assert lines[("b", "on", 0)] == 3
    assert lines[("b", "on", 1)] == 4
    assert lines[("b", "c", "d")] == 5


def test_what_is_missing_is_said_at_what_surrounds_it() -> None:
    document = read_text("a: 1\nb:\n  c: 2\n", "f.yaml")
    assert document.problem(("b", "d", "e"), "x") == Problem("f.yaml", 2, "x")


def test_a_key_that_comes_twice_is_a_problem_that_names_the_first() -> None:
    document = read_text("a: 1\nb: 2\na: 3\n", "f.yaml")
    assert [str(problem) for problem in document.problems] == ["f.yaml:3: key 'a' comes twice, first in line 1"]
    assert document.data == {"a": 1, "b": 2}


@pytest.mark.parametrize(
    ("text", "line"),
    [("a: 1\nb: [1, 2\nc: 3\n", 3), ("a: 1\n\tb: 2\n", 2), ("a: 'x\n", 2), ("a: 1\n--- \nb: 2\n", 2)],
)
def test_broken_syntax_is_one_problem_with_its_line(text: str, line: int) -> None:
    document = read_text(text, "f.yaml")
    assert [problem.line for problem in document.problems] == [line]
    assert document.data is None


@pytest.mark.parametrize(
    ("text", "line", "data"),
    [
        ("b: &b {c: 1}\nd: {<<: *b, e: 2}\n", 2, {"c": 1, "e": 2}),
        ("b: &b {c: 1}\nd:\n  c: 3\n  <<: *b\n", 4, {"c": 3}),
        ("b: [&b {c: 1}, &e {c: 2, f: 2}]\nd: {<<: [*b, *e]}\n", 2, {"c": 1, "f": 2}),
        ("d: {<<: 3, c: 1}\n", 1, {"c": 1}),
    ],
)
def test_a_merge_key_is_one_problem_that_says_what_to_write(text: str, line: int, data: dict[str, int]) -> None:
    document = read_text(text, "f.yaml")
    (problem,) = document.problems
    assert str(problem).startswith(f"f.yaml:{line}: merge keys (<<) are not supported; write the keys out here")
    assert document.data["d"] == data


def test_a_key_in_quotes_is_no_merge_key() -> None:
    document = read_text("d: {'<<': 3}\n", "f.yaml")
    assert (document.data, document.problems) == ({"d": {"<<": 3}}, [])


@pytest.mark.parametrize("text", ["a: !!python/object:os.system {}\n", "a: !mine 3\n", "? [a, b]\n: 3\n"])
def test_tags_and_composite_keys_are_refused(text: str) -> None:
    assert len(read_text(text, "f.yaml").problems) == 1


def test_an_alias_that_contains_itself_is_a_problem() -> None:
    assert len(read_text("a: &x [*x]\n", "f.yaml").problems) == 1


def test_an_empty_text_holds_nothing() -> None:
    document = read_text("# only a comment\n", str(Path("f.yaml")))
    assert document.data is None
    assert not document.problems
