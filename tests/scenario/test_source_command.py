"""The C files that `hilplant source` writes, compiled as it says, step a bench to the same bits as `simulate`."""

import shlex
import subprocess
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from hilplant.bench import load_bench
from hilplant.cli.main import app
from hilplant.signals import INPUTS, OUTPUTS
from hilplant.simulation.run import simulate
from hilplant.simulation.scenario import load_scenario


@pytest.mark.parametrize(("name", "told"), [("networks", "slow_fast_park"), ("depressed", "brown_out")])
def test_the_program_gives_what_simulate_gives(name: str, told: str, tmp_path: Path) -> None:
    said = CliRunner().invoke(app, ["source", name, "--out", str(tmp_path / "c")])
    assert said.exit_code == 0, said.output
    command = shlex.split(said.output.splitlines()[-1].removeprefix("compile there: "))
    subprocess.run([*command, "-Wall", "-Wextra", "-Werror"], cwd=tmp_path / "c", check=True)
    bench, scenario = load_bench(name), load_scenario(told)
    rows = scenario.input_rows(bench.input_row, bench.step_ns)
    inputs = tmp_path / "inputs.csv"
    np.savetxt(inputs, rows, "%.17g", ",", header=",".join(signal.name for signal in INPUTS), comments="")
    ran = subprocess.run([tmp_path / "c" / "plant"], stdin=inputs.open(), capture_output=True, text=True, check=True)
    head, *lines = ran.stdout.splitlines()
    assert head.split(",") == ["time_s", *(signal.name for signal in OUTPUTS)]
    theirs = np.array([[float(number) for number in line.split(",")] for line in lines])
    result = simulate(bench, scenario)
    assert np.ascontiguousarray(theirs[:, 1:]).tobytes() == np.ascontiguousarray(result.outputs).tobytes()
    a_row_that_is_too_short_ends(tmp_path / "c" / "plant")


def a_row_that_is_too_short_ends(program: Path) -> None:
    ran = subprocess.run([program], input="1,2,3\n", capture_output=True, text=True, check=False)
    assert ran.returncode == 1
    assert f"a row has 3 numbers, not {len(INPUTS)}" in ran.stderr


def test_a_folder_that_cannot_be_made_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    said = CliRunner().invoke(app, ["source", "polynomial", "--out", str(tmp_path / "taken" / "c")])
    assert said.exit_code != 0
    assert "cannot be written" in str(said.exception)
