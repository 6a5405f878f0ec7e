"""Examination: compiled code, shared memory and optional parts of this installation."""

import os
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path

from hilplant.doctor.finding import MachineFinding
from hilplant.extras import EXTRAS, missing, remedy

WANTED_SHARED_BYTES = 64 * 2**20


def compiled_code(_root: Path) -> Iterator[MachineFinding]:
    """Ask where compiled models are kept, and whether any are there."""
    import numba

    import hilplant.jit  # noqa: F401 - decides on the folder

    folder = Path(vars(numba.config)["CACHE_DIR"])
    if folder.is_relative_to(tempfile.gettempdir()) and "HOME" in os.environ:
        fix = "export NUMBA_CACHE_DIR=/var/cache/hilplant   # a folder that this user may write"
        yield MachineFinding("compiled models", "warn", f"{folder} is temporary: every start compiles again", fix)
    elif any(folder.rglob("*.nbi")):
        yield MachineFinding("compiled models", "ok", f"kept in {folder}")
    else:
        what = f"none in {folder} yet: the next start compiles, 10 to 20 s"
        yield MachineFinding("compiled models", "warn", what, "hilplant run virtual --seconds 1")


def shared_memory(root: Path) -> Iterator[MachineFinding]:
    """Ask for room for the ring that the recorder reads."""
    folder = root / "dev/shm"
    if not folder.exists():
        return
    free = shutil.disk_usage(folder).free
    if os.access(folder, os.W_OK) and free >= WANTED_SHARED_BYTES:
        yield MachineFinding("shared memory", "ok", f"{free // 2**20} MiB free in /dev/shm")
    else:
        what = f"{free // 2**20} MiB free in /dev/shm, or not writable: no room for the recorder's ring"
        yield MachineFinding("shared memory", "bad", what, "sudo mount -o remount,size=256M /dev/shm")


def extras(_root: Path) -> Iterator[MachineFinding]:
    """Look for the optional libraries."""
    for extra, contents in EXTRAS.items():
        if absent := missing(extra):
            yield MachineFinding(
                f"extra {extra}", "warn", f"{', '.join(absent)} missing: no {contents.purpose}", remedy(extra)
            )
        else:
            yield MachineFinding(f"extra {extra}", "ok", f"present: {contents.purpose}")


CHECKS = (compiled_code, shared_memory, extras)
