"""Data of a rig: good data pass, each mistake is named."""

import math
from dataclasses import replace

import numpy as np
import pytest
from support.measured_rig import COLUMNS, L, R, channels, prepared, rig

from hilplant.failure import Failure
from hilplant.measurements.checks import examine, refuse
from hilplant.measurements.columns import Column
from hilplant.measurements.measurement import Channel, Measurement
from hilplant.measurements.preparation import Preparation, prepare


def names(data: Measurement) -> list[str]:
    return [found.name for found in examine(data)]


@pytest.mark.parametrize("seed", range(8))
def test_good_data_raise_no_alarm(seed: int) -> None:
    assert examine(prepare(channels(seed), COLUMNS, Preparation())) == []


def test_good_data_without_noise_raise_no_alarm() -> None:
    clean = rig()
    assert names(prepared(U1=clean["U1"], I1=clean["I1"])) == []


@pytest.mark.parametrize("levels", [(9.0, 12.0), (14.0, 16.0, 10.0)])
def test_good_data_at_other_voltages_raise_no_alarm(levels: tuple[float, ...]) -> None:
    stages = ((0.5, 0.0), *((3.0, level) for level in levels), (1.0, 0.0))
    clean = rig(1000.0, stages)
    data = {name: Channel(clean["time"], clean[name]) for name in ("U1", "I1", "PS")}
    assert [found for found in examine(prepare(data, COLUMNS, Preparation())) if found.fatal] == []


def test_a_blocked_motor_is_not_taken_for_swapped_columns_or_a_clipped_current() -> None:
    """At stall V/I is the resistance, and a noise-free current is flat at its highest."""
    time_s = np.arange(6000) * 1e-3
    volts = np.where(time_s < 0.5, 0.0, np.where(time_s < 3.0, 8.0, 12.0))
    current = np.zeros(6000)
    for tick in range(5999):
        current[tick + 1] = current[tick] + (volts[tick] / R - current[tick]) * (1.0 - math.exp(-1e-3 * R / L))
    data = prepare(
        {"U1": Channel(time_s, volts), "I1": Channel(time_s, current), "PS": Channel(time_s, np.zeros(6000))},
        COLUMNS,
        Preparation(),
    )
    assert names(data) == ["no_park_edges"]


def test_swapped_voltage_and_current() -> None:
    good = channels()
    found = examine(prepared(U1=good["I1"].values, I1=good["U1"].values))
    assert [each.name for each in found] == ["swapped_columns"]
    assert "exchange them" in found[0].text


@pytest.mark.parametrize("role", ["U1", "I1"])
def test_park_swapped_with_another(role: str) -> None:
    good = channels()
    changed = {role: good["PS"].values, "PS": good[role].values}
    assert names(prepared(**changed)) == ["swapped_columns"]


def test_amperes_taken_as_milliamperes() -> None:
    found = examine(prepare(channels(), COLUMNS | {"current": Column("I1", "mA")}, Preparation()))
    assert [each.name for each in found] == ["wrong_current_unit"]
    assert "current=NAME[A]" in found[0].text


def test_milliamperes_taken_as_amperes() -> None:
    found = examine(prepared(I1=1000.0 * channels()["I1"].values))
    assert [each.name for each in found] == ["wrong_current_unit"]
    assert "current=NAME[mA]" in found[0].text


@pytest.mark.parametrize(("factor", "unit"), [(1000.0, "mV"), (0.001, "V")])
def test_a_wrong_unit_of_the_voltage(factor: float, unit: str) -> None:
    found = examine(prepared(U1=factor * channels()["U1"].values))
    assert [each.name for each in found] == ["wrong_voltage_unit"]
    assert f"voltage=NAME[{unit}]" in found[0].text


def test_no_park_edges() -> None:
    found = examine(prepared(PS=np.zeros(len(rig()["PS"]))))
    assert [each.name for each in found] == ["no_park_edges"]


def test_a_noisy_park_line() -> None:
    random = np.random.default_rng(3)
    noisy = np.repeat(random.integers(0, 2, len(rig()["PS"]) // 20 + 1), 20)[: len(rig()["PS"])].astype(float)
    assert names(prepared(PS=noisy)) == ["too_many_park_edges"]


def test_constant_voltage() -> None:
    good = rig()
    part = slice(np.searchsorted(good["time"], 1.2), np.searchsorted(good["time"], 2.65))
    long = {name: np.tile(values[part], 4) for name, values in good.items()}
    clock = np.arange(len(long["U1"])) * 1e-3
    random = np.random.default_rng(1)
    data = {name: Channel(clock, long[name] + 0.02 * random.standard_normal(len(clock))) for name in ("U1", "I1")}
    data["PS"] = Channel(clock, (clock % 0.9 < 0.04).astype(float))
    found = examine(prepare(data, COLUMNS, Preparation()))
    assert [each.name for each in found] == ["constant_voltage"]
    assert "10" in found[0].text


@pytest.mark.parametrize("noise", [True, False])
def test_a_clipped_current(noise: bool) -> None:
    current = channels()["I1"].values if noise else rig()["I1"]
    found = examine(prepared(I1=np.minimum(current, 5.0)))
    assert [each.name for each in found] == ["clipped_current"]
    assert "above 5 A" in found[0].text


@pytest.mark.parametrize("limit", [3.0, 5.0])
def test_a_clamp_that_adds_noise_behind_its_own_limit(limit: float) -> None:
    """No two samples at the limit are the same; they scatter as noise alone does, entered at full slope."""
    noise = 0.02 * np.random.default_rng(2).standard_normal(len(rig()["time"]))
    found = examine(prepared(I1=np.round(np.minimum(rig()["I1"], limit) + noise, 2)))
    assert [each.name for each in found] == ["clipped_current"]
    assert float(found[0].text.split("above ")[1].split(" A")[0]) == pytest.approx(limit, abs=0.03)


@pytest.mark.parametrize("noise_a", [0.02, 0.1, 0.3])
def test_a_blocked_motor_with_noise_is_not_taken_for_a_clipped_current(noise_a: float) -> None:
    time_s = np.arange(6000) * 1e-3
    current = np.where(time_s < 0.5, 0.0, 12.0 / R * (1.0 - np.exp(-np.maximum(time_s - 0.5, 0.0) * R / L)))
    current += noise_a * np.random.default_rng(4).standard_normal(6000)
    volts = np.where(time_s < 0.5, 0.0, 12.0)
    columns = {"U1": Channel(time_s, volts), "I1": Channel(time_s, current), "PS": Channel(time_s, np.zeros(6000))}
    assert "clipped_current" not in names(prepare(columns, COLUMNS, Preparation()))


@pytest.mark.parametrize(("column", "lead"), [("U1", "voltage"), ("I1", "current")])
def test_leads_or_clamp_the_wrong_way_round(column: str, lead: str) -> None:
    found = examine(prepared(**{column: -channels()[column].values}))
    assert [each.name for each in found] == ["wrong_sign"]
    assert f"{lead}=NAME*-1" in found[0].text


def test_a_time_in_the_wrong_unit() -> None:
    """Seconds taken as milliseconds leave less than a turn; milliseconds taken as seconds go on for hours."""
    short = {name: replace(each, time_s=1e-3 * each.time_s) for name, each in channels().items()}
    assert names(prepare(short, COLUMNS, Preparation())) == ["too_short"]
    long = {name: replace(each, time_s=1e3 * each.time_s) for name, each in channels().items()}
    with pytest.raises(Failure, match=r"^rig\.csv: the time goes on for .* hours; .*time=NAME\[ms\]"):
        prepare(long, COLUMNS, Preparation(), "rig.csv")


def test_sampling_at_100_hz() -> None:
    found = examine(prepare(channels(sample_hz=100.0), COLUMNS, Preparation()))
    assert [each.name for each in found] == ["slow_sampling"]
    assert "100 Hz" in found[0].text and "1 kHz" in found[0].text


def test_100_hz_that_were_repeated_to_1_khz() -> None:
    held = {name: np.repeat(channels()[name].values[::10], 10)[: len(rig()["time"])] for name in ("U1", "I1")}
    assert names(prepared(**held)) == ["slow_sampling"]


def test_fatal_findings_are_one_line_each_and_name_the_file() -> None:
    with pytest.raises(Failure, match=r"^rig\.csv: no park edges"):
        refuse(prepared(PS=np.zeros(len(rig()["PS"]))))
