"""Generators: means, edges and mistakes, from what a simulation is driven with; and what a profile says of itself."""

import math
from pathlib import Path

import numpy as np
import pytest

from hilplant import BenchError, load_bench
from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.resources import shipped
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.scenario import load_scenario
from hilplant.simulation.supply_profiles import load_profile


def driven(folder: Path, value: str, seconds: float, name: str = "supply_v") -> Floats:
    path = folder / "driven.yaml"
    path.write_text(f"seconds: {seconds}\nsignals:\n  {name}: [[0, {value}]]\n", encoding="utf-8")
    bench = load_bench("default")
    return load_scenario(path).input_rows(bench.input_row, bench.step_ns)[:, INPUT_INDEX[name]]


def test_every_shipped_profile_says_its_source_and_stays_within_the_supply(tmp_path: Path) -> None:
    files = sorted(shipped("config", "profiles").glob("*.yaml"))
    assert len(files) >= 20
    for path in files:
        profile = load_profile(path)
        assert "not the licensed standard" in profile.source
        times = np.linspace(0.0, profile.seconds, 20_001)
        assert (profile.values(times) >= -16.0).all() and (profile.values(times) <= 100.0).all()


@pytest.mark.parametrize(
    ("generator", "mean", "square"),
    [
        ("{sine: {mean: 12, amplitude: 2, hz: 5}}", 12.0, 144.0 + 2.0),
        ("{triangle: {mean: 12, amplitude: 3, hz: 2}}", 12.0, 144.0 + 3.0),
        ("{square: {mean: 12, amplitude: 2, hz: 4, duty: 0.25}}", 11.0, 0.25 * 196 + 0.75 * 100),
        ("{noise: {mean: 12, deviation: 0.5, seed: 3}}", 12.0, 144.25),
        ("{repeat: {points: [[0, 10], [0.5, 14]], every: 0.5}}", 12.0, 144.0 + 16.0 / 12.0),
    ],
)
def test_mean_and_mean_square_of_a_generator(generator: str, mean: float, square: float, tmp_path: Path) -> None:
    volts = driven(tmp_path, generator, 10.0)
    assert volts.mean() == pytest.approx(mean, abs=0.02)
    assert np.mean(volts**2) == pytest.approx(square, rel=2e-3)


def test_waves_begin_where_they_should(tmp_path: Path) -> None:
    sine = driven(tmp_path, "{sine: {mean: 12, amplitude: 2, hz: 5, phase: 0.25}}", 1.0)
    assert sine[0] == 14.0 and sine[100] == pytest.approx(10.0)
    triangle = driven(tmp_path, "{triangle: {mean: 12, amplitude: 4, hz: 1}}", 1.0)
    assert triangle[[0, 125, 250, 500, 750]] == pytest.approx([12.0, 14.0, 16.0, 12.0, 8.0])
    repeat = driven(tmp_path, "{repeat: {points: [[0, 12], [0.1, 9]], every: 0.2, times: 2, step: true}}", 1.0)
    assert repeat[[0, 99, 100, 199, 200, 300, 399, 400, 900]] == pytest.approx([12, 12, 9, 9, 12, 9, 9, 9, 9])


def test_a_column_of_a_csv_file_drives_an_input(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time_s,ubatt\n0,12\n0.5,14\n1.0,10\n", encoding="utf-8")
    volts = driven(tmp_path, "{csv: {file: log.csv, column: ubatt}}", 2.0)
    assert volts[[0, 250, 500, 750, 1000, 1999]] == pytest.approx([12.0, 13.0, 14.0, 12.0, 10.0, 10.0])


@pytest.mark.parametrize(
    ("value", "told"),
    [
        ("{sine: {amplitude: 2}}", "key 'hz' is missing"),
        ("{sine: {amplitude: 2, hz: 1}, noise: {deviation: 1}}", "a generator is one of"),
        ("{profile: lv124_e99}", "nor one of the shipped profiles"),
        ("{repeat: {points: [[0, 1], [0, 2]], every: 1}}", "times must rise"),
        ("{csv: {file: none.csv, column: u}}", "cannot be read"),
        ("{csv: {file: bad.csv, column: u}}", "bad.csv:3: time_s and u must be finite numbers"),
        ("{csv: {file: bad.csv, column: v}}", "no column 'v'; it has time_s, u"),
    ],
)
def test_a_mistake_in_a_generator_is_told_with_its_line(value: str, told: str, tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text("time_s,u\n0,1\n1,x\n", encoding="utf-8")
    with pytest.raises(BenchError) as error:
        driven(tmp_path, value, 1.0)
    assert "driven.yaml:3: " in str(error.value) and told in str(error.value)


def test_a_generator_beyond_its_signal_is_refused(tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"driven.yaml:3: vehicle_speed_m_s becomes -\d.* not within 0 to 100 m/s"):
        driven(tmp_path, "{sine: {amplitude: 2, hz: 1}}", 1.0, "vehicle_speed_m_s")
    with pytest.raises(BenchError, match="relay_on is a flag and cannot follow a generator"):
        driven(tmp_path, "{square: {amplitude: 1, hz: 1}}", 1.0, "relay_on")


def test_noise_is_the_same_in_every_run_and_another_with_another_seed(tmp_path: Path) -> None:
    one, again, other = (driven(tmp_path, f"{{noise: {{mean: 12, deviation: 1, seed: {n}}}}}", 1.0) for n in (1, 1, 2))
    assert np.array_equal(one, again) and not np.array_equal(one, other)
    assert math.isclose(float(np.std(one)), 1.0, rel_tol=0.1)
