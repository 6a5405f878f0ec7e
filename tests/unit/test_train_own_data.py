"""Training from a user's own tables: the same data give the same network; wrong tables are named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.bench.assembly import Bench
from hilplant.failure import Failure
from hilplant.progress import ProgressReport, Stopped
from hilplant.recording.tables import write_table
from hilplant.train import drawn_data
from hilplant.train.drawn_data import training_data
from hilplant.train.levenberg_marquardt import DescentSettings
from hilplant.train.own_data import own_sequence, own_sequences, own_torque
from hilplant.train.torque import TrainingPlan, train
from hilplant.train.torque_data import Speeds


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


@pytest.fixture(scope="module")
def torque_table(bench: Bench, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("own") / "torque.csv"
    write_table(path, training_data("torque", bench)[0].columns, {})
    return path


def test_a_table_of_torques_is_split_without_loss(torque_table: Path) -> None:
    own = own_torque(torque_table, None, seed=1)
    parts = [own.data.training, own.data.judging, own.data.validation]
    assert [len(part.states) for part in parts] == [800, 100, 100]
    assert own.speeds_rad_s == (1.0, 7.0)
    rows = np.concatenate([np.hstack([part.states, part.torques]) for part in parts])
    assert len(np.unique(rows, axis=0)) == 1000
    with_own = own_torque(torque_table, torque_table, seed=1)
    assert len(with_own.data.training.states) == 900 and len(with_own.data.validation.states) == 1000


def test_a_torque_network_learns_from_the_table_and_stops_when_asked(torque_table: Path) -> None:
    own = own_torque(torque_table, None, seed=1)
    settings = DescentSettings(epochs=60, first_decay=10.0)
    plan = TrainingPlan(neurons=8, starts=1, speeds=Speeds(own.speeds_rad_s), settings=settings)
    trained = train(own.data, plan)
    variance = float(own.data.validation.torques.var(axis=0).mean())
    assert trained.errors.validation < 0.02 * variance

    def stop(report: ProgressReport) -> None:
        raise Stopped

    stopped = train(own.data, replace(plan, starts=5), stop)
    assert stopped.interrupted and stopped.epochs <= 1


def test_a_sequence_comes_back_as_the_plant_made_it(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the torque in the table; and without it, from the motor's balance, to what the angle's integral allows."""
    monkeypatch.setattr(drawn_data, "LENGTH_S", 1.5)
    slow, _ = training_data("motor", bench, seed=2)
    write_table(tmp_path / "slow.csv", slow.columns, {})
    (tmp_path / "bare.csv").write_text("")
    bare = {name: values for name, values in slow.columns.items() if name not in ("torque_n_m", "known")}
    write_table(tmp_path / "bare.csv", bare, {})
    given = own_sequence(bench, tmp_path / "slow.csv", "slow")
    assert np.array_equal(given.inputs[:, 1], slow.columns["torque_n_m"][:-1])
    assert np.array_equal(given.known[1:-1], slow.columns["known"][1:-2] > 0.5)
    balanced = own_sequence(bench, tmp_path / "bare.csv", "slow")
    moving = given.known[:-1] & given.known[1:]
    errors = np.abs(balanced.inputs[:-1, 1] - given.inputs[:-1, 1])[moving]
    assert np.median(errors) < 0.01 * np.ptp(given.inputs[:, 1])
    assert own_sequences(bench, [f"{tmp_path / 'slow.csv'}@slow"]).keys() == {"slow"}


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("crank_angle_rad,crank_speed_rad_s\n1,2\n", "has no column dry_torque_n_m, wet_torque_n_m"),
        ("crank_angle_rad,crank_speed_rad_s,dry_torque_n_m,wet_torque_n_m\n1,2,3,4\n", "1 rows are too few"),
        ("crank_angle_rad,crank_speed_rad_s,dry_torque_n_m,wet_torque_n_m\n1,2,3\n", ":2: has 3 columns"),
        ("crank_angle_rad,crank_speed_rad_s,dry_torque_n_m,wet_torque_n_m\n1,2,3,x\n", ":2: is no row of numbers"),
        ("crank_angle_rad,crank_speed_rad_s,dry_torque_n_m,wet_torque_n_m\n" + "1,2,3,nan\n" * 200, "no finite number"),
        ("crank_angle_rad,crank_speed_rad_s,dry_torque_n_m,wet_torque_n_m\n" + "1,2,3,4\n" * 200, "not the same"),
    ],
)
def test_wrong_tables_are_named(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "own.csv"
    path.write_text(text)
    with pytest.raises(Failure, match=said):
        own_torque(path, None, 1)


def test_wrong_names_and_steps_of_sequences_are_named(bench: Bench, tmp_path: Path) -> None:
    count = 300
    columns = {"time_s": np.arange(count) * 0.01, "terminal_v": np.full(count, 12.0)}
    columns |= {"current_a": np.ones(count), "crank_speed_rad_s": np.ones(count)}
    write_table(tmp_path / "own.csv", columns, {})
    with pytest.raises(Failure, match="every 1 ms"):
        own_sequence(bench, tmp_path / "own.csv", "slow")
    for text, said in (
        ("own.csv", "FILE@slow or FILE@fast"),
        ("own.csv@quick", "FILE@slow"),
        ("own.txt@slow", "ending"),
    ):
        with pytest.raises(Failure, match=said):
            own_sequences(bench, [text])
