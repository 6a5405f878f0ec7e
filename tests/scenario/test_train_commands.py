"""The training commands: what they write, what they refuse, and what an interrupt leaves."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from hilplant.bench import check_bench, load_bench
from hilplant.cli.main import app
from hilplant.progress import ProgressReport
from hilplant.train import torque
from hilplant.train.levenberg_marquardt import DescentSettings
from hilplant.train.torque import TrainingPlan, data_of, train
from hilplant.train.torque_data import Speeds
from hilplant.train.torque_study import study

SMALL = ("--neurons", "5", "--starts", "2", "--scenarios", "4", "--seed", "5")


def run(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["train", *arguments])
    return result.exit_code, result.output + str(result.exception or "")


def test_torque_writes_file_report_plot_and_figures(tmp_path: Path) -> None:
    out, figures = tmp_path / "out", tmp_path / "figures.json"
    code, said = run("torque", "default", *SMALL, "--out", str(out), "--json", str(figures))
    found = json.loads(figures.read_text())
    assert code == 0, said
    assert found["total_mse"] < 5.0 and 0.0 < found["total_share_explained"] < 1.0
    assert found["total_share_explained"] == pytest.approx(1.0 - found["total_mse"] / found["total_variance"])
    assert found["scenario_scenarios"] == 4 and found["scenario_beyond_bound"] == 0
    assert (out / "torque_errors.png").stat().st_size > 10_000 and "thesis" in (out / "report.md").read_text()
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: default.yaml\nname: mine\nplant:\n  load: {model: network, file: out/torque.yaml}\n")
    assert check_bench(bench) == []
    first = (out / "torque.yaml").read_bytes()
    assert run("torque", "default", *SMALL, "--out", str(tmp_path / "again"))[0] == 0
    assert (tmp_path / "again" / "torque.yaml").read_bytes() == first


def test_polynomial_and_tables_write_their_files(tmp_path: Path) -> None:
    figures = tmp_path / "figures.json"
    code, said = run("polynomial", "linkage_alone", "--out", str(tmp_path / "p"), "--json", str(figures))
    assert code == 0 and "0.2738" in said and (tmp_path / "p" / "polynomial.png").is_file()
    assert json.loads(figures.read_text())["share_explained"] > 0.9
    code, said = run("tables", "default", "--bound", "1e-4", "--out", str(tmp_path / "t"), "--json", str(figures))
    found = json.loads(figures.read_text())
    assert code == 0 and found["knots"] == 128 and found["worst_acceleration_error"] <= 1e-4
    assert (tmp_path / "t" / "tables.csv").is_file()


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("torque", "default", "--speeds", "1,x"), "--speeds: numbers with commas between"),
        (("torque", "default", "--speeds", "3,1"), "two rising speeds above 0"),
        (("torque", "default", "--speeds", "0,1"), "two rising speeds above 0"),
        (("torque", "polynomial", *SMALL), "must be reduced or network, not polynomial"),
        (("torque", "no_such_bench"), "no_such_bench: no such file"),
        (("tables", "default", "--out", "/dev/null/x"), "/dev/null/x: cannot be written"),
    ],
)
def test_wrong_use_is_told_in_one_line(arguments: tuple[str, ...], text: str, tmp_path: Path) -> None:
    extra = () if "--out" in arguments else ("--out", str(tmp_path))
    code, said = run(*arguments, *extra)
    assert code != 0 and text in said


def test_an_interrupt_keeps_the_best_start_so_far() -> None:
    plan = TrainingPlan(neurons=3, harmonics=1, starts=5, points=40, settings=DescentSettings(epochs=15))
    data = data_of(load_bench("default"), plan)
    whole = [torque.train_once(data, plan, start) for start in range(2)]

    def interrupting(seen: ProgressReport) -> None:
        if seen.done == 2 and seen.note.startswith("epoch 2,"):
            raise KeyboardInterrupt

    kept = train(data, plan, interrupting)
    assert kept.interrupted and kept.judged <= min(one.judged for one in whole)


def test_the_sets_are_split_as_the_source_does_and_never_meet() -> None:
    plan = TrainingPlan(neurons=2, points=100, speeds=Speeds((1.0, 2.0, 4.0)))
    assert plan.speeds.validation == (1.5, 3.0) and plan.speeds.judging == (1.25, 1.75, 2.5, 3.5)
    data = data_of(load_bench("default"), plan)
    speeds = [set(np.unique(part.states[:, 1])) for part in (data.training, data.judging, data.validation)]
    assert not speeds[0] & speeds[1] and not speeds[0] & speeds[2] and not speeds[1] & speeds[2]
    assert len(data.training.states) == 300


def test_the_study_gives_a_line_for_each_size_and_more_neurons_fit_better() -> None:
    plan = TrainingPlan(points=60, settings=DescentSettings(epochs=60))
    data = data_of(load_bench("default"), plan)
    found = list(study(data, plan, (1, 3, 8)))
    assert [one.neurons for one in found] == [1, 3, 8]
    assert found[0].total > found[1].total > found[2].total > 0.0
    assert all(one.worst_validation >= one.validation for one in found)
