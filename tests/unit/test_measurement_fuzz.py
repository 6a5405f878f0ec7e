"""Damaged files of measurements are read or refused in one line; more cases by tests/fuzz/measurement_files.py."""

import importlib.util
from pathlib import Path

import pytest


@pytest.mark.parametrize("seed", [1, 2])
def test_mutations_end_in_channels_or_one_line(seed: int) -> None:
    script = Path(__file__).parent.parent / "fuzz" / "measurement_files.py"
    specification = importlib.util.spec_from_file_location("measurement_files", script)
    assert specification is not None
    assert specification.loader is not None
    fuzz = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(fuzz)
    said: list[str] = []
    assert fuzz.run(60, seed, said.append) == 0, said
