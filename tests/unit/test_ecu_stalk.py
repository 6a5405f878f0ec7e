"""The driver's hand: what can be written, what is refused and how, and what a terminal may type."""

import os
import select

import pytest

from hilplant.ecu.stalk import (
    PRESSES_S,
    PlayedStalk,
    StalkError,
    TypedStalk,
    move_named,
    parse_stalk,
    stalk_at,
    stalk_words,
)
from hilplant.ecu.vocabulary import Master, Stalk


def test_a_sequence_is_read_in_order_with_names_or_their_beginnings():
    turns = parse_stalk("0:off, 1.5:slow,6:F,11:intermittent,12:i3,13:5,14:fl,15:wash")
    assert not any(turn.move.automatic for turn in turns)
    moves = [(turn.time_s, *turn.move[:3]) for turn in turns]
    assert moves == [
        (0.0, Master.OFF, None, None),
        (1.5, Master.SLOW, None, None),
        (6.0, Master.FAST, None, None),
        (11.0, Master.INTERMITTENT, None, None),
        (12.0, Master.INTERMITTENT, 3, None),
        (13.0, None, 5, None),
        (14.0, None, None, "flick"),
        (15.0, None, None, "wash"),
    ]


@pytest.mark.parametrize("text", ["0:off", "0.1:slow,0.3:flick,0.5:fast,0.7:wash,1.6:i3", "0.2:wash,0.4:flick"])
@pytest.mark.parametrize("step_s", [0.001, 0.005, 0.1])
def test_a_played_sequence_is_at_each_time_where_it_is_when_asked_once(text: str, step_s: float) -> None:
    turns = parse_stalk(text)
    played, times_s = PlayedStalk(turns), [index * step_s for index in range(-1, round(2.0 / step_s))]
    assert [played(time_s) for time_s in times_s] == [stalk_at(turns, time_s) for time_s in times_s]


def test_a_time_that_falls_short_of_a_movement_by_rounding_does_not_lose_the_movement() -> None:
    played = PlayedStalk(parse_stalk("1:slow"))
    assert [played(time_s).master for time_s in (0.0, 1.0 - 5e-7, 1.1)] == [Master.OFF, Master.OFF, Master.SLOW]


def test_a_position_holds_until_the_next_and_is_off_before_the_first():
    turns = parse_stalk("1:slow,6:fast")
    positions = [stalk_at(turns, elapsed_s).master for elapsed_s in (0.0, 0.999, 1.0, 5.9, 6.0, 1e9)]
    assert positions == [Master.OFF, Master.OFF, Master.SLOW, Master.SLOW, Master.FAST, Master.FAST]


def test_the_pause_stays_chosen_whatever_the_position_does():
    turns = parse_stalk("1:i4,2:slow,3:intermittent,4:2")
    assert [stalk_at(turns, at_s).interval for at_s in (0.5, 1.5, 2.5, 3.5, 4.5)] == [1, 4, 4, 4, 2]
    assert stalk_at(turns, 4.5).master is Master.INTERMITTENT


@pytest.mark.parametrize("word", ["flick", "wash"])
def test_a_button_is_pressed_for_its_time_and_moves_nothing_else(word):
    turns = parse_stalk(f"0:i2,1:{word},1.1:slow")
    pressed = [getattr(stalk_at(turns, 1.0 + after_s), word) for after_s in (-0.01, 0.0, 0.2, PRESSES_S[word])]
    assert pressed == [False, True, True, False]
    assert stalk_at(turns, 1.05)._replace(flick=False, wash=False) == Stalk(Master.INTERMITTENT, 2)


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
        ("0:slow,1:quick", "entry 2 '1:quick': position must be one of off, intermittent, slow, fast, flick, wash"),
        ("0:", "position must be one of"),
        ("0:slow:fast", "position must be one of"),
        ("0:slow3", "intermittent with a pause from 1 to 6"),
        ("0:flick3", "position must be one of"),
        ("0:i0", "position must be one of"),
        ("0:i7", "position must be one of"),
        ("0:i12", "position must be one of"),
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
    assert stalk(0.0) == Stalk()
    os.write(writer, b"s\n")
    assert stalk(1.0) == Stalk(Master.SLOW)
    os.write(writer, b"quick\n")
    assert stalk(2.0) == Stalk(Master.SLOW)
    os.write(writer, b"Fast\ni3\nflick\n")
    assert stalk(3.0) == Stalk(Master.INTERMITTENT, 3, flick=True)
    os.close(writer)
    assert stalk(3.0 + 0.9 * PRESSES_S["flick"]).flick and not stalk(4.0).flick
    assert stalk(5.0) == Stalk(Master.INTERMITTENT, 3)
    os.close(reader)
    assert answers == ["stalk: slow", answers[1], "stalk: fast", "stalk: intermittent 3", "stalk: flick"]
    assert answers[1].startswith("stalk: type one of off, ")


def test_nobody_waits_for_a_line_that_is_not_typed(monkeypatch):
    waits = []
    monkeypatch.setattr(select, "select", lambda *asked: waits.append(asked[3]) or ([], [], []))
    assert TypedStalk(0, lambda _: None)(1.0) == Stalk()
    assert waits == [0.0]


@pytest.mark.parametrize("word", PRESSES_S)
def test_a_typed_button_is_released_after_its_time(word: str):
    reader, writer = os.pipe()
    stalk = TypedStalk(reader, lambda _: None)
    os.write(writer, word.encode() + b"\n")
    pressed = [getattr(stalk(at_s), word) for at_s in (0.0, PRESSES_S[word] - 1e-9, PRESSES_S[word])]
    assert pressed == [True, True, False]
    os.close(writer)
    os.close(reader)


def test_a_line_that_comes_in_pieces_counts_when_it_is_whole_and_the_last_at_the_end_of_the_file():
    reader, writer = os.pipe()
    answers: list[str] = []
    stalk = TypedStalk(reader, answers.append)
    seen = []
    for piece in (b"slo", b"w\nfa", b"st"):
        os.write(writer, piece)
        seen.append(stalk(0.0))
    os.close(writer)
    assert [*seen, stalk(1.0)] == [Stalk(), Stalk(Master.SLOW), Stalk(Master.SLOW), Stalk(Master.FAST)]
    assert stalk(2.0) == Stalk(Master.FAST)
    os.close(reader)
    assert answers == ["stalk: slow", "stalk: fast"]


@pytest.mark.parametrize("stalk", [Stalk(), Stalk(Master.FAST), Stalk(Master.INTERMITTENT, 6)])
def test_the_words_for_a_stalk_are_words_for_a_move_there(stalk):
    move = move_named(stalk_words(stalk).replace(" ", ""))
    assert move is not None
    assert (move.master, move.interval or 1) == (stalk.master, stalk.interval)
    assert stalk_words(stalk._replace(flick=True, wash=True)).endswith(" + flick + wash")
