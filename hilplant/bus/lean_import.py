"""Keeps the start-up of the bus short."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_asammdf() -> Iterator[None]:
    """Hide asammdf while python-can is imported.

    python-can imports it, where it is installed, for a logger that nothing here uses; with it come pandas and
    pyarrow, four tenths of a second. Afterwards asammdf can be imported as ever.
    """
    hidden = "asammdf" not in sys.modules
    if hidden:
        sys.modules["asammdf"] = None  # type: ignore[assignment]
    try:
        yield
    finally:
        if hidden:
            del sys.modules["asammdf"]
