"""MF4 files: what this project exports is read back, and a reader that dies takes nothing with it."""

import random
import stat
import sys
from pathlib import Path
from types import SimpleNamespace

import cantools
import numpy as np
import pyarrow as pa
import pytest
from support import strangers_logs
from support.strangers_logs import AMPERES, COUNT, TIME_S, VOLTS

from hilplant.failure import Failure
from hilplant.measurements import mf4
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.frames import FrameSource
from hilplant.measurements.preparation import Preparation, read_measurement
from hilplant.recording.mf4_frames import FrameGroups

pytest.importorskip("asammdf")

#: The switch has an extended identifier here.
DBC = strangers_logs.DBC.replace("257", "2147483905")
PARK = ((TIME_S % 0.5) < 0.05).astype(int)


@pytest.fixture
def database(tmp_path: Path) -> Path:
    (tmp_path / "rig.dbc").write_text(DBC)
    return tmp_path / "rig.dbc"


@pytest.fixture
def exported(tmp_path: Path, database: Path) -> Path:
    """A file of frames as this project's export writes it, in two pieces, with remote and error frames among them."""
    from asammdf import MDF

    known = cantools.database.load_file(database)
    flags = dict.fromkeys(("sent", "fd", "bitrate_switch", "remote", "error"), False)
    rows = []
    for tick in range(COUNT):
        frames = []
        values = [("Motor", {"Amps": AMPERES[tick], "Volts": VOLTS[tick]}), ("Switch", {"Park": int(PARK[tick])})]
        for name, signals in values:
            message = known.get_message_by_name(name)
            one = {"time_ns": tick * 1_000_000, "identifier": message.frame_id, "extended": message.is_extended_frame}
            frames.append(one | flags | {"data": message.encode(signals)})
        if tick % 100 == 0:
            frames += [frames[0] | {kind: True, "data": b""} for kind in ("remote", "error")]
        rows.append(frames)
    path = tmp_path / "own.mf4"
    with MDF() as file:
        groups = FrameGroups(file)
        for part in (rows[:700], rows[700:]):
            groups.add(pa.table({"frames": part}))
        file.save(path)
    return path


def test_the_frames_of_an_own_export_are_read_back(exported: Path, database: Path) -> None:
    columns = parse_columns("voltage=Motor.Volts,current=Motor.Amps,park=Switch.Park")
    how = Preparation(offset_a=0.0, current_shift_s=0.0, park_inverted=False)
    made = read_measurement(Origin(exported, frames=FrameSource(database)), columns, how)
    assert len(made) == COUNT
    assert np.allclose(made.current_a, AMPERES, atol=0.006)
    assert np.allclose(made.voltage_v, VOLTS, atol=1e-3)
    assert np.array_equal(made.park > 0.5, PARK > 0.5)


@pytest.mark.parametrize(("ends", "said"), [
    ("kill -SEGV $$", "its reader died of SIGSEGV"), ("kill -KILL $$", "its reader died of SIGKILL"),
    ("exit 3", "its reader ended with code 3"), ("exit 0", "its reader ended with code 0"),
    ("echo noise >&2; echo 'no MDF' >&2; exit 1", "no MDF"),
])  # fmt: skip
def test_a_reader_that_dies_is_one_line(
    tmp_path: Path, database: Path, monkeypatch: pytest.MonkeyPatch, ends: str, said: str
) -> None:
    """The reader is a real process here, which ends as the C code of a library does on a damaged file."""
    double = tmp_path / "reader"
    double.write_text(f"#!/bin/sh\n{ends}\n")
    double.chmod(double.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setattr(mf4, "sys", SimpleNamespace(executable=str(double)))
    path = tmp_path / "a.mf4"
    path.write_bytes(b"MDF     ")
    for frames in (FrameSource(), FrameSource(database)):
        with pytest.raises(Failure) as caught:
            read_channels(Origin(path, frames=frames))
        assert str(caught.value) == f"{path}: cannot be read as MDF, it may be damaged: {said}"
    assert sys.executable != str(double)


def test_a_reader_without_end_is_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    double = tmp_path / "reader"
    double.write_text("#!/bin/sh\nexec sleep 60\n")
    double.chmod(0o700)
    monkeypatch.setattr(mf4, "sys", SimpleNamespace(executable=str(double)))
    monkeypatch.setattr(mf4, "LONGEST_S", 0.2)
    path = tmp_path / "a.mf4"
    path.write_bytes(b"MDF     ")
    with pytest.raises(Failure, match=r"no end after 0\.2 s"):
        read_channels(Origin(path))


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_changed_bytes_end_in_channels_or_one_line(exported: Path, database: Path, seed: int) -> None:
    rng = random.Random(seed)
    content = bytearray(exported.read_bytes())
    for _ in range(seed):
        content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    for _ in range(4):  # and among the blocks that say where the others are
        content[rng.randrange(64, 4096)] = rng.randrange(256)
    exported.write_bytes(content)
    try:
        read_channels(Origin(exported, frames=FrameSource(database)))
    except Failure as error:
        assert "\n" not in str(error)
        assert str(error).startswith(str(exported))


def test_what_is_wrong_with_a_file_is_told(exported: Path) -> None:
    """Not what goes wrong once more as half-made objects are deleted."""
    content = bytearray(exported.read_bytes())
    content[64:68] = b"##XX"
    exported.write_bytes(content)
    with pytest.raises(Failure, match=r"it may be damaged: .*is not a valid MDF file$"):
        read_channels(Origin(exported))
