"""Arguments of the command line: what may be left out, and limits that refuse instead of failing later."""

from pathlib import Path

import pytest

from hilplant.cli import main as cli


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


@pytest.mark.parametrize(
    "words", [("park",), ("positions", "default"), ("torque", "default"), ("conditions", "default")]
)
def test_a_picture_of_another_ending_or_nowhere_is_refused_before_it_is_drawn(
    words: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, said in (
        ("x.txt", "the ending must be one of .png, .svg, .pdf"),
        ("x", "the ending must be"),
        ("no/x.png", "cannot be written: there is no folder"),
    ):
        assert run(monkeypatch, "plot", *words, tmp_path / name) == 2
        error = capsys.readouterr().err
        assert said in error
        assert error.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (("plot", "park"), "(hilplant plot park --help shows what is right)"),
        (("vcan",), "(hilplant vcan --help shows what is right)"),
        (("nonsense",), "(hilplant --help shows what is right)"),
    ],
)
def test_wrong_use_names_the_help_of_the_very_command(
    words: tuple[str, ...], hint: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, *words) == 2
    assert capsys.readouterr().err.endswith(f"{hint}\n")


@pytest.mark.parametrize("words", [(), ("plot",), ("study",), ("train",)])
def test_the_lists_of_commands_cut_no_sentence_off(
    words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    assert run(monkeypatch, *words, "--help") == 0
    assert "..." not in capsys.readouterr().out.replace("[ARGS]...", "")


@pytest.mark.parametrize("seconds", ["inf", "nan", "0", "-1", "soon"])
def test_a_length_that_is_none_is_refused_in_one_line(
    seconds: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, "run", "virtual", "--seconds", seconds) == 2
    error = capsys.readouterr().err
    assert error.startswith("Invalid value for '--seconds'")
    assert error.count("\n") == 1
