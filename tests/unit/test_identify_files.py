"""Every kind of file gives the same measurement, and a file that cannot is told in one line with its place."""

from pathlib import Path

import can
import cantools
import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.failure import Failure
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import Origin, read_channels, sha256
from hilplant.measurements.frames import FrameSource
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.preparation import Preparation, read_measurement
from hilplant.recording.tables import write_table
from hilplant.signals import ECU_TX, PUBLISHED

COUNT = 3000
TIME_S = np.arange(COUNT) * 1e-3
VOLTS = np.where(TIME_S < 0.5, 0.0, np.where(TIME_S < 1.5, 12.0, 14.0))
AMPERES = np.round(np.where(TIME_S < 0.5, 0.0, 2.0 + 0.5 * np.sin(7.0 * TIME_S)), 2)
PARK = ((TIME_S % 1.0) < 0.05).astype(float)
PLAIN = {"time_s": TIME_S, "terminal_v": VOLTS, "current_a": AMPERES, "park_contact": PARK}
UNITS = {"time_s": "s", "terminal_v": "V", "current_a": "A", "park_contact": ""}
EXACT = Preparation(offset_a=0.0, current_shift_s=0.0)


def same(made: Measurement) -> None:
    assert len(made) == COUNT
    assert np.allclose(made.voltage_v, VOLTS, atol=1e-9)
    assert np.allclose(made.current_a, AMPERES, atol=1e-9)
    assert np.array_equal(made.park[100:], PARK[100:])


@pytest.mark.parametrize("ending", ["csv", "parquet", "mf4"])
def test_the_projects_own_tables_need_no_columns(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"wipe.{ending}"
    write_table(path, PLAIN, UNITS)
    made = read_measurement(Origin(path), None, EXACT)
    same(made)
    assert made.sha256 == sha256(path)


def test_a_csv_of_an_instrument(tmp_path: Path) -> None:
    """Lines before the header, semicolons, decimal commas, units below the names, and milliamperes."""
    path = tmp_path / "scope.csv"
    rows = [f"{1e3 * t:.0f};{v:.1f};{1e3 * i:.0f},0;{p:.0f}".replace(".", ",") for t, v, i, p in zip(
        TIME_S, VOLTS, AMPERES, PARK, strict=True)]  # fmt: skip
    path.write_text("\n".join(["Scope 2000", "Date;today", "", "t;U1;I1;PS", "[ms];[V];[mA];[]", *rows]), "utf-8")
    same(read_measurement(Origin(path), parse_columns("time=t,voltage=U1,current=I1,park=PS"), EXACT))


def test_decimal_commas_that_come_late(tmp_path: Path) -> None:
    """A recording that begins with whole numbers, as a motor at rest does, still has decimal commas further down."""
    path = tmp_path / "rest.csv"
    rows = [f"{1e3 * t:.0f};{v:.0f};{f'{i:.2f}' if i else '0'};{p:.0f}".replace(".", ",") for t, v, i, p in zip(
        TIME_S, VOLTS, AMPERES, PARK, strict=True)]  # fmt: skip
    path.write_text("\n".join(["t [ms];U1 [V];I1 [A];PS", *rows]), "utf-8")
    same(read_measurement(Origin(path), parse_columns("time=t,voltage=U1,current=I1,park=PS"), EXACT))


def test_units_in_the_header_and_units_that_the_user_overrides(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    rows = [f"{t!r},{v!r},{i!r},{p!r}" for t, v, i, p in zip(*(a.tolist() for a in PLAIN.values()), strict=True)]
    path.write_text("\n".join(["time (s),U (V),I (mA),PS", *rows]))
    made = read_measurement(Origin(path), parse_columns("voltage=U,current=I[A],park=PS"), EXACT)
    same(made)
    assert any("[mA], taken as [A]" in note for note in made.notes)


def test_a_line_that_is_no_row_of_numbers_is_named(tmp_path: Path) -> None:
    path = tmp_path / "bad.csv"
    path.write_text("time_s,terminal_v\n0,1\n1,2\n2,oops\n3,4\n")
    with pytest.raises(Failure, match=r"bad\.csv:4: 'oops' is not a number"):
        read_channels(Origin(path))
    path.write_text("time_s,terminal_v\n0,1\n1,2,3\n")
    with pytest.raises(Failure, match=r"bad\.csv:3: has 3 columns"):
        read_channels(Origin(path))


@pytest.mark.parametrize(("name", "content", "message"), [
    ("a.xls", "x", "the ending must be one of"),
    ("a.csv", "hello\nworld\n", "no table of numbers"),
    ("a.csv", "", "is empty"),
    ("a.csv", "time_s,terminal_v\n", "no table of numbers"),
    ("a.csv", "a,b\n1,2\n3,4\n", "--columns time="),
    ("a.csv", "time_s,b\n,2\n3,4\n", r"a\.csv:2: the row has no time"),
    ("a.parquet", "x", "not a Parquet file"),
    ("a.mf4", "x", "cannot be read as MDF"),
    ("a.blf", "x" * 200, "cannot be read"),
    ("a.hilrec", "x", "not a recording"),
])  # fmt: skip
def test_a_file_that_cannot_be_read_is_told(tmp_path: Path, name: str, content: str, message: str) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(Failure, match=message):
        read_channels(Origin(tmp_path / name, frames=FrameSource(bench="virtual")))


def test_a_folder_and_a_file_that_is_not_there_are_told(tmp_path: Path) -> None:
    (tmp_path / "a.csv").mkdir()
    for name, message in (("a.csv", "it is a folder"), ("b.csv", "there is no such file")):
        with pytest.raises(Failure, match=message):
            read_channels(Origin(tmp_path / name))


def test_a_missing_column_lists_what_there_is(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    write_table(path, {"time_s": TIME_S, "terminal_v": VOLTS, "x": AMPERES}, {})
    with pytest.raises(Failure, match=r"no column for current and park; say --columns current=NAME,park=NAME with .*x"):
        read_measurement(Origin(path))


DBC = """VERSION ""
BU_: RIG
BO_ 256 Motor: 4 RIG
 SG_ Amps : 0|16@1- (0.01,0) [-300|300] "A" RIG
 SG_ Volts : 16|16@1+ (0.001,0) [0|40] "V" RIG
BO_ 257 Switch: 1 RIG
 SG_ Park : 0|1@1+ (1,0) [0|1] "" RIG
"""


@pytest.fixture
def database(tmp_path: Path) -> Path:
    (tmp_path / "rig.dbc").write_text(DBC)
    return tmp_path / "rig.dbc"


def write_frames(path: Path, database: Path) -> None:
    """Motor every millisecond, the switch when it changes: as a rig on a bus would be logged."""
    messages = cantools.database.load_file(database)
    with can.Logger(path) as log:
        for tick in range(COUNT):
            frames = [("Motor", {"Amps": AMPERES[tick], "Volts": VOLTS[tick]})]
            if tick in (0, COUNT - 1) or PARK[tick] != PARK[tick - 1]:
                frames.append(("Switch", {"Park": int(PARK[tick])}))
            for name, values in frames:
                message = messages.get_message_by_name(name)
                data = message.encode(values)
                log(can.Message(1000.0 + TIME_S[tick], message.frame_id, False, data=data))


@pytest.mark.parametrize("ending", ["blf", "asc"])
def test_frames_through_a_database(tmp_path: Path, database: Path, ending: str) -> None:
    path = tmp_path / f"log.{ending}"
    write_frames(path, database)
    columns = parse_columns("voltage=Motor.Volts,current=Amps,park=Switch.Park")
    made = read_measurement(Origin(path, frames=FrameSource(database)), columns, EXACT)
    assert abs(len(made) - COUNT) <= 1
    middle = slice(0, COUNT - 2)
    assert np.percentile(np.abs(made.current_a[middle] - AMPERES[middle]), 99) < 0.011
    assert np.mean(np.abs(made.voltage_v[middle] - VOLTS[middle]) < 1e-6) > 0.99
    assert made.park_steps[-1] == 2


def test_frames_without_a_database_and_with_a_wrong_one_are_told(tmp_path: Path, database: Path) -> None:
    path = tmp_path / "log.asc"
    write_frames(path, database)
    with pytest.raises(Failure, match="--frames"):
        read_channels(Origin(path))
    other = tmp_path / "other.dbc"
    other.write_text(DBC.replace("256", "300").replace("257", "301"))
    with pytest.raises(Failure, match=r"none of its frames is in .*other\.dbc"):
        read_channels(Origin(path, frames=FrameSource(other)))


def test_frames_through_the_mapping_of_a_bench(tmp_path: Path) -> None:
    """What the default bench's plant would send: the plant's own names, and the relay from the command's frame."""
    bench, path = load_bench("default"), tmp_path / "run.blf"
    places = {signal.name: index for index, signal in enumerate(PUBLISHED)}
    command = next(message for message in bench.ecu_side().send if message.name == "RelayCommand")
    with can.Logger(path) as log:
        for tick in range(COUNT):
            values = [0.0] * len(PUBLISHED)
            for name, column in (("terminal_v", VOLTS), ("current_a", AMPERES), ("park_contact", PARK)):
                values[places[name]] = float(column[tick])
            said = [0.0] * len(ECU_TX)
            said[[signal.name for signal in ECU_TX].index("relay_fast")] = float(tick >= 1500)
            for message, row in [(m, values) for m in bench.send if m.name in ("MotorStatus", "ParkSwitch")] + [
                (command, said)
            ]:
                log(can.Message(TIME_S[tick], message.identifier, message.extended, data=message.encode(row)[0]))
    made = read_measurement(Origin(path, frames=FrameSource(bench="default")), None, EXACT)
    middle = slice(0, COUNT - 2)
    assert np.allclose(made.current_a[middle], AMPERES[middle], atol=0.011)
    assert np.array_equal(made.fast[middle] > 0.5, (np.arange(COUNT) >= 1500)[middle])
