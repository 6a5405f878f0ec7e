"""Stalk sequences: what can be written, what is refused and how, and what a terminal may type."""

import os

import pytest

from hilplant.ecu.relay_controller import Stalk
from hilplant.ecu.stalk import StalkError, Turn, TypedStalk, parse_stalk, stalk_at


def test_a_sequence_is_read_in_order_with_names_or_their_beginnings():
    turns = parse_stalk("0:off, 1.5:slow,6:F,11:intermittent")
    assert turns == (
        Turn(0.0, Stalk.OFF),
        Turn(1.5, Stalk.SLOW),
        Turn(6.0, Stalk.FAST),
        Turn(11.0, Stalk.INTERMITTENT),
    )


def test_a_position_holds_until_the_next_and_is_off_before_the_first():
    turns = parse_stalk("1:slow,6:fast")
    positions = [stalk_at(turns, elapsed_s) for elapsed_s in (0.0, 0.999, 1.0, 5.9, 6.0, 1e9)]
    assert positions == [Stalk.OFF, Stalk.OFF, Stalk.SLOW, Stalk.SLOW, Stalk.FAST, Stalk.FAST]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "entry 1 ''"),
        ("slow", "write SECONDS:POSITION"),
        ("x:slow", "write SECONDS:POSITION"),
        ("-1:slow", "write SECONDS:POSITION"),
        ("inf:slow", "write SECONDS:POSITION"),
        ("nan:slow", "write SECONDS:POSITION"),
        ("0:slow,", "entry 2 ''"),
        ("0:slow,1:quick", "entry 2 '1:quick': position must be one of off, slow, fast, intermittent"),
        ("0:", "position must be one of"),
        ("0:slow:fast", "position must be one of"),
        ("2:slow,2:fast", "entry 2 '2:fast': time must be later than 2 s"),
    ],
)
def test_bad_text_is_refused_in_one_line_that_names_the_entry(text, said):
    with pytest.raises(StalkError) as caught:
        parse_stalk(text)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


def test_typed_lines_move_the_stalk_and_nonsense_is_answered_without_moving_it():
    reader, writer = os.pipe()
    answers: list[str] = []
    stalk = TypedStalk(reader, answers.append)
    assert stalk(0.0) is Stalk.OFF
    os.write(writer, b"s\n")
    assert stalk(1.0) is Stalk.SLOW
    os.write(writer, b"quick\n")
    assert stalk(2.0) is Stalk.SLOW
    os.write(writer, b"Fast\nint\n")
    assert stalk(3.0) is Stalk.INTERMITTENT
    os.close(writer)
    assert stalk(4.0) is Stalk.INTERMITTENT
    assert stalk(5.0) is Stalk.INTERMITTENT
    os.close(reader)
    assert answers[1].startswith("stalk: type off, slow")
