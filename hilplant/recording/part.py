"""One file of a recording, written block by block and watched: that it is still there, and still what was written."""

import contextlib
import fcntl
import io
import os
from pathlib import Path

import pyarrow as pa

from hilplant.recording.format import schema


class PartLost(OSError):
    """The file of a recording was removed, moved, cut or unmounted while it was written."""


class Part:
    """An Arrow stream in a new file that its owner alone may read: it holds the texts of the bench's databases.

    Blocks are put at the end of the file wherever that is, so that a file which somebody has cut stays shorter than
    what was written, and is noticed.
    """

    def __init__(self, path: Path, metadata: dict[str, str]) -> None:
        """Write the schema, and a block without rows: a recording from the start.

        Raises
        ------
        OSError
            When there is such a file already, or no room for the schema; no file is left then.
        """
        self.path = path
        self.written = 0
        self.blocks = 0
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_APPEND | os.O_CLOEXEC, 0o600)
        with contextlib.suppress(OSError):  # not every file system has locks
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # against `rotation.remove_part` of another run
        self._sink = io.BytesIO()
        options = pa.ipc.IpcWriteOptions(compression="zstd")
        try:
            columns = schema(metadata, stored=True)
            self._stream = pa.ipc.new_stream(self._sink, columns, options=options)
            self._stream.write_batch(pa.RecordBatch.from_pylist([], schema=columns))
            self._put(self._taken())
            self._sync_folder()
        except OSError:
            os.close(self._file)
            path.unlink()
            raise

    def block(self, values: pa.RecordBatch, metadata: dict[bytes, bytes]) -> bytes:
        """Return the bytes of a block, to be appended."""
        self._stream.write_batch(values, custom_metadata=metadata)
        return self._taken()

    def append(self, block: bytes) -> None:
        """Write a block.

        Raises
        ------
        PartLost
            When the file is not what it was.
        OSError
            When the disk does not take it.
        """
        self.check()
        self._put(block)
        self.blocks += 1

    def check(self) -> None:
        """Raise PartLost unless the file is where it was, and as long as it was written."""
        held = os.fstat(self._file)
        if held.st_nlink == 0:
            raise PartLost("the file was removed while it was recorded to")
        if held.st_size != self.written:
            raise PartLost(f"the file was changed: it has {held.st_size} bytes, {self.written} were written")
        try:
            found = os.stat(self.path)
        except OSError as error:
            raise PartLost(f"the file was moved or its disk unmounted: {error.strerror}") from error
        if (found.st_dev, found.st_ino) != (held.st_dev, held.st_ino):
            raise PartLost("the file was moved or its disk unmounted: another one has its name")

    def sync(self) -> None:
        """Ask the disk to keep what was written."""
        os.fsync(self._file)

    def close(self) -> None:
        """End the stream, and see that all of it is there; a failure is a PartLost or another OSError."""
        try:
            self.check()
            self._stream.close()
            self._put(self._taken())
            self.sync()
            self.check()
        finally:
            os.close(self._file)

    def abandon(self) -> None:
        """End the stream as far as that is possible: what was written before may still be worth something."""
        with contextlib.suppress(OSError):
            self.close()

    def _put(self, block: bytes) -> None:
        left = memoryview(block)
        while left:
            count = os.write(self._file, left)
            self.written += count
            left = left[count:]

    def _taken(self) -> bytes:
        taken = self._sink.getvalue()
        self._sink.seek(0)
        self._sink.truncate()
        return taken

    def _sync_folder(self) -> None:
        folder = os.open(self.path.parent, os.O_RDONLY | os.O_CLOEXEC)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
