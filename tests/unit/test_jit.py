"""How compiled code is kept: nothing that it was built from may change unseen, and nothing in it makes arrays."""

from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import TypingError

import hilplant
from hilplant.jit import ROOMS, compiled


def test_every_room_with_compiled_functions_decides_about_the_cache() -> None:
    package = Path(hilplant.__file__).parent
    users = {
        source.relative_to(package).parts[0]
        for source in package.rglob("*.py")
        if "from hilplant.jit import compiled" in source.read_text(encoding="utf-8")
    }
    assert users == set(ROOMS)
    assert all(not any(folder.is_dir() and folder.name != "__pycache__" for folder in (package / room).iterdir())
               for room in ROOMS), "sources in folders of a room would not be seen"  # fmt: skip


def test_a_model_function_that_makes_an_array_is_refused() -> None:
    @compiled
    def squares(count: int) -> float:
        made = np.empty(count)
        for k in range(count):
            made[k] = k * k
        return float(made.sum())

    with pytest.raises(TypingError, match="empty"):
        squares(3)
