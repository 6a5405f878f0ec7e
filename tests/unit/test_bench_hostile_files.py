"""Files of strangers: no endless reading, no number that breaks arithmetic, nothing of their content on the screen."""

from pathlib import Path

import pytest

from hilplant.bench import check_bench
from hilplant.checked_yaml.yaml_reader import MOST_VALUES, read_text
from hilplant.resources import find, shipped

HEAD = "extends: default.yaml\nname: x\n"


@pytest.mark.parametrize(("levels", "width"), [(10, 9), (20, 2), (6, 30), (40, 3)])
@pytest.mark.parametrize("mapping", [False, True])
def test_aliases_of_aliases_are_refused_at_once(levels: int, width: int, mapping: bool) -> None:
    """Its values would be width ** levels; reading stops at the limit."""
    lines = ["k0: &k0 [x, x]"]
    for level in range(1, levels + 1):
        inner = ", ".join(f"{f'a{index}: ' if mapping else ''}*k{level - 1}" for index in range(width))
        lines.append(f"k{level}: &k{level} {'{' if mapping else '['}{inner}{'}' if mapping else ']'}")
    document = read_text("\n".join(lines), "bomb.yaml")
    assert document.data is None
    assert len(document.places) <= MOST_VALUES + 1
    (problem,) = document.problems
    assert "once its aliases are followed" in problem.text


def test_a_few_aliases_are_followed() -> None:
    document = read_text("a: &a [1, 2]\nb: [*a, *a]\n", "fine.yaml")
    assert document.data == {"a": [1, 2], "b": [[1, 2], [1, 2]]}


@pytest.mark.parametrize("number", ["1e308", "9" * 5000, "-" + "9" * 5000, "1" + "0" * 400, "0x" + "f" * 400, "1e400"])
@pytest.mark.parametrize(
    "text",
    [
        "plant: {{park_switch: {{park_angle_deg: 0, window_deg: 9, bounce_ms: {0}}}}}",
        "bus: {{receive: {{RelayCommand: {{timeout_ms: {0}, signals: {{RelayOn: relay_on}}}}}}}}",
        "bus: {{send: {{ParkSwitch: {{period_ms: {0}, signals: {{ParkContact: park_contact}}}}}}}}",
        "loop: {{priority: {0}}}",
        "inputs: {{supply_v: {0}}}",
        "step_s: {0}",
    ],
)
def test_a_number_beyond_sense_is_one_line(text: str, number: str) -> None:
    (problem,) = check_bench(f"{HEAD}{text.format(number)}\n")
    assert problem.line == 3
    assert len(problem.text) < 200


@pytest.mark.parametrize(
    "content",
    [
        "root:$6$secret:19000:0\nwww:secret:1\n",
        "root:$6$secret:19000:0:99999:7:::\nwww:$6$secret::\n",
        "TOKEN=secret:\n",
        "ssh-rsa secret:\n",
        "/secret:\n",
        "secret" * 20 + ":\n",
        "- secret\n",
        "secret",
        "[secret",
        "a: secret",
    ],
)
@pytest.mark.parametrize(
    "naming", ["extends: {0}\nname: x\n", HEAD + "plant: {{motor: {0}}}\n", HEAD + "plant: {{screen: {0}}}\n",
               HEAD + "plant: {{load: {{model: network, file: {0}}}}}\n"],
)  # fmt: skip
def test_what_a_foreign_file_holds_is_never_shown(tmp_path: Path, content: str, naming: str) -> None:
    (tmp_path / "shadow").write_text(content)
    (tmp_path / "bench.yaml").write_text(naming.format("shadow"))
    found = check_bench(tmp_path / "bench.yaml")
    assert found
    assert "secret" not in "\n".join(map(str, found))


def test_what_a_foreign_database_holds_is_never_shown(tmp_path: Path) -> None:
    (tmp_path / "shadow.dbc").write_text("root:$6$secret:19000:0\n")
    (tmp_path / "bench.yaml").write_text(f"{HEAD}bus: {{database: shadow.dbc}}\n")
    found = check_bench(tmp_path / "bench.yaml")
    assert found
    assert "secret" not in "\n".join(map(str, found))


@pytest.mark.parametrize("code", ["\x1b", "\x07", "\x9b", "\x7f", "\u202e", "\u2028"])
def test_what_would_steer_a_terminal_is_escaped(code: str) -> None:
    written = f'"\\u{ord(code):04x}[2J"'
    (problem,) = check_bench(f"{HEAD}loop: {{{written}: 1}}\n")
    assert code not in str(problem)
    assert "[2J" in str(problem)


@pytest.mark.parametrize("signal", ["(1,0) [0|1e400]", "(1e400,0) [0|1]", "(1,1e400) [0|1]", "(1,0) [-1e400|1]"])
@pytest.mark.parametrize("page", ["", "m1 "])
def test_a_number_of_the_database_beyond_every_number_is_one_line(tmp_path: Path, signal: str, page: str) -> None:
    database = shipped("dbc", "wiper.dbc").read_text()
    selector = ' SG_ Page M : 16|8@1+ (1,0) [0|1] "" PLANT\n' if page else ""
    old = next(line for line in database.splitlines() if "SG_ SupplyVoltage" in line)
    new = f'{selector} SG_ SupplyVoltage {page}: 0|16@1+ {signal} "V" PLANT'
    database = database.replace(old, new).replace("SupplyCommand: 2 ECU", "SupplyCommand: 3 ECU")
    (tmp_path / "own.dbc").write_text(database)
    (tmp_path / "bench.yaml").write_text(f"{HEAD}bus: {{database: own.dbc}}\n")
    (problem,) = check_bench(tmp_path / "bench.yaml")
    assert "is beyond every number" in problem.text


@pytest.mark.parametrize("name", ["9" * 300, "9" * 5000, "~nobody_of_that_name/x.yaml", "a\0b"])
def test_a_file_name_that_no_system_has_is_no_file(name: str) -> None:
    assert find(name, Path()) is None
