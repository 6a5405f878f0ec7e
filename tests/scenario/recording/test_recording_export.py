"""Every export holds what was recorded: read back by the libraries that others read it with."""

import csv
import importlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import asammdf
import can
import can.io.mf4
import numpy as np
import pytest
from pyarrow import parquet

from hilplant.failure import Failure
from hilplant.plots.recording import plot_recording
from hilplant.recording.export import export
from hilplant.recording.reader import read_recording
from hilplant.signals import INPUTS, OUTPUTS, STATUS

Record = Callable[..., Path]


def expected_columns() -> list[str]:
    names = ["time_s", *(signal.name for signal in OUTPUTS), *(f"in_{signal.name}" for signal in INPUTS)]
    return [*names, *(f"status_{signal.name}" for signal in STATUS), "deadline_s"]


def recorded_frames(path: Path) -> list[dict[str, Any]]:
    return [frame for frames in read_recording(path).table().column("frames").to_pylist() for frame in frames]


def test_csv_holds_every_digit(record_run: Record, tmp_path: Path) -> None:
    path, out = record_run(lose=frozenset({3})), tmp_path / "run.csv"
    assert "1499 ticks" in export(path, out)
    with out.open() as file:
        header, *rows = csv.reader(file)
    assert header == expected_columns()
    table = read_recording(path).table()
    currents = [value for value in table.column("out.current_a").to_pylist() if value is not None]
    assert [float(row[header.index("current_a")]) for row in rows] == currents
    assert rows[3][0] == "0.004"


def test_parquet_holds_every_bit(record_run: Record, tmp_path: Path) -> None:
    path, out = record_run(), tmp_path / "run.parquet"
    export(path, out)
    written = parquet.read_table(out)
    assert written.column_names == expected_columns()
    table = read_recording(path).table()
    for signal in OUTPUTS:
        recorded = table.column(f"out.{signal.name}").to_numpy()
        assert written.column(signal.name).to_numpy().tobytes() == recorded.tobytes()


def test_mf4_holds_signals_with_units_and_all_frames(record_run: Record, tmp_path: Path) -> None:
    path, out = record_run(), tmp_path / "run.mf4"
    assert "1500 frames" in export(path, out)
    table = read_recording(path).table()
    with asammdf.MDF(out) as file:
        current = file.get("current_a")
        assert current.unit == "A"
        assert np.array_equal(current.samples, table.column("out.current_a").to_numpy())
        assert np.array_equal(current.timestamps, np.arange(1500) / 1000)
        count = 0
        for event, kind in (
            ("CAN_DataFrame", ""),
            ("CAN_RemoteFrame", "remote"),
            ("CAN_ErrorFrame", "error"),
        ):
            frames = [f for f in recorded_frames(path) if (f[kind] if kind else not (f["remote"] or f["error"]))]
            stored = file.get(event).samples
            payloads = zip(stored[f"{event}.DataBytes"], stored[f"{event}.DataLength"], strict=True)
            assert [bytes(data[:length]) for data, length in payloads] == [f["data"] for f in frames]
            assert stored[f"{event}.ID"].tolist() == [f["identifier"] for f in frames]
            assert stored[f"{event}.Dir"].tolist() == [f["sent"] for f in frames]
            count += len(stored)
    assert count == 1500


def test_signals_and_frames_of_an_mf4_share_one_clock_where_periods_were_lost(
    record_run: Record, tmp_path: Path
) -> None:
    path, out = record_run(70, late_from=30), tmp_path / "run.mf4"
    export(path, out)
    due_s = np.array([tick if tick < 30 else tick + 5 for tick in range(70)]) / 1000
    with asammdf.MDF(out) as file:
        assert np.array_equal(file.get("current_a").timestamps, due_s)
        assert np.array_equal(file.get("time_s").samples, np.arange(70) / 1000)
        assert np.isin(file.get("CAN_DataFrame").timestamps, due_s).all()


def test_python_can_reads_the_data_frames_of_an_mf4_back(record_run: Record, tmp_path: Path) -> None:
    path, out = record_run(70), tmp_path / "run.mf4"
    export(path, out)
    importlib.reload(can.io.mf4)  # hilplant hides asammdf while it imports python-can
    read = [message for message in can.io.mf4.MF4Reader(out) if not (message.is_remote_frame or message.is_error_frame)]
    frames = [frame for frame in recorded_frames(path) if not (frame["remote"] or frame["error"])]
    assert [bytes(message.data) for message in read] == [frame["data"] for frame in frames]
    assert [message.arbitration_id for message in read] == [frame["identifier"] for frame in frames]


@pytest.mark.parametrize("ending", [".blf", ".asc"])
def test_frame_logs_hold_every_frame_with_content_direction_and_time(
    record_run: Record, tmp_path: Path, ending: str
) -> None:
    path, out = record_run(lose=frozenset({7, 8})), tmp_path / f"run{ending}"
    assert "1500 frames" in export(path, out)
    frames, read = recorded_frames(path), list(can.LogReader(out))
    assert len(read) == len(frames) == 1500
    start_s = read[0].timestamp
    for message, frame in zip(read, frames, strict=True):
        assert abs(message.timestamp - start_s - frame["time_ns"] / 1e9) < 2e-6
        assert message.is_error_frame == frame["error"]
        if frame["error"] and ending == ".asc":
            continue  # the format knows only that there was one
        assert message.arbitration_id == frame["identifier"]
        assert bytes(message.data) == frame["data"]
        assert message.is_extended_id == frame["extended"]
        assert message.is_fd == frame["fd"]
        assert message.bitrate_switch == frame["bitrate_switch"]
        if not (ending == ".asc" and frame["fd"] and not frame["data"]):  # its reader takes these for remote
            assert message.is_remote_frame == frame["remote"]
        assert frame["error"] or message.is_rx != frame["sent"]


def test_a_blf_tells_the_time_of_day(record_run: Record, tmp_path: Path) -> None:
    path, out = record_run(), tmp_path / "run.blf"
    export(path, out)
    first = next(iter(can.LogReader(out)))
    assert abs(first.timestamp - read_recording(path).run.start_utc.timestamp()) < 1e-6


def test_another_ending_is_refused_with_the_possible_ones(record_run: Record, tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"run.xlsx: .* .mf4, .csv, .parquet, .mcap, .blf, .asc"):
        export(record_run(10), tmp_path / "run.xlsx")


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".mf4", ".blf", ".asc", ".png"])
def test_a_folder_that_is_not_there_is_one_clear_error(record_run: Record, tmp_path: Path, ending: str) -> None:
    out = tmp_path / "nowhere" / f"run{ending}"
    with pytest.raises(Failure, match="cannot be written"):
        (plot_recording if ending == ".png" else export)(record_run(10), out)


@pytest.mark.parametrize("ending", [".csv", ".parquet", ".mf4", ".blf", ".asc"])
def test_a_damaged_recording_leaves_no_half_file_and_what_was_there_before(
    record_run: Record, tmp_path: Path, ending: str
) -> None:
    path, out = record_run(), tmp_path / "out" / f"run{ending}"
    content = bytearray(path.read_bytes())
    content[len(content) * 3 // 4] ^= 0x55
    path.write_bytes(content)
    out.parent.mkdir()
    out.write_text("of an earlier run")
    with pytest.raises(Failure, match="damaged in block"):
        export(path, out)
    assert [file.read_text() for file in out.parent.iterdir()] == ["of an earlier run"]


def test_a_plot_is_a_picture(record_run: Record, tmp_path: Path) -> None:
    out = tmp_path / "run.png"
    plot_recording(record_run(), out)
    assert out.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["$\\frac{$", "$", "a $x^$ b", "{}_^\\"])
def test_a_benchs_name_is_drawn_as_it_is_written(
    record_run: Record, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    recording = read_recording(record_run())
    recording.run = replace(recording.run, name=name)
    monkeypatch.setattr("hilplant.plots.recording.read_recording", lambda path: recording)
    out = tmp_path / "run.png"
    plot_recording("run", out)
    assert out.read_bytes().startswith(b"\x89PNG")


def test_a_recording_without_ticks_cannot_be_drawn(record_run: Record, tmp_path: Path) -> None:
    with pytest.raises(Failure, match="no ticks"):
        plot_recording(record_run(0), tmp_path / "run.png")
