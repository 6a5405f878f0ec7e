"""Files with the mistakes that people make, through the command line: one line that names the mistake, exit code 1."""

import sys
from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.cli.main import main
from hilplant.identify.twin import Corruption, TwinCondition, recorded

HEADER = "time_s,voltage_v,current_a,park_contact,relay_fast"


@pytest.fixture(scope="module")
def table():
    """Two starts of the default bench at 12 and 16 V with 0.1 A of noise and 10 mA steps, as columns."""
    data = recorded(load_bench("default"), TwinCondition(False, 0.0, (12.0, 16.0), 2), Corruption(), 1)
    return np.column_stack([data.time_s, data.voltage_v, data.current_a, data.park, data.fast])


def swapped(table):
    return table[:, [0, 2, 1, 3, 4]]


def milliamperes(table):
    return table * [1.0, 1.0, 1000.0, 1.0, 1.0]


def no_edges(table):
    return table * [1.0, 1.0, 1.0, 0.0, 1.0]


def constant(table):
    return table * [1.0, 0.0, 1.0, 1.0, 1.0] + [0.0, 13.5, 0.0, 0.0, 0.0]


def clipped(table):
    return np.minimum(table, [np.inf, np.inf, 5.0, np.inf, np.inf])


def slow(table):
    return table[::10]


MISTAKES = {
    "swapped columns": (swapped, "columns of voltage and current are swapped"),
    "milliamperes as amperes": (milliamperes, "milliamperes that were taken as amperes"),
    "no park edges": (no_edges, "no park edges"),
    "constant voltage": (constant, "the voltage is constant, 13.5 V"),
    "clipped current": (clipped, "the current is cut off above 5 A"),
    "100 Hz": (slow, "the current is sampled at 100 Hz"),
}


def ran(capsys, monkeypatch, *arguments):
    monkeypatch.setattr(sys, "argv", ["hilplant", *arguments])
    with pytest.raises(SystemExit) as left:
        main()
    return left.value.code, capsys.readouterr().err


@pytest.mark.parametrize("mistake", MISTAKES)
def test_wrong_data_are_named_by_inspect_and_identify(table, tmp_path, capsys, monkeypatch, mistake):
    spoil, message = MISTAKES[mistake]
    path = tmp_path / "rig.csv"
    np.savetxt(path, spoil(table), fmt="%.9g", delimiter=",", header=HEADER, comments="")
    out = tmp_path / "car.yaml"
    for arguments in (["inspect", str(path)], ["identify", f"{path}@dry", "--out", str(out)]):
        code, said = ran(capsys, monkeypatch, *arguments)
        assert code == 1
        assert message in said
        assert said.startswith(str(path))
    assert not Path(out).exists()


def test_good_data_of_the_same_kind_pass(table, tmp_path, capsys, monkeypatch):
    path = tmp_path / "rig.csv"
    np.savetxt(path, table, fmt="%.9g", delimiter=",", header=HEADER, comments="")
    assert ran(capsys, monkeypatch, "inspect", str(path)) == (0, "")


def test_a_file_that_cannot_be_read_is_wrong_use(tmp_path, capsys, monkeypatch):
    code, said = ran(capsys, monkeypatch, "inspect", str(tmp_path / "none.csv"))
    assert (code, said.count("\n")) == (2, 1)
    assert "there is no such file" in said
