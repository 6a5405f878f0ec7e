"""Stage 1 tells of each mode in the data: its result, why there is none, and why turns between gaps do not count."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim
from typer.testing import CliRunner

from hilplant.bench import load_bench
from hilplant.cli.main import app
from hilplant.failure import Failure
from hilplant.identify.first_stage import first_stage
from hilplant.identify.parameters import chosen
from hilplant.identify.starting_point import starting_point
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.park import rising_edges

R, L, K, J, DRAG, PERIOD_S = 1.0, 2.0e-3, 0.04, 2e-5, 1e-4, 1e-3


def part(fast: float, volts: list[float], drag: float, samples: int = 500) -> np.ndarray:
    """Rows of voltage, current, park contact and mode: the motor's two equations, so many samples at each voltage."""
    voltage = np.repeat(volts, samples)
    states = [[-R / L, -K / L, 0.0], [K / J, -drag / J, 0.0], [0.0, 1.0, 0.0]]
    system = (states, [[1.0 / L], [0.0], [0.0]], np.eye(3), np.zeros((3, 1)))
    current, _, angle = lsim(system, voltage, PERIOD_S * np.arange(len(voltage)), interp=False)[1].T
    noise = 0.01 * np.random.default_rng(int(fast)).standard_normal(len(voltage))
    park = angle / (2.0 * np.pi * 63.0) % 1.0 < 0.1
    return np.column_stack([voltage, current + noise, park, np.full(len(voltage), fast)])


GOOD = [0.0, 8.0, 12.0, 0.0, 10.0, 14.0]


def data(slow: list[float], drag: float) -> Measurement:
    """A good recording in the fast mode behind one in the slow mode that may tell nothing."""
    return as_measured(np.vstack([part(0.0, slow, drag), part(1.0, GOOD, DRAG)]))


def as_measured(table: np.ndarray) -> Measurement:
    volts, current, park, fast = table.T
    time_s = PERIOD_S * np.arange(len(table))
    return Measurement(time_s, volts, current, park, fast, np.ones(len(table), bool), PERIOD_S, "rig")


SILENT = {
    "no step of the voltage with the motor on": ([12.0, 12.0], DRAG),
    "the data give load_1_s = -5": (GOOD, -DRAG),  # a load that drives
}


@pytest.mark.parametrize("kind", SILENT)
def test_a_mode_for_which_nothing_settles_is_told_beside_the_one_that_does(tmp_path: Path, kind: str) -> None:
    recorded = data(*SILENT[kind])
    found = first_stage(recorded, 63.0)
    assert list(found) == ["fast"]
    assert list(found.failures) == ["slow"]
    text = found.failures["slow"]
    assert text.startswith(kind)
    bench = load_bench("default")
    notes = starting_point([recorded], chosen(bench.parameter_row), 63.0).notes
    assert f"stage 1: rig, slow mode: {text}" in notes

    columns = ("time_s", "terminal_v", "current_a", "park_contact", "relay_fast")
    table = np.column_stack([getattr(recorded, name) for name in ("time_s", "voltage_v", "current_a", "park", "fast")])
    np.savetxt(tmp_path / "rig.csv", table, delimiter=",", header=",".join(columns), comments="", fmt="%.9g")
    arguments = ["inspect", str(tmp_path / "rig.csv"), "--json", str(tmp_path / "found.json")]
    result = CliRunner().invoke(app, arguments)
    told = [line for line in result.output.splitlines() if line.startswith("stage 1, slow: nothing settles: ")]
    assert len(told) == 1
    figures = json.loads((tmp_path / "found.json").read_text())
    assert told[0].endswith(figures["slow_failure"])
    assert "fast_resistance_ohm" in figures


def test_both_modes_are_told_where_both_settle_and_where_none_does() -> None:
    both = data(GOOD, DRAG)
    assert set(first_stage(both, 63.0)) == {"slow", "fast"} and not first_stage(both, 63.0).failures
    constant = replace(both, voltage_v=np.full(len(both), 12.0))
    with pytest.raises(Failure, match=r"rig, slow mode: no step of the voltage.*; rig, fast mode: no step"):
        first_stage(constant, 63.0)


@cache
def long() -> Measurement:
    """Five seconds at each voltage: several whole turns, all of them with the same constant."""
    return as_measured(part(0.0, GOOD, DRAG, 5000))


def bridged(kind: str, seed: int) -> Measurement:
    """Samples missing in a way, with a wrong current in their place, but not where the voltage steps."""
    clean, rng = long(), np.random.default_rng(seed)
    count, edges = len(clean), rising_edges(clean.park)
    bad = np.zeros(count, bool)
    if kind == "at edges":
        bad[edges + rng.integers(-1, 1)] = True
    elif kind.endswith("in a row"):
        for start in edges + rng.integers(50, 300, len(edges)):
            bad[start : start + int(kind.partition(" ")[0])] = True
    else:
        bad = rng.random(count) < float(kind.partition(" ")[0]) / 100.0
        bad[np.concatenate([edges - 1, edges])] = False
    for step in np.flatnonzero(np.diff(clean.voltage_v)):
        bad[max(0, step - 20) : step + 60] = False
    return replace(clean, current_a=np.where(bad, 99.0, clean.current_a), valid=~bad)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("kind", ["1 %", "2 %", "3 %", "1 in a row", "5 in a row"])
def test_turns_with_few_samples_missing_count_and_give_the_true_constant(kind: str, seed: int) -> None:
    found, clean = (first_stage(each, 63.0)["slow"] for each in (bridged(kind, seed), long()))
    assert found.turns == clean.turns > 5 and not found.left_out
    assert found.by_park is not None
    constant, inertia = found.by_park.constant_v_s, found.by_park.inertia_kg_m2
    assert constant.n == pytest.approx(K, rel=2e-3) and abs(constant.n - K) < 3.0 * constant.s
    assert abs(inertia.n - J) < 3.0 * inertia.s


@pytest.mark.parametrize("kind", ["10 %", "20 in a row", "at edges"])
def test_where_no_turn_counts_it_is_told_why(kind: str) -> None:
    found, turns = first_stage(bridged(kind, 1), 63.0)["slow"], first_stage(long(), 63.0)["slow"].turns
    assert found.by_park is None and found.turns == 0
    assert found.left_out.startswith(f"{turns} of {turns} whole turns left out: more than 5 % of the samples missing")
    notes = starting_point([bridged(kind, 1)], chosen(load_bench("default").parameter_row), 63.0).notes
    assert any(note.endswith(f"0 turns ({found.left_out})") for note in notes)


def test_where_there_is_no_whole_turn_it_is_told() -> None:
    found = first_stage(as_measured(part(0.0, GOOD, DRAG, 200)), 63.0)["slow"]
    assert (found.turns, found.left_out) == (0, "no whole turn between two park edges")
