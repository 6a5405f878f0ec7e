"""A motor without linkage (section 5.4.5), all stages and one by one; the truth is the twin's, not the bench's."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from hilplant.bench import load_bench
from hilplant.failure import Failure
from hilplant.identify.from_files import IdentifiedFiles, Request, identify_files, partial_figures
from hilplant.identify.stages import StagedValues, parse_stages
from hilplant.identify.three_stages import Identified
from hilplant.identify.twin import Corruption, TwinCondition, recorded, write_csv
from hilplant.progress import ProgressReport, Stopped

TRUTH = {
    "slow_resistance_ohm": 1.3, "fast_resistance_ohm": 0.8, "slow_inductance_henry": 2.2e-3,
    "fast_inductance_henry": 3.6e-3, "slow_constant_v_s": 0.045, "fast_constant_v_s": 0.031,
    "damping_n_m_s": 1.3e-4, "inertia_kg_m2": 2.3e-5,
}  # fmt: skip


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """Write what a rig records of the motor alone: slow and fast, from rest, at three voltages."""
    folder = tmp_path_factory.mktemp("motor")
    bench = load_bench(
        "extends: motor_alone.yaml\nplant:\n  motor:\n    name: twin\n    source: a test\n    status: assumed\n"
        "    slow: {resistance_ohm: 1.3, inductance_henry: 2.2e-3, constant_v_s: 0.045}\n"
        "    fast: {resistance_ohm: 0.8, inductance_henry: 3.6e-3, constant_v_s: 0.031}\n"
        "    inertia_kg_m2: 2.3e-5\n    damping_n_m_s: 1.3e-4\n    gear_ratio: 63\n"
    )
    names = []
    for fast in (False, True):
        path = folder / f"{'fast' if fast else 'slow'}.csv"
        condition = TwinCondition(fast, 0.0, (8.0, 12.0, 16.0))
        write_csv(path, recorded(bench, condition, Corruption(0.03, 0.01), 11 + fast))
        names.append(str(path))
    return names


def found_by(data: list[str], out: Path, stages: str, **more: object) -> IdentifiedFiles:
    request = Request(
        tuple(data), "motor_alone", out, generations=6, population=12, date="2026-11-28",
        stages=parse_stages(stages), **more,  # type: ignore[arg-type]
    )  # fmt: skip
    return identify_files(request)


def test_all_stages_find_the_motor_and_write_a_bench_without_screen(data: list[str], tmp_path: Path) -> None:
    done = found_by(data, tmp_path / "found.yaml", "1,2,3")
    assert isinstance(done.found, Identified)
    assert done.task.choice.names == list(TRUTH)
    assert [path.name for path in done.written] == ["found.motor.yaml", "found.yaml"]
    for verdict in done.found.verdicts:
        assert verdict.identifiable
        assert verdict.value == pytest.approx(TRUTH[verdict.name], rel=0.05), verdict.name
    assert done.found.solution.noise.current_a < 0.035
    assert load_bench(tmp_path / "found.yaml").parameters.motor.inertia_kg_m2 == pytest.approx(2.3e-5, rel=0.05)


def test_stages_one_by_one_come_nearer_and_say_so_in_the_files(data: list[str], tmp_path: Path) -> None:
    costs = {}
    for stages in ("1", "2", "1,2"):
        done = found_by(data, tmp_path / "part.yaml", stages)
        assert isinstance(done.found, StagedValues)
        assert (done.found.outcome is None) == (stages == "1")
        costs[stages] = done.found.cost
        written = yaml.safe_load((tmp_path / "part.motor.yaml").read_text())["identified"]
        assert written["stages"] == [int(stage) for stage in stages.split(",")]
        assert "intervals_95" not in written and set(written["not_told"]) == set(TRUTH)
        assert partial_figures(done.task, done.found)["cost"] == costs[stages]
    assert costs["1,2"] <= costs["1"]
    last = found_by(data, tmp_path / "last.yaml", "3")
    assert isinstance(last.found, Identified)
    assert np.array_equal(last.found.outcome.values, last.task.choice.values)  # it began at the bench's own
    assert last.found.solution.noise.current_a < 0.035


def test_a_callback_stops_the_search_and_the_journal_goes_on_to_the_same_end(data: list[str], tmp_path: Path) -> None:
    seen: list[ProgressReport] = []

    def stop_soon(report: ProgressReport) -> None:
        seen.append(report)
        if len(seen) == 3:
            raise Stopped

    out = tmp_path / "stopped.yaml"
    request = Request(tuple(data), "motor_alone", out, generations=6, population=12, stages=(2,))
    with pytest.raises(Stopped):
        identify_files(request, stop_soon)
    assert not out.exists() and len(seen) == 3
    again = identify_files(
        Request(tuple(data), "motor_alone", out, generations=6, population=12, stages=(2,), resume=True)
    )
    whole = identify_files(
        Request(tuple(data), "motor_alone", tmp_path / "w.yaml", generations=6, population=12, stages=(2,))
    )
    assert isinstance(again.found, StagedValues) and isinstance(whole.found, StagedValues)
    assert np.array_equal(again.found.values, whole.found.values)


@pytest.mark.parametrize("text", ["", "0", "4", "1,two", "1;2"])
def test_other_stages_are_refused(text: str) -> None:
    with pytest.raises(Failure, match="some of 1, 2, 3"):
        parse_stages(text)


def test_a_polynomial_load_is_refused_with_what_would_serve(data: list[str], tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"\{model: reduced\} or \{model: none\}"):
        identify_files(Request(tuple(data), "polynomial", tmp_path / "x.yaml"))
