"""docs/thesis.md: all 104 items, each command one that hilplant takes; those not marked long are run."""

import re
import shlex
import subprocess
from pathlib import Path
from typing import Any

import pytest
import typer
from support.thesis_page import PREPARED, ROWS
from typer.main import get_command
from typer.testing import CliRunner

from hilplant.cli.main import app
from hilplant.resources import shipped_root

ROOT = shipped_root()
STATES = ("works", "partly: ", "not built: ")
ALL = sorted({command for row in ROWS for command, _ in row.commands})
#: Run one after the other in one folder, so that a picture finds the table that was made before it.
CHEAP = list(dict.fromkeys(command for row in ROWS for command in row.commands if command[1] != "long"))


def test_every_item_has_a_row_a_state_and_unless_nothing_is_built_a_command() -> None:
    assert [row.number for row in ROWS] == list(range(1, 105))
    for row in ROWS:
        assert row.state.startswith(STATES), row
        assert bool(row.commands) != row.state.startswith("not built"), row
        assert "missing" not in row.state
    assert sum(row.state.startswith("works") for row in ROWS) >= 90


@pytest.mark.parametrize("command", ALL)
def test_the_command_line_is_one_that_hilplant_takes(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = shlex.split(command)[1:]
    if words[0] == "vcan":
        words = words[2:]
    parsed(words)


def parsed(words: list[str]) -> None:
    """Go down to the command and read its options and arguments, without running it."""
    found: Any = get_command(app)
    context: Any = typer.Context(found)
    while hasattr(found, "get_command"):
        name, *words = words
        found = found.get_command(context, name)
        assert found is not None, name
    found.make_context(found.name, words)


@pytest.mark.parametrize("words", [["plot", "friction"], ["list", "--nonsense"], ["train", "torque", "--starts", "x"]])
def test_a_wrong_command_line_is_seen(words: list[str]) -> None:
    with pytest.raises(Exception) as caught:
        parsed(words)
    assert hasattr(caught.value, "format_message")  # wrong use, as the command line itself says it


def test_what_is_not_long_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "config").symlink_to(ROOT / "config")
    monkeypatch.chdir(tmp_path)
    runner = CliRunner()
    for line in PREPARED:
        if not line.startswith("hilplant "):
            subprocess.run(line, shell=True, check=True)
    for command, mark in CHEAP:
        result = runner.invoke(app, shlex.split(command)[1:])
        expected = 1 if mark == "refused" else 0
        assert result.exit_code == expected, f"{command}: {result.output}\n{result.exception!r}"
        if mark == "refused":
            (here,) = [row.here for row in ROWS if (command, mark) in row.commands]
            assert all(said in result.output for said in re.findall(r'"([^"]+)"', here)), (here, result.output)
        for name in re.findall(r"\S+\.(?:png|gif|csv)", command):
            made = list(tmp_path.glob(f"{Path(name).stem}*{Path(name).suffix}"))
            assert made and all(path.stat().st_size > 500 for path in made), command
