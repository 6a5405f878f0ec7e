"""Offline simulation: rows, columns, the shipped scenarios, and the files that results are written to."""

import csv
from pathlib import Path

import asammdf
import numpy as np
import pytest
from pyarrow import parquet

from hilplant import Bench, BenchError, Result, load_bench, simulate
from hilplant.failure import Failure
from hilplant.recording import tables
from hilplant.resources import shipped
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX
from hilplant.simulation.run import simulate_to_file
from hilplant.simulation.scenario import load_scenario

#: The order that readers of the file rely on.
FIRST_COLUMNS = [
    "time_s",
    "supply_v",
    "terminal_v",
    "current_a",
    "motor_speed_rad_s",
    "crank_speed_rad_s",
    "crank_angle_rad",
    "load_torque_n_m",
    "park_contact",
    "left_arm_rad",
    "right_arm_rad",
]
SCENARIOS = sorted(path.stem for path in shipped("config", "scenarios").glob("*.yaml"))


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


@pytest.fixture(scope="module")
def wiped(bench: Bench) -> Result:
    return simulate(bench, "slow_fast_park")


def short(folder: Path, text: str) -> Path:
    path = folder / "scenario.yaml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_shipped_scenario_runs_on_the_default_bench(bench: Bench, name: str) -> None:
    result = simulate(bench, name)
    assert len(result.time_s) == round(load_scenario(name).seconds * 1000)
    assert np.isfinite(result.outputs).all()
    assert not result["guard"].any()


def test_there_is_one_row_for_each_tick_and_row_k_is_at_k_steps(bench: Bench, tmp_path: Path) -> None:
    result = simulate(bench, short(tmp_path, "seconds: 0.0104\nsignals: {relay_on: [[0.004, true]]}\n"))
    assert result.time_s.tolist() == [k / 1000 for k in range(10)]
    assert result["terminal_v"].tolist() == [0.0] * 4 + [13.5] * 6
    assert result["current_a"][:5].tolist() == [0.0] * 5
    assert result["current_a"][5] > 0.0


def test_the_initial_state_of_the_scenario_goes_over_the_bench(bench: Bench, tmp_path: Path) -> None:
    result = simulate(bench, short(tmp_path, "seconds: 0.01\ninitial: {crank_angle_rad: 2.0}\n"))
    assert result["crank_angle_rad"].tolist() == [2.0] * 10
    assert result["park_contact"].tolist() == [0.0] * 10


def test_a_simulation_leaves_the_bench_as_it_was(bench: Bench, wiped: Result) -> None:
    again = simulate(bench, "slow_fast_park")
    assert again.outputs.tobytes() == wiped.outputs.tobytes()


def test_the_wiper_of_the_shipped_scenario_parks(wiped: Result) -> None:
    assert wiped["park_contact"][-1] == 1.0
    assert wiped["crank_speed_rad_s"][-1] == 0.0


def test_the_columns_come_in_the_order_that_is_promised(wiped: Result) -> None:
    columns = list(wiped.columns())
    assert columns[: len(FIRST_COLUMNS)] == FIRST_COLUMNS
    assert "relay_on" in columns[len(FIRST_COLUMNS) :]
    assert len(columns) == len(set(columns))


def test_a_csv_file_is_read_back_bit_for_bit(wiped: Result, tmp_path: Path) -> None:
    wiped.write(tmp_path / "out.csv")
    with (tmp_path / "out.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header == list(wiped.columns())
    read = np.array(rows, dtype=float)
    assert read.tobytes() == np.column_stack(list(wiped.columns().values())).tobytes()


def test_a_parquet_file_is_read_back_bit_for_bit_with_its_units(wiped: Result, tmp_path: Path) -> None:
    wiped.write(tmp_path / "out.parquet")
    table = parquet.read_table(tmp_path / "out.parquet")
    for name, column in wiped.columns().items():
        assert table[name].to_numpy().tobytes() == column.tobytes()
    assert table.schema.field("current_a").metadata[b"unit"] == b"A"


def test_an_mf4_file_is_read_back_bit_for_bit_with_its_units(wiped: Result, tmp_path: Path) -> None:
    wiped.write(tmp_path / "out.mf4")
    with asammdf.MDF(tmp_path / "out.mf4") as file:
        current = file.get("current_a")
        assert current.samples.tobytes() == wiped["current_a"].tobytes()
        assert current.timestamps.tobytes() == wiped.time_s.tobytes()
        assert current.unit == "A"


def test_an_unknown_ending_is_refused_before_anything_is_written(wiped: Result, tmp_path: Path) -> None:
    with pytest.raises(tables.TableError, match=r"out\.xls: the ending must be one of \.csv, \.parquet, \.mf4"):
        wiped.write(tmp_path / "out.xls")
    assert not (tmp_path / "out.xls").exists()


def test_without_its_library_an_mf4_file_is_refused_with_the_command_that_installs_it(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "asammdf", None)
    with pytest.raises(Failure, match=r"pip install 'hilplant\[mdf\]'"):
        tables.check_ending(tmp_path / "out.mf4")


def test_a_file_is_written_whole_or_stays_as_it_was(
    wiped: Result, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def interrupted(path: Path, *_: object) -> None:
        path.write_text("half")
        raise KeyboardInterrupt

    monkeypatch.setitem(tables._WRITERS, ".csv", interrupted)
    out = tmp_path / "out.csv"
    out.write_text("whole")
    with pytest.raises(KeyboardInterrupt):
        wiped.write(out)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("out.csv", "whole")]


def test_a_file_behind_a_link_is_written_there(wiped: Result, tmp_path: Path) -> None:
    (tmp_path / "link.csv").symlink_to(tmp_path / "real.csv")
    wiped.write(tmp_path / "link.csv")
    assert (tmp_path / "link.csv").is_symlink()
    assert (tmp_path / "real.csv").stat().st_size > 0


@pytest.mark.parametrize(
    ("seconds", "said"), [("1e12", r"less than or equal to 86400"), ("1e-4", "shorter than a tick")]
)
def test_a_length_that_no_run_can_have_is_refused_in_one_line(seconds: str, said: str, tmp_path: Path) -> None:
    scenario = tmp_path / "length.yaml"
    scenario.write_text(f"seconds: {seconds}\n")
    with pytest.raises(Failure, match=said):
        simulate_to_file("default", scenario, tmp_path / "out.csv")
    assert not (tmp_path / "out.csv").exists()


def test_inputs_and_outputs_are_found_by_their_names(wiped: Result) -> None:
    assert wiped["screen"].tobytes() == wiped.columns()["screen"].tobytes()
    assert wiped["supply_v"].tobytes() == wiped.columns()["supply_v"].tobytes()
    with pytest.raises(KeyError):
        wiped["curent_a"]


def test_a_bench_with_mistakes_is_not_simulated(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: x\nstep_s: -1\n")
    with pytest.raises(BenchError, match="step_s must be greater than 0"):
        simulate(path, "stall")


def test_a_result_goes_straight_to_a_file_or_says_why_not(tmp_path: Path) -> None:
    said = simulate_to_file("default", "stall", tmp_path / "out.csv")
    columns = len({"time_s", *OUTPUT_INDEX, *INPUT_INDEX})
    assert said.endswith(f"out.csv: 8000 rows, {columns} columns")
    with pytest.raises(Failure, match=r"no/out\.csv: cannot be written: there is no folder .*no$"):
        simulate_to_file("default", "stall", tmp_path / "no" / "out.csv")
