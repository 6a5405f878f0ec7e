"""A motor network's file is used for what it was made for, or refused in one line that says why."""

from pathlib import Path

import pytest

from hilplant.bench import BenchError, load_bench
from hilplant.checked_yaml.checksummed import seal
from hilplant.resources import shipped

SHIPPED = (shipped("config", "surrogates") / "motor_default.yaml").read_text()
BODY = SHIPPED[: SHIPPED.rindex("content_hash: ")]


def refusal(folder: Path, network: str, more: str = "") -> str:
    """Return what is said about a bench with this text as its network's file."""
    (folder / "motor.yaml").write_text(network)
    bench = folder / "bench.yaml"
    bench.write_text(
        f"extends: default.yaml\nname: x\n{more}plant:\n  motor_model: {{model: narx, file: motor.yaml}}\n"
    )
    with pytest.raises(BenchError) as refused:
        load_bench(bench)
    lines = str(refused.value).splitlines()
    assert len(lines) == 1, lines
    return lines[0]


def test_the_shipped_file_is_taken(tmp_path: Path) -> None:
    bench = load_bench("networks")
    assert bench.parameters.motor_model == 1.0
    assert len(bench.parameters.networks) == 1 + bench.parameters.networks[0] + 2 * 11 + 11 * (10 + 8)


def test_a_bench_that_asks_for_the_physical_motor_has_no_network(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: x\nplant:\n  motor_model: {model: ode}\n")
    bench = load_bench(path)
    assert (bench.parameters.motor_model, len(bench.parameters.networks)) == (0.0, 0)


def test_a_file_that_was_cut_off_or_edited_or_is_something_else_is_refused(tmp_path: Path) -> None:
    assert "cut off" in refusal(tmp_path, SHIPPED[:3000])
    assert "edited or damaged" in refusal(tmp_path, SHIPPED.replace("seed: 1", "seed: 2"))
    torque = (shipped("config", "surrogates") / "torque_default.yaml").read_text()
    assert "is not a file of 'hilplant motor network 1'" in refusal(tmp_path, torque)
    assert "it is empty" in refusal(tmp_path, "")


def test_a_file_for_another_motor_is_refused_with_both_hashes(tmp_path: Path) -> None:
    line = refusal(tmp_path, seal(BODY.replace("parameter_hash: 1", "parameter_hash: 2")))
    assert "18e34cad" in line
    assert "28e34cad" in line


def test_a_file_for_another_step_is_refused(tmp_path: Path) -> None:
    assert "steps of 0.001 s, and the bench has step_s 0.0005" in refusal(tmp_path, SHIPPED, "step_s: 0.0005\n")


def test_a_sealed_file_with_weights_that_do_not_fit_is_refused(tmp_path: Path) -> None:
    first = BODY.index("  hidden_biases: [")
    shorter = BODY[:first] + "  hidden_biases: [0.5]" + BODY[BODY.index("\n", first) :]
    assert "must have 10 numbers" in refusal(tmp_path, seal(shorter))


def test_an_unknown_model_is_refused_with_a_suggestion(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: x\nplant:\n  motor_model: {model: nark}\n")
    with pytest.raises(BenchError, match="narx"):
        load_bench(path)
