"""A replay repeats a run bit for bit, and names what was altered or is missing."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from hilplant.recording import replay as replay_module
from hilplant.recording.differences import encode
from hilplant.recording.format import schema
from hilplant.recording.metadata import current_build
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay

Record = Callable[..., Path]


def rewrite(path: Path, column: str, tick: int, change: Callable[[float], float], metadata: dict[str, str]) -> None:
    """Change one value and write the file anew, as someone with other tools would."""
    table = read_recording(path).table()
    with open(path, "rb") as file:
        kept = pa.ipc.open_stream(file).schema.metadata
    values = table.column(column).to_numpy().copy()
    values[tick] = change(values[tick])
    place = table.schema.get_field_index(column)
    table = table.set_column(place, schema().field(column), pa.array(values, from_pandas=False))
    for number, name in enumerate(table.schema.names):
        if name.startswith("out."):
            there = table.column(name).is_valid().to_numpy()
            stored = np.zeros(len(table), np.int64)
            stored[there] = encode(table.column(name).drop_null().to_numpy())
            table = table.set_column(number, pa.field(name, pa.int64()), pa.array(stored, mask=~there))
    described = kept | {f"hilplant.{key}".encode(): text.encode() for key, text in metadata.items()}
    with pa.ipc.new_stream(path, table.schema.with_metadata(described)) as stream:
        stream.write_table(table.combine_chunks())


@pytest.mark.parametrize("seed", [1, 2])
def test_an_untouched_recording_is_equal(record_run: Record, seed: int) -> None:
    result = replay(record_run(seed=seed))
    assert result.equal
    assert result.ticks == 1500
    assert "bit for bit" in str(result)


@pytest.mark.parametrize("tick", [0, 399, 400, 1234, 1499])
def test_one_changed_bit_of_one_output_is_named(record_run: Record, tick: int) -> None:
    path = record_run()
    rewrite(path, "out.crank_angle_rad", tick, lambda value: np.nextafter(value, 10.0), {})
    result = replay(path)
    assert not result.equal
    assert result.difference is not None
    assert (result.difference.tick, result.difference.signal) == (tick, "crank_angle_rad")
    assert result.difference.recorded == np.nextafter(result.difference.replayed, 10.0)
    assert result.ticks == tick
    assert "altered" in result.notes[0]


def test_a_zero_that_lost_its_sign_is_named(record_run: Record) -> None:
    path = record_run()
    zeros = read_recording(path).table().column("out.guard").to_numpy()
    assert not zeros.any()
    rewrite(path, "out.guard", 7, lambda value: -value, {})
    difference = replay(path).difference
    assert difference is not None
    assert (difference.tick, difference.signal) == (7, "guard")
    assert math.copysign(1.0, difference.recorded) == -1.0


def test_a_changed_input_shows_in_the_outputs_of_its_tick(record_run: Record) -> None:
    path = record_run()
    rewrite(path, "in.supply_v", 321, lambda value: value + 1e-9, {})
    difference = replay(path).difference
    assert difference is not None
    assert (difference.tick, difference.signal) == (321, "supply_v")


def test_another_build_is_named_as_the_likely_reason(record_run: Record, monkeypatch: pytest.MonkeyPatch) -> None:
    path = record_run()
    rewrite(path, "out.current_a", 9, lambda value: value + 1.0, {})
    here = current_build()
    monkeypatch.setattr(replay_module, "current_build", lambda: here | {"models_hash": "0123"})
    (note,) = replay(path).notes
    assert "another one: models_hash was" in note
    assert "is 0123" in note


def test_missing_ticks_are_named_and_the_blocks_behind_them_are_compared_again(record_run: Record) -> None:
    """Blocks of 400: ticks 0 to 699, then from the state of the block at 800 on to 1099, then from 1200 on."""
    result = replay(record_run(lose=frozenset({700, 701, 1100})))
    assert not result.equal
    assert result.ticks == 700 + 300 + 300
    assert result.missing == ((700, 701), (1100, 1100))
    assert "missing: ticks 700 to 701" in str(result)


def test_behind_a_gap_whose_block_tells_no_state_nothing_is_compared(record_run: Record) -> None:
    path = record_run(lose=frozenset({700}))
    rewrite(path, "in.supply_v", 3, lambda value: value, {})
    result = replay(path)
    assert (result.equal, result.ticks, result.missing) == (False, 700, ((700, 700),))


def test_the_first_ticks_may_be_missing_too(record_run: Record) -> None:
    result = replay(record_run(lose=frozenset(range(3))))
    assert (result.equal, result.ticks, result.missing) == (False, 1497, ((0, 2),))


def test_frames_after_the_last_row_do_not_make_a_recording_incomplete(record_run: Record) -> None:
    assert replay(record_run(lose=frozenset({1498, 1499}))).equal


def test_a_cut_recording_is_equal_as_far_as_it_goes(record_run: Record) -> None:
    path = record_run()
    path.write_bytes(path.read_bytes()[:-5000])
    result = replay(path)
    assert result.equal
    assert result.ticks == 1200
    assert "cut off" in result.notes[0]


def test_a_recording_without_ticks_is_not_called_equal(record_run: Record) -> None:
    result = replay(record_run(0))
    assert not result.equal
    assert str(result).startswith("empty")
