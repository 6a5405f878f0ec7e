"""What the list of commands takes to start: it names every command and imports none of what they do."""

import subprocess
import sys

import pytest

import hilplant
from hilplant.cli.groups import FoundCommands

_LIST = """
import contextlib, io, sys
from hilplant.cli.main import main
sys.argv = ["hilplant", "--help"]
shown = io.StringIO()
with contextlib.redirect_stdout(shown), contextlib.suppress(SystemExit):
    main()
assert "simulate" in shown.getvalue()
print("\\n".join(sys.modules))
"""
#: Rooms and files that every command needs, if only to fail.
_SMALL = {"atomic_write", "cli", "extras", "failure"}
_HEAVY = {"numpy", "numba", "scipy", "pydantic", "yaml", "can", "cantools", "asyncio", "matplotlib", "pyarrow"}


def test_the_list_of_commands_imports_no_room_but_the_command_line() -> None:
    done = subprocess.run([sys.executable, "-c", _LIST], capture_output=True, text=True, check=True)
    modules = done.stdout.split()
    rooms = {name.split(".")[1] for name in modules if name.startswith(f"{hilplant.__name__}.")}
    assert rooms <= _SMALL
    assert not _HEAVY & {name.split(".")[0] for name in modules}


@pytest.mark.parametrize("group", ["", ".plot", ".study", ".train"])
def test_the_list_says_of_each_command_what_the_command_says_of_itself(group: str) -> None:
    found = FoundCommands(f"hilplant.cli.commands{group}", ())
    assert len(found) > 3
    for name, command in found.items():
        assert found.listed(name).get_short_help_str(200) == command.get_short_help_str(200), name
