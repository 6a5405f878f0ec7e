"""MF4 files as other tools lay them out: buses in groups of their own, tables of texts, lengths by DLC, cut files."""

import subprocess
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import can.util
import numpy as np
import pytest
from support.strangers_logs import DBC

from hilplant.failure import Failure
from hilplant.measurements import mf4, mf4_process
from hilplant.measurements.channels import Channels
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.frames import FrameSource
from hilplant.measurements.mf4 import read_mf4_frames

pytest.importorskip("asammdf")

Source = tuple[str, str, str] | None  # name, path, acquisition
COUNT = 200
TIME_S = np.arange(COUNT) * 1e-3
RAW = (np.arange(COUNT) % 100).astype("u2")
AMPERES = np.round(np.sin(9.0 * TIME_S), 2)


@pytest.fixture(autouse=True)
def _in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read here: a process for each file takes seconds. Other tests read in one."""

    def run(command: list[str], **_: Any) -> Any:
        from asammdf import MDF

        path, what, out = command[-3:]
        with MDF(path) as file:
            np.savez(out, **(mf4_process._frames(file) if what == "frames" else mf4_process._channels(file)))
        return subprocess.CompletedProcess(command, 0, b"", b"")

    monkeypatch.setattr(mf4, "subprocess", SimpleNamespace(run=run, TimeoutExpired=subprocess.TimeoutExpired))


def group(file: Any, frames: Sequence[tuple[float, int, bytes]], source: Source, **more: Any) -> None:
    """Add a group of frames, (time [s], identifier, data) each, with the fields in `more` beside them."""
    from asammdf import Signal
    from asammdf import Source as Bus

    width = 8 if max(len(data) for _, _, data in frames) <= 8 else 64
    kinds: list[Any] = [("ID", "<u4"), ("DLC", "u1"), ("DataBytes", f"({width},)u1"), *((name, "u1") for name in more)]
    samples = np.zeros(len(frames), [(f"CAN_DataFrame.{kind[0]}", kind[1]) for kind in kinds])
    for number, (_, identifier, data) in enumerate(frames):
        padded = np.frombuffer(data.ljust(width, b"\0"), np.uint8)
        samples[number] = (identifier, can.util.len2dlc(len(data)), padded, *(0 for _ in more))
    for name, values in more.items():
        samples[f"CAN_DataFrame.{name}"] = values
    told: dict[str, Any] = {}
    if source is not None:
        name, path, acquisition = source
        told = {"acq_source": Bus(name, path, "", Bus.SOURCE_BUS, Bus.BUS_TYPE_CAN), "acq_name": acquisition}
    times = np.array([time_s for time_s, _, _ in frames])
    file.append(Signal(samples, times, name="CAN_DataFrame", source=told.get("acq_source")), **told)


def motor(factor: float) -> list[tuple[float, int, bytes]]:
    raw = np.round(AMPERES * factor * 100.0).astype("<i2")
    return [(time_s, 256, value.tobytes() + bytes(2)) for time_s, value in zip(TIME_S.tolist(), raw, strict=True)]


def read(path: Path, channel: str | None = None) -> Channels:
    (path.parent / "rig.dbc").write_text(DBC)
    return read_channels(Origin(path, frames=FrameSource(path.parent / "rig.dbc", channel=channel)))


@pytest.mark.parametrize(("first", "second", "called"), [
    (("CAN 1", "CAN 1", "CAN"), ("CAN 2", "CAN 2", "CAN"), ("1", "2")),
    (("CAN1", "", ""), ("CAN2", "", ""), ("1", "2")),
    (("CAN", "can_03", ""), ("CAN", "can_07", ""), ("3", "7")),
    (("CAN", "CAN", "Body"), ("CAN", "CAN", "Powertrain 500"), ("Body", "Powertrain 500")),
    (("Gateway 1", "", ""), ("Body 1", "", ""), ("Body 1", "Gateway 1")),
    (("CAN 1", "", ""), ("CAN1", "", ""), ("CAN 1", "CAN1")),
    (("CAN", "a", ""), ("CAN", "", ""), ("CAN", "a CAN")),
    (None, None, ("group0", "group1")),
])  # fmt: skip
def test_a_group_for_each_bus_is_a_channel_each(
    tmp_path: Path, first: Source, second: Source, called: tuple[str, str]
) -> None:
    from asammdf import MDF

    path = tmp_path / "a.mf4"
    with MDF() as file:
        group(file, motor(1.0), first)
        group(file, motor(0.5), second)
        file.save(path)
    with pytest.raises(Failure) as caught:
        read(path)
    assert f"Motor (0x100) comes on channels {called[0]} and {called[1]}; say which one: --frames" in str(caught.value)
    found = [read(path, channel)["Motor.Amps"].values for channel in called]
    found.sort(key=lambda values: -float(np.max(np.abs(values))))
    assert np.allclose(found[0], AMPERES, atol=1e-9)
    assert np.allclose(found[1], AMPERES / 2, atol=0.00501)


@pytest.mark.parametrize("source", [("CAN 1", "CAN 1", "CAN"), ("Body", "", ""), ("", "", "Body")])
def test_one_bus_in_several_groups_is_one_channel(tmp_path: Path, source: Source) -> None:
    """Split in the middle of a message: by its length here."""
    from asammdf import MDF

    path = tmp_path / "a.mf4"
    frames = motor(1.0)
    longer = [(time_s, identifier, data + bytes(1)) for time_s, identifier, data in frames[1::2]]
    with MDF() as file:
        group(file, frames[::2], source)
        group(file, longer, source)
        file.save(path)
    assert np.allclose(read(path)["Motor.Amps"].values, AMPERES, atol=1e-9)


def test_groups_that_say_their_bus_in_a_field_are_told_by_it(tmp_path: Path) -> None:
    from asammdf import MDF

    path = tmp_path / "a.mf4"
    with MDF() as file:
        group(file, motor(1.0), ("CAN", "a", ""), BusChannel=1)
        group(file, motor(0.5), ("CAN 2", "CAN 2", ""))
        file.save(path)
    with pytest.raises(Failure, match="comes on channels 1 and 2"):
        read(path)
    assert np.allclose(read(path, "1")["Motor.Amps"].values, AMPERES, atol=1e-9)


@pytest.mark.parametrize("fields", [{}, {"EDL": 1}, {"EDL": 0}, {"DataLength": None}], ids=str)
@pytest.mark.parametrize("width", [8, 64])
def test_a_dlc_is_a_code_where_there_is_no_length(tmp_path: Path, fields: dict[str, Any], width: int) -> None:
    from asammdf import MDF

    path = tmp_path / "a.mf4"
    codes = np.arange(16)
    lengths = [min(can.util.dlc2len(code), width if fields.get("EDL", 1) else 8) for code in codes.tolist()]
    fields = {name: lengths if value is None else value for name, value in fields.items()}
    with MDF() as file:
        group(file, [(1e-3 * code, code, bytes(range(1, 1 + width))) for code in codes], None, **fields | {"IDE": 0})
        file.save(path)
    with MDF(path) as file:  # all codes, whatever lengths the frames above have
        samples = file.get("CAN_DataFrame", raw=True)
        samples.samples["CAN_DataFrame.DLC"] = codes
        with MDF() as other:
            other.append(samples)
            other.save(path, overwrite=True)
    frames = sorted(read_mf4_frames(path).frames, key=lambda frame: frame.identifier)
    assert [len(frame.data) for frame in frames] == lengths


def channels(path: Path, version: str = "4.10", **made: Any) -> Channels:
    """Write RAW under each name, with the conversion given, and read it back."""
    from asammdf import MDF, Signal

    with MDF(version=version) as file:
        file.append([Signal(RAW, TIME_S, name=name, conversion=conversion) for name, conversion in made.items()])
        saved = file.save(path, overwrite=True)
    return read_channels(Origin(Path(saved)))


def table(default: Any, ranges: bool, entries: dict[int, Any]) -> Any:
    from asammdf.blocks.conversion_utils import from_dict

    made: dict[str, Any] = {"default_addr": from_dict(default) if isinstance(default, dict) else default}
    for number, (raw, text) in enumerate(entries.items()):
        one = {"lower": raw, "upper": raw} if ranges else {"val": raw}
        made |= {f"{name}_{number}": value for name, value in one.items()}
        made[f"text_{number}"] = from_dict(text) if isinstance(text, dict) else text
    return from_dict(made)


WORDS = {0: b"off", 99: b"invalid"}
LINEAR, RATIONAL = {"a": 0.01, "b": -1.0}, {"P1": 0, "P2": 1, "P3": -100, "P4": 0, "P5": 0, "P6": 100}


@pytest.mark.parametrize("ranges", [False, True])
@pytest.mark.parametrize("count", [COUNT, 80])  # asammdf converts few values by other code than many
@pytest.mark.parametrize("default", [LINEAR, RATIONAL])
def test_a_text_among_scaled_numbers_is_no_number(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ranges: bool, count: int, default: Any
) -> None:
    monkeypatch.setitem(globals(), "RAW", RAW[:count])
    monkeypatch.setitem(globals(), "TIME_S", TIME_S[:count])
    found = channels(tmp_path / "a.mf4", amps=table(default, ranges, WORDS))["amps"]
    truth = np.where(np.isin(RAW, list(WORDS)), np.nan, RAW * 0.01 - 1.0)
    assert np.allclose(found.values, truth, equal_nan=True)
    assert not found.held, "held, a text would silently be the number before it"


@pytest.mark.parametrize("ranges", [False, True])
def test_nothing_but_texts_is_no_number_where_others_would_be(tmp_path: Path, ranges: bool) -> None:
    """Whether a text is a number does not depend on what else was recorded."""
    words = dict.fromkeys(range(100), b"off")
    assert np.all(np.isnan(channels(tmp_path / "a.mf4", amps=table(LINEAR, ranges, words))["amps"].values))


@pytest.mark.parametrize("ranges", [False, True])
@pytest.mark.parametrize("default", [None, b"unknown", {"a": 1.0, "b": 0.0}], ids=str)
def test_words_are_their_raw_numbers_where_nothing_is_scaled(tmp_path: Path, ranges: bool, default: Any) -> None:
    found = channels(tmp_path / "a.mf4", park=table(default, ranges, WORDS))["park"]
    assert np.array_equal(found.values, RAW)
    assert found.held


def test_ranges_with_scales_of_their_own(tmp_path: Path) -> None:
    found = channels(tmp_path / "a.mf4", amps=table(None, False, {**WORDS, 50: LINEAR}))["amps"].values
    assert np.isnan(found[[0, 99]]).all()
    assert found[50] == -0.5


NAMES = ("CAN_Current", "CAN_DataFrameCount", "CAN_", "xCAN_DataFrame", "CAN_ErrorFrames")


def test_no_signal_is_left_out_for_its_name(tmp_path: Path) -> None:
    left_out = ("CAN_DataFrame", "CAN_RemoteFrame.ID", "CAN_ErrorFrame.BusChannel", "CAN_OverloadFrame")
    assert set(channels(tmp_path / "a.mf4", **dict.fromkeys(NAMES + left_out))) == set(NAMES)


@pytest.mark.parametrize("part", [0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999])
@pytest.mark.parametrize("data_last", [False, True])
def test_a_file_that_is_cut_off_says_so(tmp_path: Path, part: float, data_last: bool) -> None:
    """Wherever its samples lie: a logger that writes as it goes has them behind all else."""
    path = tmp_path / "a.mf4"
    channels(path, x=None)
    whole = bytearray(path.read_bytes())
    if data_last:
        at = whole.index(b"##DT")
        length = int.from_bytes(whole[at + 8 : at + 16], "little")
        links = [place for place in range(64, len(whole), 8) if whole[place : place + 8] == at.to_bytes(8, "little")]
        whole += bytes(-len(whole) % 8)
        for place in links:
            whole[place : place + 8] = len(whole).to_bytes(8, "little")
        whole += whole[at : at + length]
    path.write_bytes(whole)
    assert np.array_equal(read_channels(Origin(path))["x"].values, RAW)
    path.write_bytes(whole[: int(len(whole) * part)])
    with pytest.raises(Failure, match=r"a\.mf4: is cut off or damaged: at least \d+ bytes are missing behind its end$"):
        read_channels(Origin(path))
