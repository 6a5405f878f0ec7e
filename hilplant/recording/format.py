"""What a recording looks like: an Arrow IPC stream, one row for each tick, and all it takes to repeat it.

Columns: ``tick``, ``deadline_ns``, ``in.<name>``, ``out.<name>``, ``status.<name>`` as in ``signals.py``, and
``frames``, the frames seen in that tick, and ``events``, what became of the commands that came beside the bus. Where a
tick's row was lost but not its frames and events, all is null except these and ``tick``. In the file the outputs are
differences, see :mod:`hilplant.recording.differences`; a reader gives them as float64. Each batch carries the plant's
state before its first row, and a checksum of it and of its values, so that damage does not pass for data.
"""

import base64
import zlib
from typing import Any

import numpy as np
import pyarrow as pa

from hilplant.arrays import Floats, Records
from hilplant.models.records import PARAMETER_INDEX
from hilplant.recording.differences import decode, encode
from hilplant.runtime.commands import COMMAND_DTYPE, KINDS, OUTCOMES, OWNERS, PARAMETER
from hilplant.runtime.frame_slot import BITRATE_SWITCH, ERROR, EXTENDED, FD, REMOTE, SENT
from hilplant.signals import INPUTS, OUTPUTS, STATUS

#: Formats that can be read, and how each stores an output: 1 as it is, 3 as differences.
OUTPUT_TYPES = {"1": pa.float64(), "3": pa.int64()}
KEY_PREFIX = "hilplant."
CHECKSUM_KEY = b"hilplant.crc32"
STATE_KEY = b"hilplant.state"
#: Of a last block without rows: how many rows and frames the recorder was too slow to take.
LOST_KEY = b"hilplant.lost"

INPUT_COLUMNS = tuple(f"in.{signal.name}" for signal in INPUTS)
OUTPUT_COLUMNS = tuple(f"out.{signal.name}" for signal in OUTPUTS)
STATUS_COLUMNS = tuple(f"status.{signal.name}" for signal in STATUS)
SIGNAL_COLUMNS = INPUT_COLUMNS + OUTPUT_COLUMNS + STATUS_COLUMNS
_OUTPUTS_AT = slice(len(INPUT_COLUMNS), len(INPUT_COLUMNS) + len(OUTPUT_COLUMNS))

_FLAGS = (
    ("sent", SENT),
    ("extended", EXTENDED),
    ("fd", FD),
    ("bitrate_switch", BITRATE_SWITCH),
    ("remote", REMOTE),
    ("error", ERROR),
)
FRAME_TYPE = pa.struct(
    [
        pa.field("time_ns", pa.int64(), nullable=False),
        pa.field("identifier", pa.uint32(), nullable=False),
        *(pa.field(name, pa.bool_(), nullable=False) for name, _ in _FLAGS),
        pa.field("data", pa.binary(), nullable=False),
    ]
)
EVENT_TYPE = pa.struct(
    [
        pa.field("time_ns", pa.int64(), nullable=False),
        pa.field("client", pa.uint32(), nullable=False),
        pa.field("number", pa.uint32(), nullable=False),
        pa.field("value", pa.float64(), nullable=False),
        *(pa.field(name, pa.string(), nullable=False) for name in ("kind", "name", "owner", "outcome", "text")),
    ]
)
_NO_EVENTS = np.empty(0, COMMAND_DTYPE)
_INPUT_NAMES, _PARAMETER_NAMES = tuple(signal.name for signal in INPUTS), tuple(PARAMETER_INDEX)


def schema(metadata: dict[str, str] | None = None, stored: bool = False) -> pa.Schema:
    """Return the columns as they are read, or as they are `stored`, with `metadata` (keys without their prefix)."""
    output = pa.int64() if stored else pa.float64()
    fields = [
        pa.field("tick", pa.int64(), nullable=False),
        pa.field("deadline_ns", pa.int64()),
        *(pa.field(name, output if name in OUTPUT_COLUMNS else pa.float64()) for name in SIGNAL_COLUMNS),
        pa.field("frames", pa.list_(FRAME_TYPE), nullable=False),
        pa.field("events", pa.list_(EVENT_TYPE), nullable=False),
    ]
    return pa.schema(fields, {KEY_PREFIX + key: value for key, value in (metadata or {}).items()})


def batch(rows: Floats, frames: Records, events: Records = _NO_EVENTS) -> pa.RecordBatch:
    """Join rows, frames and events of the ring by their tick, as they are stored; each is in the order of its ticks."""
    row_ticks = rows[:, 0].astype(np.int64)
    ticks = np.union1d(np.union1d(row_ticks, frames["tick"]), events["tick"])
    places = np.searchsorted(ticks, row_ticks)
    lost = np.ones(len(ticks), np.bool_)
    lost[places] = False
    deadlines = np.zeros(len(ticks), np.int64)
    deadlines[places] = rows[:, 1].astype(np.int64)
    values = np.zeros((len(SIGNAL_COLUMNS), len(ticks)), np.int64)
    values[:, places] = rows[:, 2 : 2 + len(SIGNAL_COLUMNS)].T.copy().view(np.int64)
    values[_OUTPUTS_AT, places] = encode(rows[:, 2 : 2 + len(SIGNAL_COLUMNS)][:, _OUTPUTS_AT]).T
    arrays = [pa.array(ticks), pa.array(deadlines, mask=lost)]
    for name, column in zip(SIGNAL_COLUMNS, values, strict=True):
        kept = column if name in OUTPUT_COLUMNS else column.view(np.float64)
        arrays.append(pa.array(kept, mask=lost, from_pandas=False))
    columns = schema(stored=True)
    for name, records, structs in (("frames", frames, _frame_structs), ("events", events, _event_structs)):
        bounds = np.append(np.searchsorted(records["tick"], ticks), len(records)).astype(np.int32)
        arrays.append(pa.ListArray.from_arrays(pa.array(bounds), structs(records), type=columns.field(name).type))
    return pa.RecordBatch.from_arrays(arrays, schema=columns)


def numbers(stored: pa.Array, kind: pa.DataType) -> pa.Array:
    """Return a column as it is read: what is stored as differences as the numbers that they were."""
    if stored.type == kind:
        return stored
    there = stored.is_valid().to_numpy(zero_copy_only=False)
    values = np.zeros(len(there))
    values[there] = decode(stored.drop_null().to_numpy(zero_copy_only=False))
    return pa.array(values, mask=~there, from_pandas=False)


def state_text(state: Floats) -> bytes:
    """Return a packed state as text: base64 of little-endian float64."""
    return base64.b64encode(np.ascontiguousarray(state, "<f8").tobytes())


def state_of(text: bytes) -> Floats:
    """Return the packed state of a text."""
    return np.frombuffer(base64.b64decode(text), "<f8").astype(np.float64)


def _frame_structs(frames: Records) -> pa.StructArray:
    lengths = frames["length"]
    within = np.arange(frames["data"].shape[1]) < lengths[:, np.newaxis]
    ends = np.concatenate([[0], np.cumsum(lengths, dtype=np.int32)]).astype(np.int32)
    payloads = np.ascontiguousarray(frames["data"][within])
    data = pa.BinaryArray.from_buffers(pa.binary(), len(frames), [None, pa.py_buffer(ends), pa.py_buffer(payloads)])
    flags = [pa.array((frames["flags"] & bit) != 0) for _, bit in _FLAGS]
    arrays = [pa.array(frames["time_ns"]), pa.array(frames["identifier"]), *flags, data]
    return pa.StructArray.from_arrays(arrays, fields=list(FRAME_TYPE))


def _event_structs(events: Records) -> pa.StructArray:
    texts = {"kind": [KINDS[kind] for kind in events["kind"]], "owner": [OWNERS[owner] for owner in events["owner"]]}
    texts["outcome"] = [OUTCOMES[outcome] for outcome in events["outcome"]]
    texts["name"] = [element_name(int(e["kind"]), int(e["element"])) for e in events]
    texts["text"] = [bytes(text).decode(errors="replace") for text in events["text"]]
    arrays = [
        pa.array(texts[field.name], pa.string()) if field.name in texts else pa.array(events[field.name].copy())
        for field in EVENT_TYPE
    ]
    return pa.StructArray.from_arrays(arrays, fields=list(EVENT_TYPE))


def element_name(kind: int, element: int) -> str:
    """Return the name of the input or the parameter that a command is about; nothing where it is about none."""
    names = _PARAMETER_NAMES if kind == PARAMETER else _INPUT_NAMES if kind < PARAMETER else ()
    return names[element] if 0 <= element < len(names) else ""


def parameter_changes(rows: pa.RecordBatch) -> list[tuple[int, int, float]]:
    """Return tick, index and value of each element of the parameter row that was changed."""
    events = rows.column("events")
    if not len(events.flatten()):
        return []
    return [
        (tick, PARAMETER_INDEX[event["name"]], event["value"])
        for tick, found in zip(rows.column("tick").to_pylist(), events.to_pylist(), strict=True)
        for event in found
        if event["kind"] == "parameter" and event["outcome"] == "applied"
    ]


def checksum(values: pa.RecordBatch, state: bytes = b"") -> bytes:
    """CRC-32 over a state's text and the values of a batch, whatever their layout in memory or on disk."""
    crc = zlib.crc32(state)
    for column in values.columns:
        if pa.types.is_list(column.type):
            crc = zlib.crc32(column.value_lengths().to_numpy(zero_copy_only=False).tobytes(), crc)
            for part in column.flatten().flatten():
                crc = zlib.crc32(_bytes(part), crc)
        else:
            crc = zlib.crc32(column.is_null().to_numpy(zero_copy_only=False).tobytes(), crc)
            crc = zlib.crc32(column.fill_null(0).to_numpy(zero_copy_only=False).tobytes(), crc)
    return b"%08x" % crc


def _bytes(column: Any) -> bytes:
    if column.type == pa.binary():
        return b"".join(len(item).to_bytes() + item for item in column.to_pylist())
    if column.type == pa.string():
        return b"".join(len(item).to_bytes(2) + item.encode() for item in column.to_pylist())
    plain: bytes = column.to_numpy(zero_copy_only=False).tobytes()
    return plain
