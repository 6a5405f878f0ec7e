"""Memory that several processes share, and that goes when the last of them goes, however it ends.

It is a file in /dev/shm under a shared ``flock`` of all who use it. Who closes it last removes it; what is left when
the last one was killed is removed by the next :meth:`SharedMemory.create`. The shared memory of ``multiprocessing``
would be removed by the helper process of whichever user ends first.
"""

import contextlib
import fcntl
import mmap
import os
import secrets
import tempfile
import weakref
from pathlib import Path

from hilplant.failure import Failure

_PREFIX = "hilplant-ring-"


def _reserve(file: int, size: int) -> None:
    """Give a file its size, and on Linux its memory too: a full folder is an error now, not a fault later."""
    if hasattr(os, "posix_fallocate"):
        os.posix_fallocate(file, 0, size)
    else:
        os.ftruncate(file, size)


class SharedMemory:
    """A block of bytes, zero at first, known to other processes by its name."""

    def __init__(self, path: Path, file: int) -> None:
        """Map an open file; use :meth:`create` or :meth:`attach`."""
        self._let_go = weakref.finalize(self, _let_go, file, path)  # also at the end of the program
        fcntl.flock(file, fcntl.LOCK_SH)
        self.name = path.name
        self.bytes = mmap.mmap(file, 0)

    @classmethod
    def create(cls, size: int) -> "SharedMemory":
        """Make a block of `size` bytes.

        Raises
        ------
        Failure
            When there is no room for it: a fatal signal in the loop otherwise, at the first touch of a page.
        """
        _remove_abandoned()
        path = _folder() / f"{_PREFIX}{os.getpid()}-{secrets.token_hex(4)}"
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
            try:
                _reserve(file, size)
            except OSError:
                path.unlink()
                os.close(file)
                raise
        except OSError as error:
            need = f"{path.parent} has no room for {size / 1e6:.0f} MB of shared memory"
            raise Failure(
                f"{need} ({error.strerror}); make it larger: mount -o remount,size=256m {path.parent}"
            ) from error
        return cls(path, file)

    @classmethod
    def attach(cls, name: str) -> "SharedMemory":
        """Open the block `name` of another process; FileNotFoundError when it is gone."""
        path = _folder() / name
        return cls(path, os.open(path, os.O_RDWR))

    def close(self) -> None:
        """Let go of the block; the last one to do so removes it. Views of its bytes stay valid."""
        self._let_go()


def names() -> list[str]:
    """Return the names of all blocks that there are."""
    return sorted(path.name for path in _folder().glob(f"{_PREFIX}*"))


def _folder() -> Path:
    shared = Path("/dev/shm")
    return shared if os.access(shared, os.W_OK) else Path(tempfile.gettempdir())


def _let_go(file: int, path: Path) -> None:
    _remove_if_unused(file, path)
    fcntl.flock(file, fcntl.LOCK_UN)
    os.close(file)


def _remove_if_unused(file: int, path: Path) -> None:
    with contextlib.suppress(OSError):
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        path.unlink(missing_ok=True)


def _remove_abandoned() -> None:
    """Remove the blocks of makers that were killed, unless somebody else still uses them."""
    for path in _folder().glob(f"{_PREFIX}*"):
        pid = path.name.removeprefix(_PREFIX).partition("-")[0]
        if not pid.isdecimal() or _alive(int(pid)):
            continue
        with contextlib.suppress(OSError):
            file = os.open(path, os.O_RDWR)
            _remove_if_unused(file, path)
            os.close(file)


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
