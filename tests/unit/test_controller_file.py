"""A controller's file: its gains are those of the controller that it makes, and a mistake is named with its line."""

from pathlib import Path

import pytest

from hilplant.bench import load_bench
from hilplant.checked_yaml.problems import BenchError
from hilplant.control import catalogue
from hilplant.ecu.controller_choice import Driven, controller_file
from hilplant.resources import shipped

MOTOR = load_bench("default").parameters.motor
DRIVEN = Driven(MOTOR, 0.001)


def test_a_file_is_the_catalogue_s_controller_with_its_own_gains():
    made = controller_file(shipped("config", "controllers", "error_hebb_k_1.yaml")).controller(*DRIVEN)
    assert made == catalogue.with_stages(catalogue.neuron(MOTOR, 0.001, "error_hebb", 1.0), MOTOR)
    gentle = controller_file(shipped("config", "controllers", "gentle_pi.yaml")).controller(*DRIVEN)
    assert (gentle.pid.integral, gentle.stages.up_v, gentle.stages.hold_s) == (17.7, 17.0, 0.3)
    assert gentle.stages.down_v == pytest.approx(15.0 * 3.412 / 4.579)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("pid: {proportional: 1, integral: -1}", "integral must be greater than or equal to 0"),
        ("pid: {proportional: 1, integral: 1}\ncascade: {speed_rate: 1, current_rate: 2}", "give one of pid, neuron"),
        ("highest_v: 12", "give one of pid, neuron and cascade, not none"),
        ("pid: {proportional: 1, integral: 1}\nstages: {up_v: 12, back_v: 13}", "back_v must be below up_v"),
        ("neuron: {rule: hebbian, gain: 1}", "rule must be 'hebb', 'error_hebb' or 'quadratic'"),
        ("pid: {proportional: 1, integral: 1}\nlowest_v: 9\nhighest_v: 9", "lowest_v must be below highest_v"),
    ],
)
def test_a_mistake_in_a_file_is_named_with_its_line(tmp_path: Path, text: str, told: str):
    path = tmp_path / "mine.yaml"
    path.write_text(f"name: mine\nsource: a test\nstatus: assumed\n{text}\n")
    with pytest.raises(BenchError, match=rf"mine.yaml:\d+.*{told}"):
        controller_file(path)
