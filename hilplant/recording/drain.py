"""The recorder's own process: takes rows and frames out of the ring and writes them to one file.

Started by :mod:`hilplant.recording.recorder`, which hands over the metadata as one line on standard input and
keeps that pipe open: its end means that the daemon has ended, in whatever way. Says ``ready`` or one line of
error on standard output.
"""

import contextlib
import json
import os
import select
import signal
import sys
import time
from typing import BinaryIO

import numpy as np
import pyarrow as pa

from hilplant.recording.format import CHECKSUM_KEY, batch, checksum, schema
from hilplant.runtime.ring import FRAME_DTYPE, Ring

_LOOK_EVERY_S = 0.1
_WRITE_EVERY_S = 0.5
_SYNC_EVERY_S = 1.0


class RecordingWriter:
    """Writes what the ring gives as batches of an Arrow stream."""

    def __init__(self, file: BinaryIO, metadata: dict[str, str], row_width: int) -> None:
        """Write the schema and a block without rows, so that the file is a recording from the start."""
        self._file = file
        self._schema = schema(metadata)
        options = pa.ipc.IpcWriteOptions(compression="zstd")
        self._stream = pa.ipc.new_stream(file, self._schema, options=options)
        self._rows = [np.empty((0, row_width))]
        self._frames = [np.empty(0, FRAME_DTYPE)]
        self._stream.write_batch(batch(self._rows[0], self._frames[0], self._schema))
        file.flush()

    def take(self, ring: Ring) -> None:
        """Take what is in the ring: the rows first, so that all frames of these rows are there."""
        self._rows.append(ring.read_rows())
        self._frames.append(ring.read_frames())

    def write(self, last: bool = False) -> None:
        """Write what was taken; frames of a tick whose row is still to come wait, unless it never will."""
        rows, frames = np.concatenate(self._rows), np.concatenate(self._frames)
        whole = len(frames)
        if not last:
            newest = rows[-1, 0] if len(rows) else -np.inf
            whole = int(np.searchsorted(frames["tick"], newest, side="right"))
        if len(rows) or whole:
            values = batch(rows, frames[:whole], self._schema)
            self._stream.write_batch(values, custom_metadata={CHECKSUM_KEY: checksum(values)})
            self._file.flush()
        self._rows, self._frames = [rows[:0]], [frames[whole:]]

    def close(self) -> None:
        """End the stream."""
        self._stream.close()
        self._file.flush()
        os.fsync(self._file.fileno())


def record(ring: Ring, writer: RecordingWriter, file: BinaryIO) -> None:
    """Write until the daemon has closed the ring or has died, then what is left."""
    written_s = synced_s = time.monotonic()
    ended = False
    while not ended:
        ready, _, _ = select.select([sys.stdin], [], [], _LOOK_EVERY_S)
        ended = bool(ready) or ring.writer_closed
        writer.take(ring)
        now_s = time.monotonic()
        if now_s - written_s >= _WRITE_EVERY_S - _LOOK_EVERY_S:
            writer.write()
            written_s = now_s
        if now_s - synced_s >= _SYNC_EVERY_S:
            os.fsync(file.fileno())
            synced_s = now_s
    writer.write(last=True)
    writer.close()


def _step_aside(loop_cpu: int | None) -> None:
    """Leave the signals of the terminal, the loop's priority and the loop's CPU to the daemon."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_IGN)
    with contextlib.suppress(OSError, AttributeError):  # only Linux has them all
        os.nice(5)
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        if others := os.sched_getaffinity(0) - {loop_cpu}:
            os.sched_setaffinity(0, others)


def main(ring_name: str, path: str, loop_cpu: str) -> int:
    """Record the ring `ring_name` into the new file `path`."""
    _step_aside(int(loop_cpu) if loop_cpu else None)
    metadata = json.loads(sys.stdin.readline())
    started = False
    try:
        with contextlib.closing(Ring.attach(ring_name)) as ring, open(path, "xb") as file:
            writer = RecordingWriter(file, metadata, ring.row_width)
            writer.take(ring)
            os.write(sys.stdout.fileno(), b"ready\n")
            started = True
            record(ring, writer, file)
    except BrokenPipeError:  # the daemon ended before it could start its loop
        os.unlink(path)
        return 1
    except OSError as error:
        cause = error.strerror or error
        if started:
            print(f"{path}: the recording ends early: {cause}", file=sys.stderr, flush=True)
        else:
            print(f"{path}: cannot record to this file: {cause}", flush=True)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
