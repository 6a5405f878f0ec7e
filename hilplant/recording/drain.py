"""The recorder's own process: takes rows and frames out of the ring and writes them to files.

Started by :mod:`hilplant.recording.recorder`, which hands over the metadata and the rotation as one line on standard
input and keeps that pipe open: its end means that the daemon has ended, in whatever way. Says ``ready`` or one line of
error on standard output.
"""

import contextlib
import json
import os
import select
import sys
import time
from pathlib import Path

from hilplant.recording.rotation import Rotation
from hilplant.recording.writer import RecordingWriter, late_description
from hilplant.runtime.ring import Ring
from hilplant.runtime.scheduling import stand_back

_LOOK_EVERY_S = 0.1
_WRITE_EVERY_S = 0.5
_SYNC_EVERY_S = 1.0


def record(ring: Ring, writer: RecordingWriter, lost_before: int) -> None:
    """Write until the daemon has closed the ring or has died, then what is left.

    What the ring has lost beyond `lost_before` is missing in this recording.

    Raises
    ------
    OSError
        When the file is no longer what it was, or the disk takes no more; the ring tells it then.
    """
    written_s = synced_s = time.monotonic()
    ended = False
    try:
        while not ended:
            ready, _, _ = select.select([sys.stdin], [], [], _LOOK_EVERY_S)
            ended = bool(ready) or ring.writer_closed
            writer.take(ring)
            writer.check()
            now_s = time.monotonic()
            if now_s - written_s >= _WRITE_EVERY_S - _LOOK_EVERY_S:
                writer.write()
                written_s = now_s
            if now_s - synced_s >= _SYNC_EVERY_S:
                writer.sync()
                synced_s = now_s
        ring.leave()
        writer.write(last=True)
        writer.close(ring.lost - lost_before)
    except OSError:
        ring.fail()
        writer.abandon()
        raise


def _of_now(ring: Ring, metadata: dict[str, str]) -> dict[str, str]:
    """Return the description of a recording that begins with the next row."""
    ring.skip_history()
    while not (ring.unread or ring.writer_closed):
        time.sleep(_LOOK_EVERY_S / 100)
    return late_description(metadata, ring)


def main(ring_name: str, path: str, loop_cpu: str) -> int:
    """Record the ring `ring_name` into the new file `path`, or into parts of that name."""
    stand_back(int(loop_cpu) if loop_cpu else None)
    order = json.loads(sys.stdin.readline())
    started = False
    try:
        with contextlib.closing(Ring.attach(ring_name)) as ring:
            rotation = Rotation.from_json(order["rotation"])
            lost_before = ring.lost  # before this process is the ring's reader: until then nothing is lost
            metadata = _of_now(ring, order["metadata"]) if order["late"] else order["metadata"]
            writer = RecordingWriter(Path(path), metadata, ring.row_width, rotation)
            writer.take(ring)
            started = _say_ready(writer)
            if started:
                record(ring, writer, lost_before)
    except OSError as error:
        cause = error.strerror or error
        if started:
            sys.stderr.write(f"{path}: the recording ends early: {cause}\n")
        else:
            sys.stdout.write(f"{path}: cannot record to this file: {cause}\n")
    else:
        return 0 if started else 1
    return 1


def _say_ready(writer: RecordingWriter) -> bool:
    """Tell the daemon; if it has ended before it could start its loop, leave no file in the way of the next one."""
    try:
        os.write(sys.stdout.fileno(), b"ready\n")
    except BrokenPipeError:
        writer.abandon()
        writer.path.unlink()
        return False
    return True


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
