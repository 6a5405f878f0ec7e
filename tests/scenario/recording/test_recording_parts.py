"""A recording in parts: each replays on its own, together they are the run, and a stretch of it can be exported."""

from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import can
import numpy as np
import pytest
from pyarrow import parquet

from hilplant.failure import Failure
from hilplant.recording.differences import decode, encode
from hilplant.recording.export import export
from hilplant.recording.metadata import describe
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.recording.rotation import Rotation, parts_of
from hilplant.recording.span import Span, begin_of
from hilplant.recording.writer import RecordingWriter
from hilplant.runtime.frame_slot import FRAME_DTYPE

Record = Callable[..., Path]


def test_parts_by_time_end_exactly_and_each_replays_on_its_own(record_run: Record) -> None:
    path = record_run(10_500, block=437, rotation=Rotation(part_ns=2_000_000_000))
    assert not path.exists()
    parts = parts_of(path)
    assert [part.name for part in parts] == [f"run-1-000{number}.hilrec" for number in range(1, 7)]
    for number, part in enumerate(parts):
        ticks = read_recording(part).table(["tick"]).column("tick").to_pylist()
        assert ticks == list(range(2000 * number, min(2000 * number + 2000, 10_500)))
        result = replay(part)
        assert (result.equal, result.ticks) == (True, len(ticks))


def test_parts_by_size_stay_below_it_and_together_are_the_run(record_run: Record, tmp_path: Path) -> None:
    whole = record_run(30_000, block=500, seed=2)
    one = read_recording(whole).table()
    limit = 300_000
    path = record_run(30_000, block=500, rotation=Rotation(part_bytes=limit), seed=2)
    path_parts = parts_of(path)
    assert len(path_parts) > 3
    assert all(part.stat().st_size <= limit + 100 for part in path_parts)
    assert read_recording(path).table().equals(one)
    assert str(replay(path)).startswith("equal: all")
    assert "30000 ticks" in export(path, tmp_path / "all.parquet")


def test_only_the_newest_parts_are_kept_and_they_replay_together(record_run: Record) -> None:
    path = record_run(9000, block=500, rotation=Rotation(part_ns=1_000_000_000, keep=3))
    assert [part.stem[-4:] for part in parts_of(path)] == ["0007", "0008", "0009"]
    result = replay(path)
    assert (result.equal, result.ticks) == (True, 3000)


def test_a_day_in_parts_of_an_hour_keeps_the_last_ones_to_the_tick(tmp_path: Path, bench: Any, row_width: int) -> None:
    """Ticks of ten seconds in blocks that do not end with the hours; from 10:59:30 on nothing was due for a minute."""
    due_s = np.array([second for second in range(0, 86_400, 10) if not 39_570 <= second < 39_630])
    rows = np.zeros((len(due_s), row_width))
    rows[:, 0], rows[:, 1] = np.arange(len(due_s)), due_s * 1e9
    path = tmp_path / "day.hilrec"
    rotation = Rotation.parse("1h", keep=14)
    writer = RecordingWriter(path, describe(bench, datetime.now(UTC)), row_width, rotation)
    for begin in range(0, len(rows), 110):
        writer.add(rows[begin : begin + 110], np.empty(0, FRAME_DTYPE))
        writer.write(last=begin + 110 >= len(rows))
    writer.close()
    parts = parts_of(path)
    assert [int(part.stem[-4:]) for part in parts] == list(range(11, 25))
    found = [read_recording(part).table(["deadline_ns"]).column(0).to_numpy() / 1e9 for part in parts]
    hours = [36_000, *(39_630 + 3600 * number for number in range(13))]  # each from the first tick of its part
    assert [seconds[0] for seconds in found] == hours
    assert np.concatenate(found).tolist() == due_s[due_s >= 36_000].tolist()


def test_a_part_that_is_missing_is_a_gap_and_parts_of_two_runs_are_refused(record_run: Record) -> None:
    path = record_run(3000, rotation=Rotation(part_ns=1_000_000_000))
    first, second, third = parts_of(path)
    content = second.read_bytes()
    second.unlink()
    result = replay(path)
    assert (result.equal, result.ticks, result.missing) == (False, 2000, ((1000, 1999),))
    other = record_run(3000, rotation=Rotation(part_ns=1_000_000_000), seed=5)
    second.write_bytes(parts_of(other)[1].read_bytes())
    with pytest.raises(Failure, match=f"{second}: is of another run than {first}"):
        replay(path)
    second.write_bytes(content)
    assert replay(path).ticks == 3000
    assert third.exists()


@pytest.mark.parametrize(("from_s", "to_s"), [(0.0, 0.25), (0.3995, 0.801), (0.7, np.inf), (1.2, 1.2005)])
def test_a_stretch_is_cut_by_the_time_at_which_ticks_were_due(
    record_run: Record, tmp_path: Path, from_s: float, to_s: float
) -> None:
    """From tick 900 on five periods are missing: what was due at 1.2 s is tick 1195."""
    path = record_run(1500, late_from=900, lose=frozenset({750}))
    due_s = np.array([(tick + 5 * (tick >= 900)) / 1000 for tick in range(1500) if tick != 750])
    kept = due_s[(due_s >= from_s) & (due_s < to_s)]
    export(path, tmp_path / "o.parquet", Span(from_s, to_s))
    assert parquet.read_table(tmp_path / "o.parquet").column("deadline_s").to_numpy().tolist() == kept.tolist()
    export(path, tmp_path / "o.blf", Span(from_s, to_s))
    frames = len(kept) + (from_s <= 0.75 < to_s)  # the frame of the lost row is there
    assert len(list(can.LogReader(tmp_path / "o.blf"))) == frames


def test_a_stretch_of_parts_reads_no_part_outside_of_it(record_run: Record, tmp_path: Path) -> None:
    path = record_run(5000, rotation=Rotation(part_ns=1_000_000_000))
    damaged = bytearray(parts_of(path)[0].read_bytes())
    damaged[len(damaged) - 3000] ^= 0x55
    parts_of(path)[0].write_bytes(damaged)
    assert "1500 ticks" in export(path, tmp_path / "o.csv", Span(2.5, 4.0))
    with pytest.raises(Failure, match="damaged"):
        export(path, tmp_path / "o.csv", Span(0.5, 4.0))


@pytest.mark.parametrize("to_s", [1.0, 1.234, 3.9])
def test_a_stretch_of_one_file_reads_no_block_behind_it(record_run: Record, tmp_path: Path, to_s: float) -> None:
    path = record_run(5000, block=437)
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) - 3000] ^= 0x55
    path.write_bytes(damaged)
    kept = [len(rows) for rows in read_recording(path).within(Span(0.5, to_s)).batches()]
    assert kept.count(0) <= 1, "but for the first one, none without rows is given: an hour of them takes memory"
    assert f"{round((to_s - 0.5) * 1000)} ticks" in export(path, tmp_path / "o.csv", Span(0.5, to_s))
    with pytest.raises(Failure, match="damaged"):
        export(path, tmp_path / "o.csv", Span(0.5, 4.99))


def test_a_stretch_of_one_file_decodes_no_block_before_it(record_run: Record, tmp_path: Path) -> None:
    path = record_run(900, block=131)
    whole = read_recording(path).table(["tick"]).column("tick").to_numpy()
    damaged = bytearray(path.read_bytes())
    with path.open("rb") as file:
        damaged[begin_of(file, Span(0.131))[0] - 300] ^= 0x55  # in the values of the first block of rows
    path.write_bytes(damaged)
    for from_s in (0.131, 0.2, 0.524, 0.8994):
        kept = read_recording(path).within(Span(from_s)).table(["tick"]).column("tick").to_numpy()
        assert kept.tolist() == whole[whole >= from_s * 1000.0].tolist()
    assert "700 ticks" in export(path, tmp_path / "o.csv", Span(0.2))
    with pytest.raises(Failure, match="damaged in block 1:"):
        export(path, tmp_path / "o.csv", Span(0.13))


def test_damage_in_a_stretch_is_named_by_its_block_wherever_reading_began(record_run: Record) -> None:
    """Block 0 has no rows; block 7, the last one, is damaged."""
    path = record_run(900, block=131)
    damaged = bytearray(path.read_bytes())
    damaged[len(damaged) - 300] ^= 0x55
    path.write_bytes(damaged)
    for from_s in (0.0, 0.1, 0.131, 0.5, 0.899):
        with pytest.raises(Failure, match="damaged in block 7:"):
            read_recording(path).within(Span(from_s)).table()


def test_a_stretch_of_a_cut_file_ends_with_its_last_whole_block(record_run: Record) -> None:
    path = record_run(900, block=131, lose=frozenset(range(262, 393)))  # the rows of a whole block are lost
    content = path.read_bytes()
    with path.open("rb") as file:
        rows_at = begin_of(file, Span(0.131))[0]
    for share in (0.5, 0.7, 0.97):
        path.write_bytes(content[: rows_at + round((len(content) - rows_at) * share)])
        whole = read_recording(path).table(["tick"]).column("tick").to_numpy()
        recording = read_recording(path).within(Span(0.3))
        assert recording.table(["tick"]).column("tick").to_numpy().tolist() == whole[whole >= 300].tolist()
        assert "cut off" in recording.notes[0]


def test_an_empty_stretch_is_refused(record_run: Record, tmp_path: Path) -> None:
    with pytest.raises(Failure, match="a range goes from a time to a later one"):
        export(record_run(10), tmp_path / "o.csv", Span(2.0, 2.0))


@pytest.mark.parametrize(
    ("text", "made"),
    [
        ("100MB", Rotation(100_000_000)),
        ("1.5 h", Rotation(0, 5_400_000_000_000)),
        ("2gb,30min", Rotation(2_000_000_000, 1_800_000_000_000)),
        ("1d", Rotation(0, 86_400_000_000_000)),
    ],
)
def test_limits_are_read(text: str, made: Rotation) -> None:
    assert Rotation.parse(text) == made


@pytest.mark.parametrize("text", ["", "100", "MB", "5 parsecs", "1h;2h", "0s", "10kB", "-1h", "nan h"])
def test_limits_that_make_no_sense_are_refused_in_one_line(text: str) -> None:
    with pytest.raises(Failure, match="rotate: ") as caught:
        Rotation.parse(text)
    assert "\n" not in str(caught.value)


def test_any_64_bits_come_back_from_differences() -> None:
    source = np.random.default_rng(7)
    bits: Any = source.integers(-(2**63), 2**63 - 1, (1000, 3), dtype=np.int64)
    bits[::7, 0] = np.array([np.nan, -0.0, np.inf, 5e-324]).view(np.int64)[source.integers(0, 4, len(bits[::7]))]
    values = bits.view(np.float64)
    assert decode(encode(values)).tobytes() == values.tobytes()
    for short in range(6):
        assert decode(encode(values[:short])).tobytes() == values[:short].tobytes()
