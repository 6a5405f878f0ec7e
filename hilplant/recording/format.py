"""What a recording looks like: an Arrow IPC stream, one row for each tick, and all it takes to repeat it.

Columns: ``tick``, ``deadline_ns``, ``in.<name>``, ``out.<name>``, ``status.<name>`` as in ``signals.py``, and
``frames``, the frames seen in that tick. Where a tick's row was lost but not its frames, all is null except
``tick`` and ``frames``. In the file the outputs are differences, see :mod:`hilplant.recording.differences`; a reader
gives them as float64. Each batch carries the plant's state before its first row, and a checksum of it and of its
values, so that damage does not pass for data.
"""

import base64
import zlib
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from hilplant.recording.differences import decode, encode
from hilplant.runtime.ring import BITRATE_SWITCH, ERROR, EXTENDED, FD, REMOTE, SENT
from hilplant.signals import INPUTS, OUTPUTS, STATUS

FORMAT_VERSION = "2"
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


def schema(metadata: dict[str, str] | None = None, stored: bool = False) -> pa.Schema:
    """Return the columns as they are read, or as they are `stored`, with `metadata` (keys without their prefix)."""
    output = pa.int64() if stored else pa.float64()
    fields = [
        pa.field("tick", pa.int64(), nullable=False),
        pa.field("deadline_ns", pa.int64()),
        *(pa.field(name, output if name in OUTPUT_COLUMNS else pa.float64()) for name in SIGNAL_COLUMNS),
        pa.field("frames", pa.list_(FRAME_TYPE), nullable=False),
    ]
    return pa.schema(fields, {KEY_PREFIX + key: value for key, value in (metadata or {}).items()})


def batch(rows: NDArray[np.float64], frames: NDArray[np.void]) -> pa.RecordBatch:
    """Join rows and frames of the ring by their tick, as they are stored; both are in the order of their ticks."""
    row_ticks = rows[:, 0].astype(np.int64)
    ticks = np.union1d(row_ticks, frames["tick"])
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
    bounds = np.append(np.searchsorted(frames["tick"], ticks), len(frames)).astype(np.int32)
    columns = schema(stored=True)
    arrays.append(pa.ListArray.from_arrays(pa.array(bounds), _frame_structs(frames), type=columns.field("frames").type))
    return pa.RecordBatch.from_arrays(arrays, schema=columns)


def read_batch(stored: pa.RecordBatch) -> pa.RecordBatch:
    """Return a batch as it is read: outputs as the numbers that they were."""
    arrays = {name: stored.column(name) for name in stored.schema.names}
    for name in OUTPUT_COLUMNS:
        there = arrays[name].is_valid().to_numpy(zero_copy_only=False)
        values = np.zeros(len(there))
        values[there] = decode(arrays[name].drop_null().to_numpy(zero_copy_only=False))
        arrays[name] = pa.array(values, mask=~there, from_pandas=False)
    return pa.RecordBatch.from_arrays(list(arrays.values()), schema=schema())


def state_text(state: NDArray[np.float64]) -> bytes:
    """Return a packed state as text: base64 of little-endian float64."""
    return base64.b64encode(np.ascontiguousarray(state, "<f8").tobytes())


def state_of(text: bytes) -> NDArray[np.float64]:
    """Return the packed state of a text."""
    return np.frombuffer(base64.b64decode(text), "<f8").astype(np.float64)


def _frame_structs(frames: NDArray[np.void]) -> pa.StructArray:
    lengths = frames["length"]
    within = np.arange(frames["data"].shape[1]) < lengths[:, np.newaxis]
    ends = np.concatenate([[0], np.cumsum(lengths, dtype=np.int32)]).astype(np.int32)
    payloads = np.ascontiguousarray(frames["data"][within])
    data = pa.BinaryArray.from_buffers(pa.binary(), len(frames), [None, pa.py_buffer(ends), pa.py_buffer(payloads)])
    flags = [pa.array((frames["flags"] & bit) != 0) for _, bit in _FLAGS]
    arrays = [pa.array(frames["time_ns"]), pa.array(frames["identifier"]), *flags, data]
    return pa.StructArray.from_arrays(arrays, fields=list(FRAME_TYPE))


def checksum(values: pa.RecordBatch, state: bytes = b"") -> bytes:
    """CRC-32 over a state's text and the values of a batch, whatever their layout in memory or on disk."""
    crc = zlib.crc32(state)
    for column in values.columns[:-1]:
        crc = zlib.crc32(column.is_null().to_numpy(zero_copy_only=False).tobytes(), crc)
        crc = zlib.crc32(column.fill_null(0).to_numpy(zero_copy_only=False).tobytes(), crc)
    frames = values.column("frames")
    crc = zlib.crc32(frames.value_lengths().to_numpy(zero_copy_only=False).tobytes(), crc)
    for part in frames.flatten().flatten():
        crc = zlib.crc32(_bytes(part), crc)
    return b"%08x" % crc


def _bytes(column: Any) -> bytes:
    if column.type == pa.binary():
        return b"".join(len(item).to_bytes() + item for item in column.to_pylist())
    plain: bytes = column.to_numpy(zero_copy_only=False).tobytes()
    return plain
