"""The speed network of 7.5 as a file: what it holds, which motor it is for, and a wiper driven by it."""

import math
import shutil
from pathlib import Path

import numpy as np
import pytest
from support.driven_wiper import in_the_loop, mean_of_turns, on_the_bus

from hilplant.bench import load_bench
from hilplant.bench.speed_network_file import FORMAT, SpeedPathSection, motor_record_hash
from hilplant.checked_yaml.checksummed import flaw_of
from hilplant.checked_yaml.problems import BenchError
from hilplant.control.controller import NETWORK
from hilplant.control.network import network_speed
from hilplant.ecu.controller_choice import ControllerChoice, Driven, controller_file, seat_in_loop
from hilplant.failure import Failure
from hilplant.resources import shipped
from hilplant.train import drawn_data
from hilplant.train.drawn_data import training_data
from hilplant.train.estimator import _section
from hilplant.train.speed_network import NetworkRecord, train

FILE = shipped("config", "surrogates", "estimator_default.yaml")


def written(folder: Path, text: str) -> Path:
    path = folder / "mine.yaml"
    path.write_text(f"name: mine\nsource: a test\nstatus: assumed\n{text}")
    return path


def test_a_path_comes_back_from_its_file_as_it_was_trained() -> None:
    random = np.random.default_rng(5)
    volts, amperes = random.uniform(2.0, 20.0, 4000), random.uniform(0.0, 8.0, 4000)
    before = np.concatenate([[0.0], volts[:-1]])
    data = NetworkRecord(volts, amperes, np.zeros(4000), (before - 1.2 * amperes) / 2.9)
    path = train(data, 3)
    section = SpeedPathSection.model_validate(_section(path, data))
    assert section.path()[3:] == pytest.approx(path[3:], rel=1e-15)
    assert section.path()[:3, :2] == pytest.approx(path[:3, :2], rel=1e-12)
    assert section.errors["rms_rad_s"] < 0.01
    assert network_speed(12.0, 2.0, section.path()) == pytest.approx((12.0 - 2.4) / 2.9, abs=0.02)


def test_the_shipped_network_is_sealed_and_belongs_to_the_default_motor() -> None:
    assert flaw_of(FILE, FORMAT) == ""
    bench = load_bench("default")
    for name in ("pid_network", "error_hebb_fuzzy_network"):
        file = controller_file(shipped("config", "controllers", f"{name}.yaml"))
        assert file.network is not None
        assert file.network.parameter_hash == motor_record_hash(bench.parameters.motor)
        assert file.controller(bench.parameters.motor, 0.001).source == NETWORK
        assert [len(path) - 3 for path in file.tables()[1:]] == [10, 8]


@pytest.mark.parametrize("name", ["pid_network", "error_hebb_fuzzy_network"])
def test_a_wiper_is_driven_without_a_speed_sensor_in_the_loop(name: str) -> None:
    speed, _ = in_the_loop(name, str(math.pi), 1.0, 5.0)
    assert mean_of_turns(speed[1500:]) == pytest.approx(math.pi, rel=0.01)


def test_and_on_the_bus() -> None:
    speed, _ = on_the_bus("pid_network", str(math.pi), 1.0, 5.0)
    assert mean_of_turns(speed[1500:]) == pytest.approx(math.pi, rel=0.02)


def test_a_network_of_another_motor_is_refused_with_the_remedy() -> None:
    motor = load_bench("extends: default.yaml\nplant:\n  motor: motors/table_5_8.yaml\n").parameters.motor
    with pytest.raises(Failure, match=r"trained for the motor table_5_9, not for this one.*hilplant train estimator"):
        seat_in_loop(ControllerChoice("pid_network", lambda _: 1.0), Driven(motor, 0.001), None)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("pid: {proportional: 1.0, integral: 1.0}\nspeed: network\n", "go together"),
        ("pid: {proportional: 1.0, integral: 1.0}\nnetwork: estimator.yaml\n", "go together"),
        ("cascade: {speed_rate: 9.0, current_rate: 90.0}\nspeed: network\nnetwork: estimator.yaml\n", "own observer"),
        ("pid: {proportional: 1.0, integral: 1.0}\nspeed: network\nnetwork: nowhere.yaml\n", "no file 'nowhere.yaml'"),
        ("pid: {proportional: 1.0, integral: 1.0}\nspeed: network\nnetwork: edited.yaml\n", "edited or damaged"),
    ],
)
def test_mistakes_around_the_network_are_named(tmp_path: Path, text: str, said: str) -> None:
    shutil.copy(FILE, tmp_path / "estimator.yaml")
    (tmp_path / "edited.yaml").write_text(FILE.read_text().replace("seed: 1", "seed: 2"))
    with pytest.raises(BenchError, match=said) as told:
        controller_file(written(tmp_path, text))
    assert len(told.value.problems) == 1


def test_training_data_are_the_ones_that_training_uses(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = load_bench("default")
    training, validation = training_data("torque", bench)
    assert len(training.columns["sample"]) == 1000 and len(validation.columns["sample"]) == 750
    assert sorted(set(training.columns["crank_speed_rad_s"])) == [1.0, 3.0, 5.0, 7.0]
    monkeypatch.setattr(drawn_data, "LENGTH_S", 0.5)
    slow, fast = training_data("motor", bench, seed=3)
    assert (slow.figure, fast.figure) == ("F-6", "F-7")
    assert set(slow.columns) == {"time_s", "terminal_v", "torque_n_m", "current_a", "crank_speed_rad_s", "known"}
    assert len(slow.columns["time_s"]) == 499
    with pytest.raises(Failure, match="torque, motor, estimator"):
        training_data("speed", bench)
