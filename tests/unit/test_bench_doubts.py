"""What is doubtful about a bench is a warning: it is shown and counted, and the bench runs all the same."""

import json
import math
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

from hilplant.bench import check_bench, load_bench
from hilplant.cli.main import app
from hilplant.resources import shipped
from hilplant.signals import INPUT_INDEX

HEAD = "extends: default.yaml\nname: x\n"
MOTOR = shipped("config", "motors", "table_5_9.yaml").read_text()
LINKAGE = shipped("config", "linkages", "rhd_slave_driven.yaml").read_text()


def warnings(text: str) -> list[str]:
    assert check_bench(HEAD + text) == []
    return [f"{Path(warning.file).name}:{warning.line}: {warning.text}" for warning in load_bench(HEAD + text).warnings]


@pytest.mark.parametrize(
    ("safe", "values"),
    [
        ("{}", {"relay_on": 0.0, "relay_fast": 0.0}),
        ("{supply_v: 12}", {"relay_on": 0.0, "relay_fast": 0.0, "supply_v": 12.0}),
        ("{relay_fast: false}", {"relay_on": 0.0, "relay_fast": 0.0}),
        ("{relay_fast: true}", {"relay_on": 0.0, "relay_fast": 1.0}),
        ("{screen: wet, relay_on: false}", {"relay_on": 0.0, "relay_fast": 0.0, "screen": 1.0}),
    ],
)
def test_relays_open_while_commands_are_lost_unless_they_are_named(safe: str, values: dict[str, float]) -> None:
    bench = load_bench(f"{HEAD}bus: {{safe: {safe}}}\n")
    assert dict(bench.safe) == {INPUT_INDEX[name]: value for name, value in values.items()}
    assert bench.warnings == ()


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("bus: {safe: {relay_on: true}}\n", "3: relay_on: true keeps the motor running while commands are lost"),
        ("step_s: 1e-6\n", "3: step_s 1e-06 is so short"),
        ("plant: {blades: {left: {force_n: 1e5}, right: {force_n: 7}}}\n", "3: force_n is 100000, and no arm presses"),
        (
            "bus: {receive: {RelayCommand: {timeout_ms: 0, signals: {RelayOn: relay_on}}}}\n",
            "3: RelayCommand commands relay_on and may stay away for ever",
        ),
    ],
)
def test_a_doubtful_setting_is_a_warning_at_its_line(text: str, said: str) -> None:
    (warning,) = warnings(text)
    assert warning.startswith(f"(text):{said}")


@pytest.mark.parametrize(
    ("part", "keys", "value", "said"),
    [
        ("motor", ("slow", "resistance_ohm"), 1000.0, "resistance_ohm is 1000"),
        ("motor", ("fast", "constant_v_s"), 64.0, "constant_v_s is 64"),
        ("motor", ("fast", "inductance_henry"), 0.5, "is above the slow one's"),
        ("linkage", ("masses_kg", "link"), 1e4, "kg move, and no wiper weighs more"),
    ],
)
def test_a_doubtful_part_is_a_warning_in_its_own_file(
    tmp_path: Path, part: str, keys: tuple[str, str], value: float, said: str
) -> None:
    data = yaml.safe_load(MOTOR if part == "motor" else LINKAGE)
    data[keys[0]][keys[1]] = value
    (tmp_path / "own.yaml").write_text(yaml.safe_dump(data))
    (tmp_path / "bench.yaml").write_text(f"{HEAD}plant: {{{part}: own.yaml}}\n")
    found = [str(warning) for warning in load_bench(tmp_path / "bench.yaml").warnings]
    assert any("own.yaml:" in warning and said in warning for warning in found), found


@pytest.mark.parametrize(
    ("blade", "tip", "end", "cross"),
    [
        ("left_blade", "A", [0.5, 0.1, 0.0], False),  # 6 cm apart
        ("left_blade", "A", [0.5, 0.3, 0.0], True),
        ("left_blade", "A", [0.9, 0.2, 0.0], True),
        ("left_blade", "A", [0.9, -0.2, 0.0], False),
        ("right_blade", "B", [-0.7, -0.3, 0.0], True),
        ("right_blade", "B", [-0.7, 0.5, 0.0], False),
    ],
)
def test_blades_that_cross_on_the_screen_are_a_warning(
    tmp_path: Path, blade: str, tip: str, end: list[float], cross: bool
) -> None:
    data = yaml.safe_load(LINKAGE)
    data[blade]["points_m"][tip] = end
    (tmp_path / "own.yaml").write_text(yaml.safe_dump(data))
    (tmp_path / "bench.yaml").write_text(f"{HEAD}plant: {{linkage: own.yaml}}\n")
    assert check_bench(tmp_path / "bench.yaml") == []
    found = [warning.text for warning in load_bench(tmp_path / "bench.yaml").warnings]
    assert found == (["the blades cross on the screen"] if cross else [])


SCREEN = shipped("config", "screens", "table_5_9.yaml").read_text()


@pytest.mark.parametrize(
    ("lines", "gravity", "doubted"),
    [
        ("angle_rad: 0.5236\n", "cos", True),  # 30 deg: from the vertical, or so it is read
        ("angle_rad: -0.5236\n", "cos", True),
        ("angle_rad: 0.5236\nangle_from: vertical\n", "cos", False),
        ("angle_rad: 0.5236\nangle_from: horizontal\n", "sin", False),
        ("angle_rad: 1.0472\n", "cos", False),
        ("angle_rad: -1.0472\nangle_from: horizontal\n", "sin", False),
    ],
)
def test_an_angle_that_looks_like_a_rake_from_the_horizontal_is_doubted(
    tmp_path: Path, lines: str, gravity: str, doubted: bool
) -> None:
    own = SCREEN.replace("angle_rad: -0.57\nangle_from: vertical\n", lines)
    assert own != SCREEN
    (tmp_path / "own.yaml").write_text(own)
    (tmp_path / "bench.yaml").write_text(f"{HEAD}plant: {{screen: own.yaml}}\n")
    bench = load_bench(tmp_path / "bench.yaml")
    angle = float(lines.split()[1])
    expected = 9.81 * (math.cos(angle) if gravity == "cos" else abs(math.sin(angle)))
    assert bench.plant.mechanics.wiper.gravity_m_s2 == pytest.approx(expected, rel=1e-3)
    found = [str(warning) for warning in bench.warnings]
    assert any("own.yaml:" in each and "'angle_from: horizontal'" in each for each in found) is doubted, found


def test_check_shows_warnings_and_ends_with_0(tmp_path: Path) -> None:
    path, figures = tmp_path / "bench.yaml", tmp_path / "found.json"
    path.write_text(f"{HEAD}bus:\n  safe: {{relay_on: true}}\n")
    done = CliRunner().invoke(app, ["check", str(path), "--json", str(figures)])
    assert done.exit_code == 0
    assert f"{path}:4: warning: relay_on: true" in done.stderr
    assert "nothing is wrong, but see 1 warning(s)" in done.stdout
    counted = json.loads(figures.read_text())
    assert (counted["problems"], counted["warnings"]) == (0, 1)
