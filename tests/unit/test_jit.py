"""How compiled code is kept: nothing that it was built from may change unseen, and nothing in it makes arrays."""

import os
from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import TypingError

import hilplant
from hilplant.jit import ROOMS, _usable, compiled


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


def test_machine_code_is_made_of_what_python_calls_and_of_nothing_else() -> None:
    @compiled
    def innermost(x: float) -> float:
        return x / 3.0

    @compiled
    def inner(x: float, count: int) -> tuple[float, float]:
        return innermost(x) + count, innermost(innermost(x))

    @compiled
    def outer(x: float) -> float:
        first, second = inner(x, 2)
        return first - second

    assert outer(0.7) == 0.7 / 3.0 + 2 - 0.7 / 3.0 / 3.0
    assert [len(each.overloads) for each in (outer, inner, innermost)] == [1, 0, 0]  # type: ignore[attr-defined]
    assert inner(0.7, 2) == (0.7 / 3.0 + 2, 0.7 / 3.0 / 3.0)
    assert [len(each.overloads) for each in (outer, inner, innermost)] == [1, 1, 0]  # type: ignore[attr-defined]


def test_a_cache_that_others_could_have_written_to_is_not_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "own" / "compiled"
    assert _usable(own)
    assert own.stat().st_mode & 0o777 == 0o700
    for mode in (0o770, 0o707, 0o777):
        own.chmod(mode)
        assert not _usable(own)
    own.chmod(0o755)
    assert _usable(own)
    own.parent.chmod(0o777)  # anybody may put another folder in its place
    assert not _usable(own)
    own.parent.chmod(0o1777)
    assert _usable(own)
    real_stat = os.stat

    def of_somebody_else(path: Path) -> os.stat_result:
        found = real_stat(path)
        return os.stat_result((*found[:4], 54321, *found[5:])) if path == own else found

    monkeypatch.setattr(Path, "stat", of_somebody_else)
    assert not _usable(own)
