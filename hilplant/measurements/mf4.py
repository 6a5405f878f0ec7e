"""MF4 through asammdf, in a process of its own: its C code can die of a damaged file, and so only that process does.

The process writes arrays to a file: channels as raw numbers, or frames of the bus.
"""

import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hilplant.extras import need
from hilplant.failure import Failure
from hilplant.measurements.channels import Channels
from hilplant.measurements.frames import LoggedFrame, LoggedFrames
from hilplant.measurements.measurement import Channel
from hilplant.measurements.mf4_blocks import missing_bytes

#: A file that takes longer is not read [s].
LONGEST_S = 600.0


def read_mf4_channels(path: Path) -> Channels:
    """Read the channels of numbers; one with a table of texts as its numbers, held until the next."""
    arrays = _arrays(path, "channels")
    channels = {}
    for index, name in enumerate(arrays["names"].tolist()):
        held = bool(arrays["held"][index])
        unit = str(arrays["units"][index])
        channels[name] = Channel(arrays[f"time{index}"], arrays[f"values{index}"], unit, held)
    if not channels and arrays["frames"]:
        raise Failure(f"{path}: holds CAN frames, no signals; say what reads them: --frames FILE.dbc or --frames BENCH")
    return Channels(channels)


def read_mf4_frames(path: Path) -> LoggedFrames:
    """Read the data frames of bus logging."""
    arrays = _arrays(path, "frames")
    if not len(arrays["time"]):
        raise Failure(f"{path}: holds no CAN frames; leave --frames out to see its signals")
    return LoggedFrames(_frames(arrays), [])


def _frames(arrays: dict[str, np.ndarray]) -> Iterator[LoggedFrame]:
    columns = (arrays[name].tolist() for name in ("time", "identifier", "extended", "length", "channel"))
    for index, (time_s, identifier, extended, length, channel) in enumerate(zip(*columns, strict=True)):
        yield LoggedFrame(time_s, identifier, bool(extended), arrays["data"][index, :length].tobytes(), channel)


def _arrays(path: Path, what: str) -> dict[str, np.ndarray]:
    need("mdf")
    if missing := missing_bytes(path):
        raise Failure(f"{path}: is cut off or damaged: at least {missing} bytes are missing behind its end")
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "arrays.npz"
        command = [sys.executable, "-m", "hilplant.measurements.mf4_process", str(path), what, str(out)]
        try:
            done = subprocess.run(command, check=False, capture_output=True, timeout=LONGEST_S)
        except subprocess.TimeoutExpired:
            raise Failure(f"{path}: cannot be read as MDF: no end after {LONGEST_S:g} s") from None
        if done.returncode or not out.is_file():
            lines = done.stderr.decode("utf-8", "replace").strip().splitlines()
            reason = lines[-1] if done.returncode == 1 and lines else f"its reader {_end(done.returncode)}"
            raise Failure(f"{path}: cannot be read as MDF, it may be damaged: {reason}")
        with np.load(out) as arrays:
            return dict(arrays)


def _end(code: int) -> str:
    """Say how a process ended that said nothing itself."""
    if code >= 0:
        return f"ended with code {code}"
    known = {int(each): each.name for each in signal.Signals}
    return f"died of {known.get(-code, f'signal {-code}')}"
