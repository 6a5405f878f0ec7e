"""AUTOSAR's state machine against a table worked out by hand, and against a second, naive reading of its rules."""

import random

import pytest

from hilplant.bus.e2e_state import FrameCheck, ProtectionError, StateMachine, StateMachineSettings, Trust
from hilplant.bus.protection import Checker, Protection, Protector

KEYS = (
    "window_size_init", "window_size_valid", "window_size_invalid",
    "min_ok_state_init", "max_error_state_init", "min_ok_state_valid", "max_error_state_valid",
    "min_ok_state_invalid", "max_error_state_invalid",
)  # fmt: skip
SETTINGS = dict(zip(KEYS, (2, 4, 3, 2, 0, 2, 1, 3, 0), strict=True))
OK, ERROR = FrameCheck.OK, FrameCheck.WRONG_CRC


def run(settings: StateMachineSettings, verdicts: str) -> str:
    machine = StateMachine(settings)
    letters = {"o": OK, "r": FrameCheck.WRONG_COUNTER, "e": ERROR}
    shown = {Trust.NODATA: "n", Trust.INIT: "i", Trust.VALID: "v", Trust.INVALID: "x"}
    return "".join(shown[machine.add(letters[letter])] for letter in verdicts)


@pytest.mark.parametrize(
    ("verdicts", "states"),
    [
        ("eeo", "nni"),  # errors alone are no data
        ("oo", "iv"),  # two good ones in a window of two
        ("oro", "iii"),  # of the last two one alone is good
        ("oe", "ix"),  # no error is allowed in INIT
        ("ooe", "ivv"),  # one error is allowed in VALID
        ("ooee", "ivvx"),  # two are not
        ("oorrr", "ivvvx"),  # too few good ones of four: 2, then 1
        ("ooeeoooo", "ivvxxxvv"),  # back when the last three are good
    ],
)
def test_the_states_follow_the_table(verdicts: str, states: str) -> None:
    assert run(StateMachineSettings.from_settings(SETTINGS), verdicts) == states


def naive(settings: StateMachineSettings, verdicts: str) -> str:
    """Keep every status in a list with 'not available' where it was cleared, as the specification tells it."""
    name = {"n": "init", "i": "init", "v": "valid", "x": "invalid"}
    state, window, states = "n", ["-"] * settings.window_size_valid, ""
    for letter in verdicts:
        window = [letter, *window[:-1]]
        size = getattr(settings, f"window_size_{name[state]}")
        enough = window[:size].count("o") >= getattr(settings, f"min_ok_state_{name[state]}")
        few_errors = window[:size].count("e") <= getattr(settings, f"max_error_state_{name[state]}")
        before = state
        if state == "n":
            state = "n" if letter == "e" else "i"
        elif state == "i":
            state = "v" if enough and few_errors else "i" if few_errors else "x"
        elif state == "v":
            state = "v" if enough and few_errors else "x"
        else:
            state = "v" if enough and few_errors else "x"
        if before not in (state, "n"):
            kept = 0 if (before, state) == ("v", "x") and settings.clear_from_valid_to_invalid else size
            window = window[:kept] + ["-"] * (settings.window_size_valid - kept)
        states += state
    return states


def test_random_settings_and_results_follow_the_rules() -> None:
    source = random.Random(4)
    for _ in range(400):
        valid = source.randint(1, 8)
        sizes = {"init": source.randint(1, valid), "valid": valid, "invalid": source.randint(1, valid)}
        values: dict[str, object] = {f"window_size_{name}": size for name, size in sizes.items()}
        values |= {f"min_ok_state_{name}": source.randint(1, size) for name, size in sizes.items()}
        values |= {f"max_error_state_{name}": source.randint(0, size) for name, size in sizes.items()}
        settings = StateMachineSettings.from_settings({**values, "clear_from_valid_to_invalid": source.random() < 0.5})
        verdicts = "".join(source.choices("ore", (6, 1, 2), k=60))
        assert run(settings, verdicts) == naive(settings, verdicts)


def test_a_good_frame_counts_once_the_machine_is_valid_and_a_reset_begins_anew() -> None:
    protection = Protection.from_settings({"profile": 5, "data_id": 7, "state_machine": SETTINGS}, 8)
    protector, checker = Protector(protection), Checker(protection)

    def next_frame() -> bytes:
        frame = bytearray(8)
        protector.protect(frame)
        return bytes(frame)

    assert [checker.check(next_frame()) for _ in range(3)] == [FrameCheck.NOT_VALID, OK, OK]
    assert [checker.check(bytes(8)) for _ in range(2)] == [ERROR, ERROR]
    assert checker.invalid
    assert [checker.check(next_frame()) for _ in range(3)] == [FrameCheck.NOT_VALID, FrameCheck.NOT_VALID, OK]
    checker.reset()
    assert [checker.check(next_frame()) for _ in range(2)] == [FrameCheck.NOT_VALID, OK]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"window_size_init": 5}, "window_size_init must be 1 to window_size_valid"),
        ({"min_ok_state_valid": 0}, "min_ok_state_valid must be 1 to window_size_valid"),
        ({"max_error_state_invalid": 4}, "max_error_state_invalid must be 0 to window_size_invalid"),
        ({"window": 3}, "state_machine has no key 'window'; it has window_size_init"),
        ({"min_ok_state_init": 1.5}, "min_ok_state_init must be a whole number, not 1.5"),
        ({"clear_from_valid_to_invalid": 1}, "clear_from_valid_to_invalid must be true or false, not 1"),
    ],
)
def test_settings_that_cannot_work_say_what_would(change: dict[str, object], words: str) -> None:
    with pytest.raises(ProtectionError, match=words):
        StateMachineSettings.from_settings({**SETTINGS, **change})


def test_settings_that_are_missing_are_named_together() -> None:
    with pytest.raises(ProtectionError, match=r"lacks window_size_valid, .*max_error_state_invalid"):
        StateMachineSettings.from_settings({"window_size_init": 1})
    with pytest.raises(ProtectionError, match="keys of its own"):
        StateMachineSettings.from_settings(3)
