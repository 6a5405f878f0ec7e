"""Where a run says that it is there: one small file for each, in a folder that is its user's alone.

The file names the ring, the socket and the columns of a row; it goes with the run. What a run that was killed has left
is recognised by its process, which is no longer there.
"""

import contextlib
import json
import os
import stat
import tempfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hilplant.failure import Failure
from hilplant.models.records import STATE_INDEX
from hilplant.signals import INPUTS, OUTPUTS, STATUS

#: Version of the protocol and of this file.
PROTOCOL = 1


def columns() -> list[tuple[str, str]]:
    """Return name and unit of each column of a row, in its order."""
    owners = [(f"owner.{signal.name}", "") for signal in INPUTS]
    groups = (("in", INPUTS), ("out", OUTPUTS), ("status", STATUS))
    signals = [(f"{prefix}.{each.name}", each.unit) for prefix, group in groups for each in group]
    return [("tick", ""), ("deadline_ns", "ns"), *signals, *((f"state.{name}", "") for name in STATE_INDEX), *owners]


def column_of(name: str) -> int:
    """Return the place of a column by its full name, or of an output, a count or an input by its own.

    Raises
    ------
    ValueError
        When there is none.
    """
    places = {full: index for index, (full, _) in enumerate(columns())}
    for candidate in (name, f"out.{name}", f"status.{name}", f"in.{name}"):
        if candidate in places:
            return places[candidate]
    raise ValueError(f"there is no signal '{name}'")


@dataclass(frozen=True, slots=True)
class RunFile:
    """What the file of a run says. `socket` is empty where there is no channel; `interface` as `socketcan can0`."""

    ring: str
    pid: int
    bench: str
    interface: str
    step_ns: int
    socket: str = ""
    protocol: int = PROTOCOL

    @property
    def path(self) -> Path:
        """Where the file is."""
        return run_folder() / f"{self.ring}.json"

    @property
    def alive(self) -> bool:
        """Whether the run still goes on."""
        try:
            os.kill(self.pid, 0)
        except ProcessLookupError:
            return False
        except PermissionError:
            pass
        return True

    def write(self) -> None:
        """Write the file."""
        described = asdict(self) | {"columns": [{"name": name, "unit": unit} for name, unit in columns()]}
        self.path.write_text(json.dumps(described, indent=1) + "\n")

    def remove(self) -> None:
        """Remove the file, and the socket."""
        self.path.unlink(missing_ok=True)
        if self.socket:
            Path(self.socket).unlink(missing_ok=True)


def run_folder() -> Path:
    """Return the folder of this user's runs, made where it is not there.

    Raises
    ------
    Failure
        When others could write there.
    """
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    folder = Path(runtime, "hilplant") if runtime else Path(tempfile.gettempdir(), f"hilplant-{os.getuid()}")
    with contextlib.suppress(FileExistsError):
        folder.mkdir(mode=0o700, parents=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o077:
        raise Failure(f"{folder}: must be a folder of this user alone: chmod 700 {folder}")
    return folder


def runs() -> Iterator[RunFile]:
    """Give the runs of this user that go on; what killed ones have left is removed."""
    for path in sorted(run_folder().glob("*.json")):
        found = _read(path)
        if found is None:
            continue
        if found.alive:
            yield found
        else:
            found.remove()


def run_named(name: str | None = None) -> RunFile:
    """Return the run of this socket, ring, channel or bench; without a name the only one.

    Raises
    ------
    Failure
        When there is none, or more than one.
    """
    there = list(runs())
    found = [each for each in there if name is None or name in _names(each)]
    if len(found) == 1:
        return found[0]
    known = "; ".join(f"{each.bench} on {each.interface} (process {each.pid})" for each in there) or "none"
    wanted = "a run" if name is None else f"a run '{name}'"
    what = "there is no" if not found else "there is more than one run; name the channel of"
    raise Failure(f"{what} {wanted.removeprefix('a ') if not found else wanted}; running: {known}")


def _names(run: RunFile) -> set[str]:
    return {run.ring, run.socket, run.bench, str(run.pid), run.interface, *run.interface.split()}


def _read(path: Path) -> RunFile | None:
    try:
        written: dict[str, Any] = json.loads(path.read_text())
        if written.get("protocol") != PROTOCOL:
            return None
        return RunFile(**{key: value for key, value in written.items() if key != "columns"})
    except (OSError, ValueError, TypeError):  # being written, or no file of ours
        return None
