"""Trained files: the same seed gives the same bytes; what is cut, edited, foreign or for another wiper is refused."""

from pathlib import Path

import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.bench.load_files import TORQUE_FORMAT
from hilplant.checked_yaml.checksummed import flaw, seal
from hilplant.resources import shipped
from hilplant.train.levenberg_marquardt import DescentSettings
from hilplant.train.torque import TrainingPlan, data_of, train
from hilplant.train.torque_file import content_of
from hilplant.train.writing import sealed_text

TRAINED = shipped("config", "surrogates", "torque_default.yaml").read_text(encoding="utf-8")
NETWORK = "plant:\n  load: {model: network, file: own.yaml}\n"


def problems(folder: Path, trained: str | bytes, plant: str = NETWORK) -> list[str]:
    if isinstance(trained, bytes):
        (folder / "own.yaml").write_bytes(trained)
    else:
        (folder / "own.yaml").write_text(trained, encoding="utf-8")
    (folder / "bench.yaml").write_text(f"extends: default.yaml\nname: test\n{plant}")
    found = check_bench(folder / "bench.yaml")
    return [f"{Path(problem.file).name}:{problem.line}: {problem.text}" for problem in found]


def small_file(seed: int) -> str:
    bench = load_bench("default")
    plan = TrainingPlan(neurons=4, harmonics=1, starts=2, points=40, seed=seed, settings=DescentSettings(epochs=20))
    data = data_of(bench, plan)
    return sealed_text(content_of(bench, data, train(data, plan), "a test")[0])


def test_the_shipped_file_is_accepted(tmp_path: Path) -> None:
    assert problems(tmp_path, TRAINED) == []
    assert flaw(TRAINED, TORQUE_FORMAT) == ""


def test_the_same_seed_gives_the_same_bytes_and_another_one_does_not() -> None:
    assert small_file(1) == small_file(1) != small_file(2)


def test_a_file_that_was_just_trained_can_be_used(tmp_path: Path) -> None:
    assert problems(tmp_path, small_file(3)) == []


@pytest.mark.parametrize("part", [0.0, 0.001, 0.2, 0.5, 0.9, 0.99, 0.998])
def test_a_file_cut_anywhere_is_refused_in_one_line(tmp_path: Path, part: float) -> None:
    found = problems(tmp_path, TRAINED[: int(part * len(TRAINED))])
    assert len(found) == 1 and found[0].startswith("bench.yaml:4: 'own.yaml' ") and "\n" not in found[0]


@pytest.mark.parametrize(
    ("right", "wrong"), [("seed: 1", "seed: 2"), ("neurons", "neuron"), ("dry_n_m: 0.", "dry_n_m: 9."), ("a", "b")]
)
def test_a_file_with_one_change_is_refused_in_one_line(tmp_path: Path, right: str, wrong: str) -> None:
    assert right in TRAINED
    found = problems(tmp_path, TRAINED.replace(right, wrong, 1))
    assert len(found) == 1 and found[0].startswith("bench.yaml:4: 'own.yaml' ")
    assert "was edited or damaged" in found[0] or "is not a file of" in found[0]


@pytest.mark.parametrize(
    "foreign",
    ["name: something\n", "- 1\n", "!!python/object/apply:os.system ['echo']\n", b"\xff\xfe\x00\x80", b"",
     seal("format: hilplant torque network 2\n"), "format: hilplant no-load polynomial 1\n"],
)  # fmt: skip
def test_a_foreign_file_is_refused_in_one_line(tmp_path: Path, foreign: str | bytes) -> None:
    found = problems(tmp_path, foreign)
    assert len(found) == 1 and f"is not a file of '{TORQUE_FORMAT}'" in found[0]


def test_a_file_that_is_whole_but_wrong_inside_names_its_own_line(tmp_path: Path) -> None:
    body = TRAINED[: TRAINED.index("content_hash")]
    lines = body.splitlines()
    row = next(number for number, line in enumerate(lines) if line.startswith("hidden:")) + 1
    lines[row] = "  - [0.5, 0.25]"
    found = problems(tmp_path, seal("\n".join(lines) + "\n"))
    assert found == [f"own.yaml:{row + 1}: a neuron has 5 weights and a bias, not 2 numbers"]


@pytest.mark.parametrize(
    "plant",
    ["  screen: screens/table_5_8.yaml\n", "  linkage: linkages/lhd_slave_driven.yaml\n",
     "  blades: {left: {force_n: 7.6}, right: {force_n: 7.615}}\n"],
)  # fmt: skip
def test_a_file_for_other_parameters_is_refused_with_both_hashes(tmp_path: Path, plant: str) -> None:
    found = problems(tmp_path, TRAINED, f"{NETWORK}{plant}")
    theirs = next(line for line in TRAINED.splitlines() if line.startswith("parameter_hash")).split()[1][:16]
    assert len(found) == 1 and "was trained for other parameters" in found[0]
    assert theirs in found[0] and found[0].count("hash is") == 1 and found[0][-16:] != theirs


def test_a_file_for_other_points_is_refused(tmp_path: Path) -> None:
    found = problems(tmp_path, TRAINED, "plant:\n  load: {model: network, file: own.yaml, points: 3}\n")
    assert len(found) == 1 and "was trained for other parameters" in found[0]


def test_what_changes_no_physics_changes_no_hash(tmp_path: Path) -> None:
    linkage = shipped("config", "linkages", "rhd_slave_driven.yaml").read_text()
    line = next(line for line in linkage.splitlines() if line.startswith("source:"))
    (tmp_path / "mine.yaml").write_text(linkage.replace(line, "source: somebody else"))
    assert problems(tmp_path, TRAINED, f"{NETWORK}  linkage: mine.yaml\n") == []


def test_a_network_that_is_not_as_good_as_its_file_says_is_refused(tmp_path: Path) -> None:
    body = TRAINED[: TRAINED.index("content_hash")]
    lines = body.splitlines()
    row = next(number for number, line in enumerate(lines) if line.startswith("output:")) + 1
    lines[row] = lines[row].replace("[", "[0.3, ").rpartition(",")[0] + "]"
    found = problems(tmp_path, seal("\n".join(lines) + "\n"))
    assert len(found) == 1 and "its file promises 0." in found[0]


def test_the_shipped_files_are_those_of_the_default_bench() -> None:
    assert load_bench("network").plant.load_file is not None
