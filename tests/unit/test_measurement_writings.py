"""What a cell means where two readings are near: decimals or thousands, empty or absent, text or number."""

from pathlib import Path

import numpy as np
import pytest

from hilplant.failure import Failure
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.csv_table import Table, read_csv
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.preparation import read_measurement

COUNT = 1500
INDEX = np.arange(COUNT)


def table(path: Path, text: str) -> Table:
    path.write_text(text, "utf-8")
    return read_csv(path)


@pytest.mark.parametrize("begins", [0.0, 1.0, 12.0, 120.0])
@pytest.mark.parametrize("decimal", [",", "."])
@pytest.mark.parametrize("separator", [";", "\t", '","'])
@pytest.mark.parametrize("flag", [True, False], ids=["with a contact", "without"])
def test_three_decimals_are_no_thousands(
    tmp_path: Path, begins: float, decimal: str, separator: str, flag: bool
) -> None:
    truth = np.array([begins + 1e-3 * INDEX, begins + 0.125 * (INDEX % 7), -begins - 0.002 * INDEX])
    quote = separator[0] if separator[0] == '"' else ""
    rows = [[f"{value:.3f}".replace(".", decimal) for value in row] + ["1"] * flag for row in truth.T]
    lines = [separator.join(row).join((quote, quote)) for row in [["t [s]", "U", "I", "PS"][: 3 + flag], *rows]]
    found = table(tmp_path / "a.csv", "\n".join(lines))
    for name, values in zip(("t", "U", "I"), truth, strict=True):
        assert found.columns[name] == pytest.approx(values, abs=1e-9)


@pytest.mark.parametrize(("mark", "decimal"), [(",", "."), (".", ","), ("'", "."), ("\u2019", ","), (" ", ",")])
@pytest.mark.parametrize("blank", ["\u00a0", "\u202f", "\u2009"])
@pytest.mark.parametrize("fraction", [0, 1, 2])
def test_marked_thousands_are_thousands(tmp_path: Path, mark: str, decimal: str, blank: str, fraction: int) -> None:
    def written(value: float, digits: int) -> str:
        signs = str.maketrans({",": blank if mark == " " else mark, ".": decimal})
        return f"{value:,.{digits}f}".translate(signs)

    truth = np.array([1000.0 * INDEX, 250.0 * (INDEX % 11), 1e6 + 1.5 * INDEX])
    rows = [";".join((written(t, 0), written(u, 0), written(i, fraction))) for t, u, i in truth.T]
    found = table(tmp_path / "a.csv", "\n".join(["t [us];speed;count", *rows]))
    for name, values in zip(("t", "speed"), truth, strict=False):
        assert np.array_equal(found.columns[name], values)
    assert found.columns["count"] == pytest.approx(truth[2], abs=0.51 * 10.0**-fraction)


@pytest.mark.parametrize("every", [13, 40])
@pytest.mark.parametrize("head", ["", "rig 3\nmade,by,me,2026,1\n"])
def test_a_column_that_is_seldom_filled_is_a_column(tmp_path: Path, every: int, head: str) -> None:
    slow = np.where(INDEX % every == 0, 20.0 + 0.01 * INDEX, np.nan)
    rows = [f"{0.001 * k:.3f},1.5,2.5,0,{'' if np.isnan(value) else value}" for k, value in enumerate(slow)]
    found = table(tmp_path / "a.csv", "\n".join([f"{head}time,U,I,PS,T", *rows]))
    assert np.array_equal(found.columns["T"], slow, equal_nan=True)


def test_a_column_of_notes_that_are_seldom_is_none(tmp_path: Path) -> None:
    rows = [f"{0.001 * k:.3f},1.5,{('start', '7', '')[min(k % 50, 2)]}" for k in INDEX]
    assert set(table(tmp_path / "a.csv", "\n".join(["time,U,note", *rows])).columns) == {"time", "U"}


@pytest.mark.parametrize("ending", ["filled", "at its changes"])
def test_a_contact_that_is_written_when_it_changes_is_held(tmp_path: Path, ending: str) -> None:
    park = (INDEX // 200) % 2
    cells = [str(now) if ending == "filled" or k == 0 or now != park[k - 1] else "" for k, now in enumerate(park)]
    rows = [f"{0.001 * k:.3f},12.5,{2.5 + 0.01 * (k % 9):.3f},{cell}" for k, cell in enumerate(cells)]
    (tmp_path / "a.csv").write_text("\n".join(["time,voltage,current,park", *rows]))
    assert np.array_equal(read_measurement(Origin(tmp_path / "a.csv")).park > 0.5, park > 0.5)


@pytest.mark.parametrize("form", ["{0:02d}:{1:06.3f}", "{0}:{1:06.3f}"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_minutes_and_seconds_are_a_time(tmp_path: Path, form: str, decimal: str) -> None:
    seconds = 59.0 + 0.004 * INDEX
    times = [form.format(int(second // 60), second % 60) for second in seconds]
    rows = [f"{time};1.5;2.5".replace(".", decimal) for time in times]
    found = table(tmp_path / "a.csv", "\n".join(["time;U;I", *rows]))
    assert found.columns["time"] == pytest.approx(seconds - 59.0, abs=1e-9)
    assert found.units["time"] == "s"


@pytest.mark.parametrize("name", ["t_{}", "time_{}", "Time {}", "timestamp_{}", "Zeit_{}"])
@pytest.mark.parametrize(("unit", "seconds"), [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9), ("MS", 1e-3)])
def test_a_unit_may_end_the_name_of_the_time(tmp_path: Path, name: str, unit: str, seconds: float) -> None:
    rows = [f"{k},1.5,{k % 5}" for k in INDEX]
    path = tmp_path / "a.csv"
    path.write_text("\n".join([f"{name.format(unit)},U,I", *rows]))
    assert read_channels(Origin(path))["U"].time_s == pytest.approx(seconds * INDEX, rel=1e-12)


def test_columns_of_text_are_named_where_one_is_missed(tmp_path: Path) -> None:
    rows = [f"{0.001 * k} s;12.5 V;{k % 3};1" for k in INDEX]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["time;U;I;PS", *rows]))
    with pytest.raises(Failure, match=r"no column for the time; .*; text, no numbers: time \('0.0 s'\), U \(.*V"):
        read_channels(Origin(path))
    columns = parse_columns("voltage=U,current=I,park=PS,time=0:0.001")
    with pytest.raises(Failure, match=r"no column 'U' for the voltage.*; text, no numbers: .*U \('12.5 V'\)"):
        read_measurement(Origin(path), columns)


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("broken", [(0,), (2,), (0, 1, 2)])
def test_a_name_of_two_lines_is_one_name(tmp_path: Path, separator: str, broken: tuple[int, ...]) -> None:
    names = [f'"{name}\n[{unit}]"' if k in broken else f"{name} [{unit}]" for k, (name, unit) in enumerate(NAMED)]
    rows = [separator.join((f"{0.001 * k:.3f}", "1.5", "2.5")) for k in INDEX]
    path = tmp_path / "a.csv"
    found = table(path, "\n".join([separator.join(names), *rows]))
    assert (tuple(found.columns), tuple(found.units.values())) == (("Time", "U", "I"), ("s", "V", "A"))
    assert len(found.columns["Time"]) == COUNT
    rows[700] = separator.join(("0.7", "oops", "2.5"))
    with pytest.raises(Failure, match=rf"a.csv:{1 + len(broken) + 701}: 'oops' is not a number"):
        table(path, "\n".join([separator.join(names), *rows]))


NAMED = (("Time", "s"), ("U", "V"), ("I", "A"))


@pytest.mark.parametrize("head", ["  time        U       I PS", "# time U I PS", "#  time   U    I    PS"])
def test_columns_that_blanks_align(tmp_path: Path, head: str) -> None:
    rows = [f"{0.001 * k:10.3f} {12.5 - 0.1 * k:9.3f} {-2.5 + 0.01 * k:10.3f} {k % 2}   " for k in INDEX]
    found = table(tmp_path / "a.txt", "\n".join([head, *rows]))
    assert tuple(found.columns) == ("time", "U", "I", "PS")
    assert found.columns["U"] == pytest.approx(12.5 - 0.1 * INDEX, abs=5.1e-4)
    assert np.array_equal(found.columns["PS"], INDEX % 2)
