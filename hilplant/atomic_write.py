"""Files that are written whole or not at all: a failure, a full disk or Ctrl-C leaves what was there before."""

import errno
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hilplant.failure import Failure


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Hand out a new file beside `path`, of its ending, to write; it takes the place of `path` at the end.

    When the body fails it is removed, and `path` stays as it was. A link goes on pointing where it did; a device or a
    pipe is written as it is.

    Raises
    ------
    OSError
        When there is no such folder, or `path` cannot be replaced.
    """
    if not path.parent.is_dir():
        raise OSError(errno.ENOENT, f"there is no folder {path.parent}")
    real = path.resolve()
    if real.exists() and not real.is_file():
        yield real
        return
    file, name = tempfile.mkstemp(real.suffix, f".{real.stem}.part-", real.parent)
    os.close(file)
    passing = Path(name)
    try:
        passing.chmod(real.stat().st_mode & 0o777 if real.exists() else 0o666 & ~_umask())
        yield passing
        passing.replace(real)
    finally:
        passing.unlink(missing_ok=True)


def cannot_be_written(path: Path, error: OSError) -> Failure:
    """Return the one way to say that a file or folder cannot be written."""
    return Failure(f"{path}: cannot be written: {error.strerror or error}")


def make_folder(path: Path) -> Path:
    """Make a folder, and those above it, where there is none; return it.

    Raises
    ------
    Failure
        When it cannot be made.

    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise cannot_be_written(path, error) from error
    return path


def claim(path: Path | None) -> None:
    """Refuse a file that cannot be written, before something long begins; None is no file.

    What is in the file stays until it is replaced.

    Raises
    ------
    Failure
        When its folder is not there, or folder or file may not be written.

    """
    if path is None:
        return
    folder = path.resolve().parent
    if not folder.is_dir():
        raise cannot_be_written(path, OSError(errno.ENOENT, f"there is no folder {folder}"))
    if path.is_dir():
        raise cannot_be_written(path, OSError(errno.EISDIR, os.strerror(errno.EISDIR)))
    if not os.access(path if path.exists() else folder, os.W_OK):
        raise cannot_be_written(path, OSError(errno.EACCES, os.strerror(errno.EACCES)))


def _umask() -> int:
    mask = os.umask(0o077)
    os.umask(mask)
    return mask


def write_text(path: Path, text: str) -> None:
    """Write a text as it is, whole or not at all.

    Raises
    ------
    Failure
        When it cannot be written.

    """
    write_bytes(path, text.encode())


def write_bytes(path: Path, content: bytes) -> None:
    """Write bytes, whole or not at all.

    Raises
    ------
    Failure
        When it cannot be written.

    """
    try:
        with whole_file(path) as passing:
            passing.write_bytes(content)
    except OSError as error:
        raise cannot_be_written(path, error) from error
