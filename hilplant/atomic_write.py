"""Files that are written whole or not at all: a failure, a full disk or Ctrl-C leaves what was there before."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hilplant.failure import Failure


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Hand out a file ``NAME.part.ENDING`` to write, which takes the place of `path` at the end.

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
    passing = real.with_name(f"{real.stem}.part{real.suffix}")
    try:
        yield passing
        passing.replace(real)
    finally:
        passing.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text as it is, whole or not at all.

    Raises
    ------
    Failure
        When it cannot be written.

    """
    try:
        with whole_file(path) as passing:
            passing.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise Failure(f"{path}: cannot be written ({error.strerror})") from error
