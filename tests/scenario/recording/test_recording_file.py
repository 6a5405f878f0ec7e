"""What was recorded comes back; a cut tail costs the tail, damage is named, a stranger is refused."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from hilplant.bus.frame import Frame
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording

Record = Callable[..., Path]


def as_frame(stored: dict[str, Any]) -> Frame:
    names = ("identifier", "data", "extended", "fd", "bitrate_switch", "remote", "error")
    return Frame(*(stored[name] for name in names))


def test_the_description_of_the_run_comes_back_to_the_last_bit(record_run: Record, bench: Any) -> None:
    run = read_recording(record_run(10)).run
    assert (run.name, run.step_ns, run.sources) == (bench.name, bench.step_ns, bench.sources)
    for name in ("parameter_row", "tables", "state_row"):
        stored, original = getattr(run, name), getattr(bench, name)
        assert stored.shape == original.shape
        assert stored.tobytes() == original.tobytes()
    assert set(run.build) == {"models_hash", "python", "cpu", "hilplant", "numpy", "numba", "llvmlite"}


def test_every_frame_lies_in_the_row_of_its_tick(record_run: Record, frames: tuple[Frame, ...]) -> None:
    table = read_recording(record_run()).table()
    assert table.column("tick").to_pylist() == list(range(1500))
    for tick, (stored,) in enumerate(table.column("frames").to_pylist()):
        assert as_frame(stored) == frames[tick % len(frames)]
        assert (stored["time_ns"], stored["sent"]) == (tick * 1_000_000, tick % 2 == 1)


def test_a_lost_row_leaves_its_frames_and_nulls(record_run: Record) -> None:
    table = read_recording(record_run(lose=frozenset({5, 800, 1499}))).table()
    assert table.column("tick").to_pylist() == list(range(1500))
    lost = np.flatnonzero(~table.column("deadline_ns").is_valid().to_numpy())
    assert lost.tolist() == [5, 800, 1499]
    assert table.column("out.current_a").null_count == 3
    assert all(len(frames) == 1 for frames in table.column("frames").to_pylist())


@pytest.mark.parametrize("share", [0.5, 0.7, 0.9, 0.999])
def test_a_file_cut_anywhere_gives_all_whole_blocks_and_a_note(record_run: Record, share: float) -> None:
    path = record_run()
    whole = path.read_bytes()
    blocks_at = whole.index(b"hilplant.crc32", whole.index(b"hilplant.crc32") + 1)  # the first is the description's
    path.write_bytes(whole[: blocks_at + int((len(whole) - blocks_at) * share)])
    recording = read_recording(path)
    ticks = recording.table().column("tick").to_pylist()
    assert ticks == list(range(len(ticks)))
    assert len(ticks) % 400 == 0
    assert any("cut off" in note for note in recording.notes)


def test_a_file_cut_exactly_after_a_block_is_seen_to_be_cut(record_run: Record) -> None:
    path = record_run()
    path.write_bytes(path.read_bytes()[:-8])
    recording = read_recording(path)
    assert len(recording.table()) == 1500
    assert recording.notes


def test_an_undamaged_file_has_no_notes(record_run: Record) -> None:
    recording = read_recording(record_run())
    recording.table()
    assert recording.notes == []


def test_damage_in_the_middle_is_one_clear_error_and_never_passes_for_data(record_run: Record) -> None:
    path = record_run()
    whole = path.read_bytes()
    original = read_recording(path).table()
    first_block = len(whole) - (len(whole) - whole.index(b"hilplant.crc32"))
    for place in np.random.default_rng(3).integers(first_block, len(whole) * 3 // 4, 60):
        damaged = bytearray(whole)
        damaged[place] ^= 0x10
        path.write_bytes(damaged)
        try:
            table = read_recording(path).table()
        except Failure as error:
            assert "\n" not in str(error)
            assert str(path) in str(error)
        else:
            assert table.slice(0, 400).equals(original.slice(0, len(table)).slice(0, 400))
            assert table.equals(original.slice(0, len(table)))


@pytest.mark.parametrize(("key", "bit"), [("tables", 0x01), ("sources", 0x01), ("sources", 0x80), ("start_utc", 0x02)])
def test_a_damaged_description_of_the_run_is_one_clear_error(record_run: Record, key: str, bit: int) -> None:
    path = record_run()
    whole = path.read_bytes()
    with pa.ipc.open_stream(path) as stream:
        text = stream.schema.metadata[f"hilplant.{key}".encode()]
    damaged = bytearray(whole)
    damaged[whole.index(text) + len(text) // 2] ^= bit
    path.write_bytes(damaged)
    with pytest.raises(Failure, match=f"{path}: its description of the run is unreadable"):
        read_recording(path)


@pytest.mark.parametrize("content", [b"", b"time_s,a\n0,1\n", bytes(1000), b"\xff\xff\xff\xff\x10\0\0\0garbage"])
def test_a_file_that_is_no_recording_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other.hilrec"
    path.write_bytes(content)
    with pytest.raises(Failure, match="not a recording of hilplant"):
        read_recording(path)


def test_another_arrow_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.arrows"
    table = pa.table({"a": [1.0]})
    with pa.ipc.new_stream(path, table.schema) as stream:
        stream.write_table(table)
    with pytest.raises(Failure, match="not a recording of hilplant"):
        read_recording(path)


def test_a_missing_file_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(Failure, match="No such file"):
        read_recording(tmp_path / "nothing.hilrec")


def test_a_damaged_name_of_a_column_is_one_clear_error(record_run: Record) -> None:
    path = record_run()
    damaged = bytearray(path.read_bytes())
    damaged[damaged.index(b"out.terminal_v")] ^= 0x80
    path.write_bytes(damaged)
    with pytest.raises(Failure, match="a column's name is damaged"):
        read_recording(path)
