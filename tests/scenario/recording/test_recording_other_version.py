"""Recordings of an older and of a later version: replayed where that is right, else refused by the element's name."""

import json
import lzma
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from numpy.typing import NDArray

from hilplant.failure import Failure
from hilplant.models.records import PARAMETER_INDEX
from hilplant.recording import metadata as metadata_module
from hilplant.recording.export import export
from hilplant.recording.format import CHECKSUM_KEY, STATE_KEY, checksum, state_of, state_text
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.signals import OUTPUTS

FORMAT_1 = Path(__file__).parents[2] / "data" / "recordings" / "format_1.hilrec.xz"
Record = Callable[..., Path]
Texts = dict[str, str]


@pytest.fixture
def format_1(tmp_path: Path) -> Path:
    """The first second of the demonstration, as it was recorded by the last version that wrote format 1."""
    path = tmp_path / "format_1.hilrec"
    path.write_bytes(lzma.decompress(FORMAT_1.read_bytes()))
    return path


@dataclass
class Version:
    """How another version would have written a recording."""

    order: int = 0  # seed of the order of the elements
    beyond: dict[str, tuple[float, float]] = field(default_factory=dict)  # parameter that it has: value and default
    inputs: dict[str, tuple[float, float]] = field(default_factory=dict)  # the same of inputs
    lacks: tuple[str, ...] = ()  # columns
    format: str = "3"

    def write(self, path: Path) -> None:
        """Write the recording `path` anew."""
        with open(path, "rb") as file:
            stream = pa.ipc.open_stream(file)
            found = stream.schema
            blocks = list(stream.iter_batches_with_custom_metadata())
        names = {key.decode().removeprefix("hilplant."): text.decode() for key, text in found.metadata.items()}
        described = {f"hilplant.{key}": text for key, text in self._texts(names).items()}
        written = [self._block(block.batch, dict(block.custom_metadata or {})) for block in blocks]
        with pa.ipc.new_stream(path, written[0][0].schema.with_metadata(described)) as out:
            for rows, metadata in written:
                out.write_batch(rows, custom_metadata=metadata)

    def _texts(self, texts: Texts) -> Texts:
        elements = json.loads(texts["elements"])
        beyond = {name: value for name, (value, _) in self.beyond.items()}
        row = metadata_module._decode(texts["parameter_row"])
        values = dict(zip(elements["parameter_row"], row, strict=True)) | beyond
        elements["parameter_row"] |= {name: default for name, (_, default) in self.beyond.items()}
        parameters = self._shuffled(list(values))
        state = metadata_module._decode(texts["state_row"])
        elements["parameter_row"] = {name: elements["parameter_row"][name] for name in parameters}
        elements["state_row"] = dict(self._shuffled(list(elements["state_row"].items())))
        elements["inputs"] |= {name: default for name, (_, default) in self.inputs.items()}
        for lacked in self.lacks:
            kind, _, name = lacked.partition(".")
            elements[{"in": "inputs", "out": "outputs"}.get(kind, kind)].pop(name)
        changed = {
            "format": self.format,
            "parameter_row": metadata_module._encode(np.array([values[name] for name in parameters])),
            "state_row": metadata_module._encode(self._state(state)),
            "elements": json.dumps(elements),
        }
        texts = {key: text for key, text in (texts | changed).items() if key != "crc32"}
        return texts | {"crc32": metadata_module._checksum(texts)}

    def _block(self, rows: pa.RecordBatch, metadata: dict[bytes, bytes]) -> tuple[pa.RecordBatch, dict[bytes, bytes]]:
        columns = {name: rows.column(name) for name in rows.schema.names if name not in self.lacks}
        for name, (value, _) in self.inputs.items():
            columns = {"tick": columns["tick"], f"in.{name}": pa.array(np.full(len(rows), value)), **columns}
        rows = pa.RecordBatch.from_pydict(columns)
        state = metadata.get(STATE_KEY, b"")
        if state:
            state = state_text(self._state(state_of(state)))
            metadata[STATE_KEY] = state
        return rows, metadata | {CHECKSUM_KEY: checksum(rows, state)}

    def _state(self, row: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array(self._shuffled(row.tolist()))

    def _shuffled(self, items: list[Any]) -> list[Any]:
        return [items[place] for place in np.random.default_rng(self.order).permutation(len(items))]


def test_a_recording_of_format_1_replays_bit_for_bit_in_the_outputs_that_it_has(format_1: Path) -> None:
    result = replay(format_1)
    assert result.equal, str(result)
    assert result.ticks > 800 and result.outputs == 25
    (note,) = result.notes
    assert note.startswith("not compared, as the recording has them not: supply_current_a, measured_current_a")
    assert len(note.partition(": ")[2].split(", ")) == len(OUTPUTS) - 25
    table = read_recording(format_1).table()
    assert table.column("out.motor_speed_rad_s").to_numpy().max() > 50.0  # it moves
    assert table.column("out.measured_current_a").null_count == len(table)


def test_an_export_leaves_out_what_the_recording_has_not_and_says_so(format_1: Path, tmp_path: Path) -> None:
    said = export(format_1, tmp_path / "old.csv")
    assert "the recording has no out.supply_current_a, out.measured_current_a" in said and "status.recording" in said
    head = (tmp_path / "old.csv").read_text().partition("\n")[0].split(",")
    assert "current_a" in head and "status_mode" in head
    assert "supply_current_a" not in head and "status_recording" not in head
    assert f"of {len(head) - 1} signals" in said


@pytest.mark.parametrize("order", [1, 2])
def test_the_order_of_elements_and_what_changes_nothing_do_not_matter(record_run: Record, order: int) -> None:
    path = record_run(lose=frozenset({700}))
    before = replay(path)
    Version(
        order,
        {"tank.volume_m3": (0.25, 0.25)},
        {"drag_n_m": (0.5, 0.5)},
        ("out.guard", "in.left_wear", "status.overruns"),
    ).write(path)
    after = replay(path)
    assert after.missing == before.missing == ((700, 700),)
    assert after.difference is None
    assert (after.ticks, after.outputs) == (before.ticks, before.outputs - 1)
    assert after.notes == ("not compared, as the recording has them not: guard",)


@pytest.mark.parametrize(
    ("version", "words"),
    [
        (Version(1, {"tank.volume_m3": (0.5, 0.25)}), r"tank\.volume_m3 is 0\.5, and this version has no such element"),
        (
            Version(1, inputs={"drag_n_m": (0.5, 0.0)}),
            r"block \d: input drag_n_m is 0\.5, and this version has no such",
        ),
        (Version(format="9"), "has format 9, this version reads the formats 1, 3"),
        (Version(format="1"), "column out.supply_v is not as"),
    ],
)
def test_what_cannot_be_repeated_is_refused_by_name(record_run: Record, version: Version, words: str) -> None:
    path = record_run(400)
    version.write(path)
    with pytest.raises(Failure, match=words):
        replay(path)


@pytest.mark.parametrize(
    ("name", "damaged"),
    [
        (b"out.current_a", b"out.durrent_a"),
        (b"in.screen", b"in.sdreen"),
        (b"status.overruns", b"status.overrunz"),
        (b"status.overruns", b"ztatus.overruns"),
        (b"frames", b"framez"),
    ],
)
def test_a_damaged_name_of_a_column_does_not_pass_for_another_version(
    record_run: Record, name: bytes, damaged: bytes
) -> None:
    path = record_run(400)
    whole = path.read_bytes()
    assert whole.count(name) == 1
    path.write_bytes(whole.replace(name, damaged))
    with pytest.raises(Failure, match=r"damaged: columns|no column frames|not know its column ztatus"):
        read_recording(path)


def test_a_damaged_name_of_a_column_of_format_1_is_refused_too(format_1: Path) -> None:
    format_1.write_bytes(format_1.read_bytes().replace(b"out.current_a", b"out.durrent_a"))
    with pytest.raises(Failure, match=r"damaged: columns and description do not agree about out\.durrent_a"):
        read_recording(format_1)


def test_another_value_of_a_known_parameter_is_taken_by_its_name(record_run: Record) -> None:
    path = record_run(400, seed=2)  # whose motor runs slowly from the start
    Version(3, {"motor.slow.resistance_ohm": (0.61, 0.0)}).write(path)
    result = replay(path)
    assert result.difference is not None and not result.equal
    assert read_recording(path).run.parameter_row[PARAMETER_INDEX["motor.slow.resistance_ohm"]] == 0.61
