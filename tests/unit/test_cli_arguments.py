"""Arguments of the command line: what may be left out, and limits that refuse instead of failing later."""

from pathlib import Path

import pytest

from hilplant import cli


def run(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr("sys.argv", ["hilplant", *map(str, words)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert isinstance(ended.value.code, int)
    return ended.value.code


def test_a_bench_that_is_left_out_is_the_default_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scenario = tmp_path / "short.yaml"
    scenario.write_text("seconds: 0.05\nsignals:\n  relay_on: [[0, true]]\n")
    named, left_out = tmp_path / "named.csv", tmp_path / "left_out.csv"
    assert run(monkeypatch, "simulate", "default", scenario, "--out", named) == 0
    assert run(monkeypatch, "simulate", scenario, "--out", left_out) == 0
    assert named.read_bytes() == left_out.read_bytes()


@pytest.mark.parametrize("seconds", ["inf", "nan", "0", "-1", "soon"])
def test_a_length_that_is_none_is_refused_in_one_line(
    seconds: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, "run", "virtual", "--seconds", seconds) == 2
    error = capsys.readouterr().err
    assert error.startswith("Invalid value for '--seconds'")
    assert error.count("\n") == 1
