"""What is said about single mistakes in a bench and the files that it names; see also the twenty together."""

from pathlib import Path

import pytest

from hilplant.bench import BenchError, check_bench, load_bench
from hilplant.failure import Failure
from hilplant.resources import shipped

DATABASE = shipped("dbc", "wiper.dbc").read_text()


def mistakes(folder: Path, text: str) -> list[str]:
    """Return the problems of a bench that differs from the default one by `text`, as "file:line: text"."""
    bench = folder / "bench.yaml"
    bench.write_text("extends: default.yaml\nname: test\n" + text)
    return [f"{Path(problem.file).name}:{problem.line}: {problem.text}" for problem in check_bench(bench)]


def the_mistake(folder: Path, text: str) -> str:
    found = mistakes(folder, text)
    assert len(found) == 1, found
    return found[0]


def test_a_bench_that_only_extends_the_default_one_is_sound(tmp_path: Path) -> None:
    assert mistakes(tmp_path, "") == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("step_s: true", "3: step_s must be a number, not true"),
        ("step_s: 1e-10", "3: step_s must be a whole number of nanoseconds, not 1e-10"),
        ("step_s: 0", "3: step_s must be greater than 0, not 0"),
        ("step_s: 0.05", "3: step_s must be less than or equal to 0.02, not 0.05"),
        ("inital: {}", "3: unknown key 'inital', did you mean 'initial'?"),
        ("plant: 3", "3: plant must be a group of keys, not 3"),
        ("plant: {load: none}", "3: load must be a group of keys, not 'none'"),
        (f"plant: {'x' * 99}", f"3: plant must be a group of keys, not '{'x' * 59}..."),
        ("plant: {load: {c1: 1}}", "3: load: key 'model' is missing"),
        ("plant: {load: {model: none, c1: 1}}", "3: unknown key 'c1'; known: model"),
        ("plant: {motor: motors/no.yaml}", "3: no file 'motors/no.yaml'; looked in "),
        ("plant: {park_switch: {park_angle_deg: 360, window_deg: 10}}", "3: park_angle_deg must be less than 360"),
        (
            "plant:\n  park_switch:\n    park_angle_deg: 0\n    window_deg: 350\n    hysteresis_deg: 6",
            "7: hysteresis_deg must leave a gap",
        ),
        ("initial: {crank_angle: 1}", "3: unknown key 'crank_angle', did you mean 'crank_angle_rad'?"),
        ("inputs: {supply: 12}", "3: the plant has no input 'supply', did you mean 'supply_v'?"),
        ("inputs: {relay_on: on}", "3: relay_on must be true or false, not 'on'"),
        ("bus: {safe: {relay_on: 0.5}}", "3: relay_on must be true or false, not 0.5"),
        ("bus: {interface: {channel: vcan0}}", "3: key 'interface' is missing"),
        ("bus: {interface: {interface: socketcam, channel: vcan0}}", "3: python-can has no interface 'socketcam'"),
        ("bus: {interface: {interface: socketcan}}", "3: socketcan needs a channel, such as can0; "),
        ("bus: {interface: {interface: socketcan, channel: can0, bitrate: 5}}", "3: socketcan takes interface"),
        ("bus: {interface: {interface: socketcan, channel: can0, fd: yes}}", "3: fd must be true or false"),
        ("plant: {motor: ''}", "3: motor must not be empty, not ''"),
        ("bus: {interface: vcan0}", "3: interface must be a group of keys, not 'vcan0'"),
        ("bus: {database: no.dbc}", "3: no file 'no.dbc'; looked in "),
        ("loop: {on_overrun: ignore}", "3: on_overrun must be 'count', 'degrade' or 'stop', not 'ignore'"),
        ("loop: {priority: 100}", "3: priority must be less than or equal to 99, not 100"),
        ("loop: 3", "3: loop must be a group of keys, not 3"),
        ("initial: [0]", "3: initial must be a group of keys, not a list"),
        ("loop: {reopen_ms: [1, 2, 3]}", "3: reopen_ms must have at most 2 entries, not 3"),
        ("loop: {reopen_ms: [1.5, 2]}", "3: entry 1 of reopen_ms must be a whole number, not 1.5"),
        ("loop: {reopen_ms: [2000, 100]}", "3: reopen_ms must be [first pause, longest pause], rising"),
        ("ecu: {period_ms: -1}", "3: period_ms must be greater than 0, not -1"),
    ],
)
def test_a_mistake_in_a_section_is_told_at_its_line(tmp_path: Path, text: str, message: str) -> None:
    assert the_mistake(tmp_path, text + "\n").startswith(f"bench.yaml:{message}")


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ("RelayComand: {signals: {RelayOn: relay_on}}", "has no message 'RelayComand', did you mean 'RelayCommand'?"),
        ("RelayCommand: {signals: {}}", "signals must have at least 1 entry, not 0"),
        ("RelayCommand: {signals: {RelayOn: }}", "must be a group of keys, not nothing"),
        ("RelayCommand: {signals: {RelayOf: relay_on}}", "has no signal 'RelayOf', did you mean 'RelayOn'?"),
        ("RelayCommand: {signals: {RelayOn: relay_of}}", "the plant has no signal 'relay_of' here, did you mean"),
        ("RelayCommand: {signals: {RelayOn: current_a}}", "the plant has no signal 'current_a' here"),
        ("RelayCommand: {signals: {RelayOn: {signal: relay_on, invert: 1}}}", "invert must be true or false, not 1"),
        (
            "RelayCommand: {signals: {RelayOn: {signal: relay_on, scal: 1}}}",
            "unknown key 'scal', did you mean 'scale'?",
        ),
        ("SupplyCommand: {signals: {SupplyVoltage: {signal: supply_v, scale: 0}}}", "scale must not be 0"),
        ("RelayCommand: {timeout_ms: -5, signals: {RelayOn: relay_on}}", "timeout_ms must be greater than or equal"),
        ("RelayCommand: {timeout_ms: 50, signals: {RelayOn: relay_on}}", "cycle time of 50 ms, not 50"),
        (
            "RelayCommand: {protection: {profil: 1}, signals: {RelayOn: relay_on}}",
            "unknown key 'profil', did you mean 'profile'?",
        ),
        ("Environment: {signals: {Screen: {signal: screen, choices: {Dry: dry, Wet: soaked}}}}", "'soaked'"),
        (
            "RelayCommand: {signals: {RelayOn: relay_on, RelayFast: relay_on}}",
            "relay_on is written by two mappings; keep one",
        ),
    ],
)
def test_a_mistake_in_a_received_message_is_told_at_its_line(tmp_path: Path, entry: str, message: str) -> None:
    found = mistakes(tmp_path, f"bus:\n  receive:\n    {entry}\n")
    assert [line.startswith("bench.yaml:5: ") for line in found] == [True]
    assert message in found[0]


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (
            "ParkSwitch: {on_change: [park], signals: {ParkContact: park_contact}}",
            "no signal 'park' here, did you mean",
        ),
        ("ParkSwitch: {period_ms: 1.5, signals: {ParkContact: park_contact}}", "multiple of the step of 1 ms, not 1.5"),
        ("ParkSwitch: {period_ms: 0, signals: {ParkContact: park_contact}}", "period_ms or on_change is missing"),
        ("ParkSwitch: {offset_ms: 20, signals: {ParkContact: park_contact}}", "below the period of 20 ms, not 20"),
        ("RelayCommand: {signals: {RelayOn: park_contact}}", "has the identifier 0x120 of RelayCommand"),
        ("ParkSwitch: {signals: {ParkContact: supply}}", "the plant has no signal 'supply' here, did you mean"),
    ],
)
def test_a_mistake_in_a_sent_message_is_told_at_its_line(tmp_path: Path, entry: str, message: str) -> None:
    found = the_mistake(tmp_path, f"bus:\n  send:\n    {entry}\n")
    assert found.startswith("bench.yaml:5: ")
    assert message in found


def test_a_message_without_a_cycle_time_must_say_how_long_it_may_stay_away(tmp_path: Path) -> None:
    database = DATABASE.replace('BA_ "GenMsgCycleTime" BO_ 288 50;\n', "")
    (tmp_path / "own.dbc").write_text(database)
    text = "bus:\n  database: own.dbc\n  receive:\n    RelayCommand: {signals: {RelayOn: relay_on}}\n"
    assert "timeout_ms is missing" in the_mistake(tmp_path, text)


def test_a_mapped_message_that_is_broken_is_told_with_its_line(tmp_path: Path) -> None:
    lines = DATABASE.splitlines()
    number = next(index for index, line in enumerate(lines, start=1) if "SG_ RelayOn" in line)
    lines[number - 1] = lines[number - 1].replace("0|1@1+", "0|1@")
    (tmp_path / "own.dbc").write_text("\n".join(lines))
    said = f"message 'RelayCommand' cannot be read: its syntax is not that of a DBC at line {number}"
    assert said in the_mistake(tmp_path, "bus: {database: own.dbc}\n")


def test_a_database_that_is_broken_is_told_at_its_own_line(tmp_path: Path) -> None:
    (tmp_path / "own.dbc").write_text(DATABASE.replace("BU_:", "BU_;"))
    number = next(index for index, line in enumerate(DATABASE.splitlines(), start=1) if "BU_:" in line)
    assert the_mistake(tmp_path, "bus: {database: own.dbc}\n").startswith(f"own.dbc:{number}: ")


def test_a_database_in_no_known_format_is_told_where_it_is_named(tmp_path: Path) -> None:
    (tmp_path / "own.txt").write_text("x")
    assert the_mistake(tmp_path, "bus: {database: own.txt}\n").startswith("bench.yaml:3: ")


@pytest.mark.parametrize("text", ["a: [", "a: 1\na: 2\n", "", "- 1"])
def test_a_motor_file_that_is_no_parameter_set_is_told_in_its_own_file(tmp_path: Path, text: str) -> None:
    (tmp_path / "own.yaml").write_text(text)
    found = mistakes(tmp_path, "plant: {motor: own.yaml}\n")
    assert found
    assert all(line.startswith("own.yaml:") for line in found)


def test_text_that_is_not_utf_8_is_a_problem_where_it_is_named(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_bytes(b"name: \xff")
    assert "it is not UTF-8 text (byte 6)" in the_mistake(tmp_path, "plant: {motor: own.yaml}\n")


def test_a_mistake_in_an_extended_bench_is_told_in_that_file(tmp_path: Path) -> None:
    (tmp_path / "base.yaml").write_text("extends: default.yaml\nname: base\ninputs:\n  supply_v: 999\n")
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: base.yaml\nname: over\ninputs:\n  screen: moist\n")
    problems = [(Path(problem.file).name, problem.line) for problem in check_bench(bench)]
    assert problems == [("base.yaml", 4), ("bench.yaml", 4)]


def test_benches_that_extend_each_other_are_a_problem(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("extends: b.yaml\nname: a\n")
    (tmp_path / "b.yaml").write_text("extends: a.yaml\nname: b\n")
    assert "extends itself in the end" in str(check_bench(tmp_path / "a.yaml")[0])


def test_a_bench_that_is_not_there_is_one_problem() -> None:
    with pytest.raises(BenchError, match=r"^nowhere\.yaml:1: cannot be read: no such file"):
        load_bench("nowhere.yaml")


def test_a_name_that_is_not_shipped_is_answered_with_those_that_are() -> None:
    with pytest.raises(Failure, match=r"^nowhere: no such file, nor one of the shipped benches, which are .*default"):
        load_bench("nowhere")


@pytest.mark.parametrize(
    ("messages", "message"),
    [
        (' SG_ S : 0|8@1+ (0,0) [0|1] "" X', "A.S: its factor in the database is 0"),
        (' SG_ S : 0|24@1- (1,0) [0|0] "" X\nSIG_VALTYPE_ 1 S : 1;', "A.S: no float has 24 bits; there are 16, 32, 64"),
        (' SG_ S : 0|8@1+ (1,0) [0|0] "" X\n SG_ S : 8|8@1+ (1,0) [0|0] "" X', "A has 2 signals 'S'; keep one"),
        (' SG_ S : 0|8@1+ (1,0) [0|0] "" X\nBO_ 2 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] "" X', "has 2 messages 'A'"),
    ],
)
def test_a_mapped_signal_that_the_database_describes_badly_is_told(
    tmp_path: Path, messages: str, message: str, capfd: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "own.dbc").write_text(f'VERSION ""\nNS_ :\nBS_:\nBU_: X\nBO_ 1 A: 8 X\n{messages}\n')
    receive = "  receive:\n    A: {timeout_ms: 0, signals: {S: supply_v}}\n  send: {}\n"
    found = the_mistake(tmp_path, f"bus:\n  database: own.dbc\n{receive}")
    assert found.startswith("bench.yaml:6: ")
    assert message in found
    assert capfd.readouterr().err == ""


def test_what_is_wrong_with_signals_that_nobody_maps_does_not_matter(tmp_path: Path) -> None:
    other = ' SG_ S : 8|8@1+ (0,0) [0|1] "" X\n SG_ F : 16|24@1- (1,0) [0|0] "" X\nSIG_VALTYPE_ 1 F : 1;'
    text = f'VERSION ""\nNS_ :\nBS_:\nBU_: X\nBO_ 1 A: 8 X\n SG_ Good : 0|8@1+ (1,0) [0|40] "" X\n{other}\n'
    (tmp_path / "own.dbc").write_text(text)
    section = "A: {timeout_ms: 0, signals: {Good: supply_v}}"
    assert mistakes(tmp_path, f"bus:\n  database: own.dbc\n  receive: {{{section}}}\n  send: {{}}\n") == []
    section = "A: {period_ms: 10, signals: {Good: supply_v}}"
    assert mistakes(tmp_path, f"bus:\n  database: own.dbc\n  receive: {{}}\n  send: {{{section}}}\n") == []


@pytest.mark.parametrize(
    ("own", "inherited", "named"),
    [
        ("receive: {RelayProfile1: {signals: {RelayOn: relay_on}}}", "send", "MotorStatus, ParkSwitch, Linkage ..."),
        ("send: {MotorProfile5: {signals: {MotorCurrent: current_a}}}", "receive", "RelayCommand, SupplyCommand"),
    ],
)
def test_a_mapping_that_is_inherited_beside_another_database_is_one_line_at_the_database(
    tmp_path: Path, own: str, inherited: str, named: str
) -> None:
    database = Path(__file__).parents[1] / "data" / "bus" / "protected.dbc"
    text = f"bus:\n  database: {database}\n  timeout_ms: 200\n  {own}\n"
    told = the_mistake(tmp_path, text)
    assert told.startswith(f"bench.yaml:4: {inherited} is inherited from ")
    assert f"names {named}" in told and told.endswith(f"give your own {inherited}")
    assert len(told) < 300
