"""What a recording looks like: an Arrow IPC stream, one row for each tick, and all it takes to repeat it.

Columns: ``tick``, ``deadline_ns``, ``in.<name>``, ``out.<name>``, ``status.<name>`` as in ``signals.py``, and
``frames``, the frames seen in that tick. Where a tick's row was lost but not its frames, all is null except
``tick`` and ``frames``. Each batch carries a checksum of its values, so damage does not pass for data.
"""

import zlib
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from hilplant.runtime.ring import BITRATE_SWITCH, ERROR, EXTENDED, FD, REMOTE, SENT
from hilplant.signals import INPUTS, OUTPUTS, STATUS

FORMAT_VERSION = "1"
KEY_PREFIX = "hilplant."
CHECKSUM_KEY = b"hilplant.crc32"

INPUT_COLUMNS = tuple(f"in.{signal.name}" for signal in INPUTS)
OUTPUT_COLUMNS = tuple(f"out.{signal.name}" for signal in OUTPUTS)
STATUS_COLUMNS = tuple(f"status.{signal.name}" for signal in STATUS)
SIGNAL_COLUMNS = INPUT_COLUMNS + OUTPUT_COLUMNS + STATUS_COLUMNS

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


def schema(metadata: dict[str, str]) -> pa.Schema:
    """Return the columns, with `metadata` (keys without their prefix) attached."""
    fields = [
        pa.field("tick", pa.int64(), nullable=False),
        pa.field("deadline_ns", pa.int64()),
        *(pa.field(name, pa.float64()) for name in SIGNAL_COLUMNS),
        pa.field("frames", pa.list_(FRAME_TYPE), nullable=False),
    ]
    return pa.schema(fields, {KEY_PREFIX + key: value for key, value in metadata.items()})


def batch(rows: NDArray[np.float64], frames: NDArray[np.void], columns: pa.Schema) -> pa.RecordBatch:
    """Join rows and frames of the ring by their tick; both are in the order of their ticks."""
    row_ticks = rows[:, 0].astype(np.int64)
    ticks = np.union1d(row_ticks, frames["tick"])
    places = np.searchsorted(ticks, row_ticks)
    lost = np.ones(len(ticks), np.bool_)
    lost[places] = False
    spread = np.full((rows.shape[1], len(ticks)), np.nan)
    spread[:, places] = rows.T
    deadlines = np.zeros(len(ticks), np.int64)
    deadlines[places] = rows[:, 1].astype(np.int64)
    arrays = [pa.array(ticks), pa.array(deadlines, mask=lost)]
    arrays += [pa.array(values, mask=lost, from_pandas=False) for values in spread[2:]]
    bounds = np.append(np.searchsorted(frames["tick"], ticks), len(frames)).astype(np.int32)
    arrays.append(pa.ListArray.from_arrays(pa.array(bounds), _frame_structs(frames), type=columns.field("frames").type))
    return pa.RecordBatch.from_arrays(arrays, schema=columns)


def _frame_structs(frames: NDArray[np.void]) -> pa.StructArray:
    lengths = frames["length"]
    within = np.arange(frames["data"].shape[1]) < lengths[:, np.newaxis]
    ends = np.concatenate([[0], np.cumsum(lengths, dtype=np.int32)]).astype(np.int32)
    payloads = np.ascontiguousarray(frames["data"][within])
    data = pa.BinaryArray.from_buffers(pa.binary(), len(frames), [None, pa.py_buffer(ends), pa.py_buffer(payloads)])
    flags = [pa.array((frames["flags"] & bit) != 0) for _, bit in _FLAGS]
    arrays = [pa.array(frames["time_ns"]), pa.array(frames["identifier"]), *flags, data]
    return pa.StructArray.from_arrays(arrays, fields=list(FRAME_TYPE))


def checksum(values: pa.RecordBatch) -> bytes:
    """CRC-32 over the values of a batch, whatever their layout in memory or on disk."""
    crc = 0
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
