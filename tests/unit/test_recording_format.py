"""A block of a recording keeps every bit, puts each frame in its tick's row, and tells any change."""

import io
from pathlib import Path

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from hilplant.bench import load_bench
from hilplant.recording.adoption import adopted_rows
from hilplant.recording.format import SIGNAL_COLUMNS, batch, checksum, schema
from hilplant.recording.recorder import description_now
from hilplant.recording.writer import RecordingWriter
from hilplant.runtime.frame_slot import FRAME_DTYPE

WIDTH = 2 + len(SIGNAL_COLUMNS)


def rows_of(*ticks: int) -> NDArray[np.float64]:
    rows = np.random.default_rng(7).normal(size=(len(ticks), WIDTH))
    rows[:, 0] = ticks
    rows[:, 1] = np.array(ticks) * 1_000_000
    return rows


def frames_of(*ticks: int) -> NDArray[np.void]:
    frames = np.zeros(len(ticks), FRAME_DTYPE)
    frames["tick"] = ticks
    frames["identifier"] = np.arange(len(ticks))
    frames["length"] = np.arange(len(ticks)) % 65
    frames["data"] = np.arange(64)
    return frames


def through_a_file(values: pa.RecordBatch) -> pa.RecordBatch:
    stored = io.BytesIO()
    with pa.ipc.new_stream(stored, values.schema, options=pa.ipc.IpcWriteOptions(compression="zstd")) as stream:
        stream.write_batch(values)
    return pa.ipc.open_stream(stored.getvalue()).read_next_batch()


def identifiers(values: pa.RecordBatch) -> list[list[int]]:
    return [[frame["identifier"] for frame in frames] for frames in values.column("frames").to_pylist()]


def test_every_bit_of_every_number_is_kept_whatever_it_means() -> None:
    rows = rows_of(0, 1, 2, 3, 4, 5)
    odd = np.array([0x7FF8000000000000, 0x7FF0000000000001, 0xFFFFFFFFFFFFFFFF, 1 << 63, 0x7FF << 52, 1], np.uint64)
    rows[:, 5] = odd.view(np.float64)
    values = adopted_rows(through_a_file(batch(rows, frames_of())), {})
    assert values.column(5).null_count == 0
    for index in range(2, WIDTH):
        assert values.column(index).to_numpy().tobytes() == rows[:, index].tobytes()


def test_frames_join_the_row_of_their_tick_and_frames_without_a_row_get_one_of_nulls() -> None:
    values = batch(rows_of(10, 12), frames_of(9, 10, 10, 11, 12, 13))
    assert values.column("tick").to_pylist() == [9, 10, 11, 12, 13]
    assert values.column("deadline_ns").is_valid().to_pylist() == [False, True, False, True, False]
    assert identifiers(values) == [[0], [1, 2], [3], [4], [5]]
    assert [len(frame["data"]) for (frame, *_) in values.column("frames").to_pylist()] == [0, 1, 3, 4, 5]
    values.validate(full=True)


def test_the_checksum_survives_the_file_and_tells_any_change() -> None:
    values = batch(rows_of(0, 2), frames_of(0, 1, 1, 2))
    mark = checksum(values)
    assert checksum(through_a_file(values)) == mark
    for rows, frames in (
        (rows_of(0, 2) * np.nextafter(1.0, 2.0), frames_of(0, 1, 1, 2)),
        (rows_of(0, 2), frames_of(0, 0, 1, 2)),
        (rows_of(0, 2), frames_of(0, 1, 1)),
        (rows_of(0, 1, 2), frames_of(0, 1, 1, 2)),
    ):
        assert checksum(batch(rows, frames)) != mark


def test_the_checksum_tells_one_byte_of_one_frame() -> None:
    frames = frames_of(0, 1, 2)
    mark = checksum(batch(rows_of(0, 1, 2), frames))
    frames["data"][2, 1] ^= 1
    assert checksum(batch(rows_of(0, 1, 2), frames)) != mark


def test_a_file_is_a_recording_before_its_first_row(tmp_path: Path) -> None:
    path = tmp_path / "run.hilrec"
    RecordingWriter(path, description_now(load_bench("default")), WIDTH)
    stream = pa.ipc.open_stream(path.read_bytes())
    assert stream.schema.names == schema().names
    assert stream.read_next_batch().num_rows == 0
