"""Logs of CAN frames as strangers' tools write them give the same channels, or one line that says why not."""

import gzip
import importlib
from collections.abc import Callable
from pathlib import Path

import can
import can.io.mf4
import numpy as np
import pytest
from support.strangers_logs import AMPERES, COUNT, DBC, HEAD, VOLTS, Row, asc, blf, blf_object, line, rows

from hilplant.failure import Failure
from hilplant.measurements.channels import Channels
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.frames import FrameSource, frame_source
from hilplant.measurements.preparation import Preparation, read_measurement

EXACT = Preparation(offset_a=0.0, current_shift_s=0.0, park_inverted=False)
COLUMNS = "voltage=Motor.Volts,current=Motor.Amps,park=Switch.Park"


@pytest.fixture
def database(tmp_path: Path) -> Path:
    (tmp_path / "rig.dbc").write_text(DBC)
    return tmp_path / "rig.dbc"


def read(path: Path, database: Path) -> Channels:
    return read_channels(Origin(path, frames=FrameSource(database)))


def same(path: Path, database: Path, tail: int = 2) -> Channels:
    """Assert that a log holds what was put in, sample by sample; return its channels."""
    channels = read(path, database)
    made = read_measurement(Origin(path, frames=FrameSource(database)), parse_columns(COLUMNS), EXACT)
    assert abs(len(made) - COUNT) <= tail
    count = len(made) - tail
    at = 1 if abs(made.voltage_v[499] - 0.0) > 1.0 else 0  # where the park frames come later, the first is missed
    assert np.max(np.abs(made.voltage_v[:count] - VOLTS[at : at + count])) < 1e-6
    assert np.max(np.abs(made.current_a[:count] - AMPERES[at : at + count])) < 0.006
    return channels


@pytest.mark.parametrize("start_s", [0.0, 1.7e9, 1.8e9 + 0.1234567])
@pytest.mark.parametrize(("late_s", "jitter_s"), [(0.0, 0.0), (3e-4, 0.0), (5e-4, 0.0), (9e-4, 0.0), (0.0, 2e-4)])
def test_the_clock_is_the_voltages_own(
    tmp_path: Path, database: Path, start_s: float, late_s: float, jitter_s: float
) -> None:
    """Neither the phase of other frames, nor the rounding of an epoch, nor waiting for the bus moves a sample."""
    path = tmp_path / "log.blf"
    with can.Logger(path) as log:
        for time_s, identifier, data in rows(database, late_s, jitter_s):
            log(can.Message(start_s + time_s, identifier, False, data=data))
    same(path, database)


@pytest.mark.parametrize("ending", [".asc", ".log", ".trc", ".asc.gz"])
def test_formats(tmp_path: Path, database: Path, ending: str) -> None:
    path = tmp_path / f"log{ending}"
    plain = path.with_suffix("") if ending.endswith(".gz") else path
    with can.Logger(plain) as log:
        for time_s, identifier, data in rows(database):
            log(can.Message(1.7e9 + time_s, identifier, False, data=data))
    if ending.endswith(".gz"):
        path.write_bytes(gzip.compress(plain.read_bytes()))
    same(path, database)


def relative(lines: list[Row]) -> list[str]:
    times = [0.0, *(row[0] for row in lines)]
    return [line(row[0] - before, *row[1:]) for row, before in zip(lines, times, strict=False)]


def swapped(lines: list[Row]) -> list[str]:
    texts = [line(*row) for row in lines]
    for index in range(50, len(texts) - 1, 37):
        texts[index], texts[index + 1] = texts[index + 1], texts[index]
    return texts


def amid(lines: list[Row], other: str) -> list[str]:
    return [*(line(*row) for row in lines[:700]), other, *(line(*row) for row in lines[700:])]


VARIANTS: dict[str, tuple[Callable[[list[Row]], list[str]], str, str]] = {
    "relative": (relative, HEAD.replace("absolute", "relative"), "added up"),
    "nearly sorted": (swapped, HEAD, "put in order"),
    "names for identifiers": (
        lambda lines: [line(*r).replace("100    ", "Motor  ").replace("101    ", "Switch ") for r in lines], HEAD, "",
    ),
    "requests to send": (
        lambda lines: [text for row in lines for text in (line(*row, way="TxRq"), line(*row, way="Tx"))], HEAD, "",
    ),
    "no line of events": (lambda lines: [line(*row) for row in lines], "base hex  timestamps absolute\n", ""),
    "no head": (lambda lines: [line(*row) for row in lines], "", ""),
    "one short frame": (lambda lines: amid(lines, line(lines[700][0], 257, b"")), HEAD, "1 frames of Switch"),
    "a strange line": (lambda lines: amid(lines, "   0.6 1  ZZZ  Rx   d 8 01\n"), HEAD, "1 lines skipped"),
}  # fmt: skip


@pytest.mark.parametrize("variant", VARIANTS)
def test_asc_of_many_tools(tmp_path: Path, database: Path, variant: str) -> None:
    make, head, note = VARIANTS[variant]
    channels = same(asc(tmp_path / "a.asc", make(rows(database)), head), database)
    assert note in "; ".join(channels.notes)
    assert bool(note) == bool(channels.notes)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8", "utf-8-sig", "utf-16"])
def test_asc_in_german(tmp_path: Path, database: Path, encoding: str) -> None:
    head = HEAD.replace("Sat Nov", "Sam Mär") + "   0.000000 Start der Messung für Tür\n"
    same(asc(tmp_path / "a.asc", [line(*row) for row in rows(database)], head, encoding), database)


@pytest.mark.parametrize("missing", [1, 2, 3, 9, 20, 30])
def test_asc_that_was_cut_off(tmp_path: Path, database: Path, missing: int) -> None:
    path = asc(tmp_path / "a.asc", [line(*row) for row in rows(database)])
    path.write_bytes(path.read_bytes()[:-missing])
    assert "cut off" in "; ".join(same(path, database, 3).notes)


def test_one_identifier_on_two_channels_asks_which(tmp_path: Path, database: Path) -> None:
    lines = [
        text for row in rows(database) for text in (line(*row), line(row[0] + 5e-4, row[1], bytes(len(row[2])), 2))
    ]
    path = asc(tmp_path / "a.asc", lines)
    with pytest.raises(Failure, match=r"Motor \(0x100\) comes on channels 1 and 2; say which .*rig.dbc@1"):
        read(path, database)
    chosen = read_channels(Origin(path, frames=frame_source(f"{database}@2")))
    assert not np.any(chosen["Motor.Volts"].values)
    first = read_channels(Origin(path, frames=frame_source(f"{database}@1")))
    assert np.array_equal(first["Motor.Volts"].values, VOLTS)


def test_two_messages_of_one_name_are_told_apart_and_one_identifier_twice_is_refused(tmp_path: Path) -> None:
    database = tmp_path / "twice.dbc"
    database.write_text(DBC.replace("BO_ 257 Switch", "BO_ 257 Motor").replace("VAL_ 257 Park", "VAL_ 257 Park"))
    path = asc(tmp_path / "a.asc", [line(0.0, 256, bytes(4)), line(0.0, 257, b"\1")])
    assert set(read(path, database)) == {"Motor#100.Amps", "Motor#100.Volts", "Motor#101.Park"}
    database.write_text(DBC.replace("BO_ 257 Switch", "BO_ 256 Switch").split("VAL_")[0])
    with pytest.raises(Failure, match="0x100 is that of Motor and Switch"):
        read(path, database)


def test_j1939_is_known_by_its_group(tmp_path: Path) -> None:
    """A broadcast whoever sends it and with any priority; another destination is another channel."""
    database = tmp_path / "truck.dbc"
    kind = 'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","reserved","J1939PG";\n'
    messages, values = "", ""
    for name, identifier in (("Cmd", 0x18FEF1FE), ("Ask", 0x18EF00FE)):
        number = identifier | 1 << 31
        messages += f'BO_ {number} {name}: 8 Vector__XXX\n SG_ On : 0|8@1+ (1,0) [0|255] "" Vector__XXX\n'
        values += f'BA_ "VFrameFormat" BO_ {number} 3;\n'
    database.write_text(f'VERSION ""\nBU_: A\n{messages}\n{kind}{values}')
    sent = {0x18FEF100: 1, 0x0CFEF147: 2, 0x18FEF1FE: 3, 0x18EF2147: 4, 0x18EF2247: 5, 0x18FEF200: 6}
    lines = [line(0.1 * n, i, bytes([n, *bytes(7)])).replace(f"{i:X}", f"{i:X}x") for i, n in sent.items()]
    channels = read(asc(tmp_path / "a.asc", lines), database)
    assert {name: channel.values.tolist() for name, channel in channels.items()} == {
        "Cmd@00.On": [1.0], "Cmd@47.On": [2.0], "Cmd.On": [3.0], "Ask@47to21.On": [4.0], "Ask@47to22.On": [5.0],
    }  # fmt: skip


@pytest.mark.parametrize(("strange", "note"), [
    ({}, ""),
    ({"size": 0}, "an object of size 0"),
    ({"size": 0, "version": 0}, "an object of size 0"),
    ({"size": 4_000_000_000}, "an object of size 4000000000"),
    ({"version": 3}, "a header of version 3"),
    ({"kind": 96}, ""),
    ({"kind": 100}, "cannot be read"),
])  # fmt: skip
def test_blf_with_a_damaged_object(tmp_path: Path, database: Path, strange: dict[str, int], note: str) -> None:
    frames = rows(database)
    middle = [] if not strange else [blf_object((0.7, 257, b"\1"), **strange)]
    objects = [*map(blf_object, frames[:900]), *middle, *map(blf_object, frames[900:])]
    channels = same(blf(tmp_path / "a.blf", objects), database)
    assert note in "; ".join(channels.notes)


def test_blf_that_was_cut_off(tmp_path: Path, database: Path) -> None:
    path = blf(tmp_path / "a.blf", [blf_object(row) for row in rows(database)])
    path.write_bytes(path.read_bytes()[:-2000])
    notes = "; ".join(read(path, database).notes)
    assert "cut off: 2000 bytes of its end are missing" in notes


def test_two_logs_behind_one_another_are_refused(tmp_path: Path, database: Path) -> None:
    frames = [line(*row) for row in rows(database)]
    with pytest.raises(Failure, match="the time jumps back from"):
        read(asc(tmp_path / "a.asc", frames + frames), database)


def test_a_text_that_is_no_log_is_told(tmp_path: Path, database: Path) -> None:
    for ending, word in ((".log", "candump"), (".asc", "none of its frames"), (".trc", "cannot be read|PCAN")):
        (tmp_path / f"a{ending}").write_text("hello\nworld\n")
        with pytest.raises(Failure, match=word if ending != ".asc" else "."):
            read(tmp_path / f"a{ending}", database)


def test_mf4_frames_are_read_as_those_of_any_log(tmp_path: Path, database: Path) -> None:
    """Also with a table of texts; held between frames; a file without signals says what it needs."""
    pytest.importorskip("asammdf")
    importlib.reload(can.io.mf4)  # hilplant hides asammdf while it imports python-can
    path = tmp_path / "a.mf4"
    log = can.MF4Writer(path)
    for time_s, identifier, data in rows(database):
        log.on_message_received(can.Message(1.7e9 + time_s, identifier, False, data=data, channel=0))
    log.stop()
    channels = same(path, database)
    assert channels["Switch.Park"].held
    with pytest.raises(Failure, match="holds CAN frames, no signals; say what reads them"):
        read_channels(Origin(path))
    path.write_bytes(path.read_bytes()[:3000])
    with pytest.raises(Failure, match=r"a\.mf4: .*"):
        read(path, database)
