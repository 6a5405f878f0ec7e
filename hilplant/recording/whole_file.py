"""Files that are written whole or not at all: a failure, a full disk or Ctrl-C leaves what was there before."""

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Hand out a file ``NAME.part.ENDING`` to write, which takes the place of `path` at the end.

    When the body fails it is removed, and `path` stays as it was. A link goes on pointing where it did.

    Raises
    ------
    OSError
        When there is no such folder, or `path` cannot be replaced.
    """
    if not path.parent.is_dir():
        raise OSError(errno.ENOENT, f"there is no folder {path.parent}")
    real = path.resolve()
    passing = real.with_name(f"{real.stem}.part{real.suffix}")
    try:
        yield passing
        passing.replace(real)
    finally:
        passing.unlink(missing_ok=True)
