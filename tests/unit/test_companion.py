"""A process beside another: it waits for its order, says why it cannot do it, and does not outlive who started it."""

import subprocess
import sys

import pytest

from hilplant.companion import begun
from hilplant.failure import Failure

DOOR = "hilplant.channel.door"


def test_one_that_never_got_an_order_is_ended_at_once() -> None:
    with begun(DOOR) as started:
        assert started.child.poll() is None
    assert started.child.returncode == -9


def test_the_end_of_its_input_ends_one_that_waits_for_its_order() -> None:
    """As when the process that started it was killed."""
    ended = subprocess.run(
        [sys.executable, "-m", DOOR], input="", capture_output=True, text=True, timeout=60, check=False
    )
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")


def test_one_that_ends_without_a_word_is_a_failure_in_the_words_of_its_user() -> None:
    with begun("hilplant.not_a_module") as started, pytest.raises(Failure, match="it did not start"):
        started.order({}, "it did not start")
