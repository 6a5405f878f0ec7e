"""Damaged benches, scenarios and databases are read or refused in lines; more cases by tests/fuzz/written_files.py."""

import importlib
from pathlib import Path

import pytest


@pytest.mark.parametrize("seed", [1, 2])
def test_mutations_end_in_a_result_or_lines(monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    monkeypatch.syspath_prepend(Path(__file__).parent.parent / "fuzz")
    said: list[str] = []
    assert importlib.import_module("written_files").run(60, seed, say=said.append) == 0, said
