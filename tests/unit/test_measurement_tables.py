"""Tables as spreadsheets, scopes, loggers and scripts write them give the same channels."""

import datetime
import itertools
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from hilplant.failure import Failure
from hilplant.measurements.cells import moment_of, number_of
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import Origin, read_channels

COUNT = 700
TIME_S = np.arange(COUNT) * 1e-3
VOLTS = np.where(TIME_S < 0.3, 0.0, 12.345)
AMPERES = np.round(np.where(TIME_S < 0.3, 0.0, 2.0 + 0.5 * np.sin(7.0 * TIME_S)) - 0.25, 3)
PARK = (TIME_S < 0.1).astype(int)
ROWS = list(zip(TIME_S.tolist(), VOLTS.tolist(), AMPERES.tolist(), PARK.tolist(), strict=True))
NAMES = ("time", "voltage", "current", "park")
START = datetime.datetime(2026, 11, 28, 23, 59, 59, 600000)


def text_of(separator: str = ",", decimal: str = ".", quote: str = "", end: str = "\n", tail: str = "") -> str:
    lines = [separator.join(f"{quote}{name}{quote}" for name in NAMES)]
    for time_s, volts, amperes, park in ROWS:
        cells = (f"{time_s:.6f}", f"{volts:.3f}", f"{amperes:.3f}", f"{park}")
        lines.append(separator.join(f"{quote}{cell.replace('.', decimal)}{quote}" for cell in cells) + tail)
    return end.join(lines) + end


def same(path: Path, columns: str = "", tolerance: float = 1e-9) -> None:
    time = parse_columns(columns).get("time")
    channels = read_channels(Origin(path, time))
    for name, values in zip(NAMES[1:], (VOLTS, AMPERES, PARK), strict=True):
        assert np.allclose(channels[name].values, values, atol=tolerance), name
        assert np.allclose(channels[name].time_s - channels[name].time_s[0], TIME_S, atol=2e-7)


WRITINGS = [
    (separator, decimal, quote)
    for separator, decimal, quote in itertools.product((",", ";", "\t", "|", " "), (".", ","), ("", '"'))
    if not (decimal == "," and (separator in ("|", " ") or (separator == "," and not quote)))
]


@pytest.mark.parametrize(("separator", "decimal", "quote"), WRITINGS)
def test_separators_decimal_signs_and_quotes(tmp_path: Path, separator: str, decimal: str, quote: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text_of(separator, decimal, quote))
    same(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16", "utf-16-le", "utf-16-be"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings_and_line_ends(tmp_path: Path, encoding: str, end: str) -> None:
    path = tmp_path / "a.csv"
    text = text_of(end=end).replace("park", "park [°C]", 1)
    path.write_bytes(f"Prüfstand{end}{text}".encode(encoding))
    same(path)


@pytest.mark.parametrize("mu", ["u", "\u00b5", "\u03bc"])
@pytest.mark.parametrize("style", ["time [{}s]", "time ({}s)", "time / {}s", "time in {}s"])
def test_units_in_the_header(tmp_path: Path, mu: str, style: str) -> None:
    path = tmp_path / "a.csv"
    head = ",".join([style.format(mu), *NAMES[1:]])
    path.write_text("\n".join([head, *(f"{1e6 * t:.0f},{v},{i},{p}" for t, v, i, p in ROWS)]), "utf-8")
    same(path)


@pytest.mark.parametrize(("yes", "no"), [("True", "False"), ("ON", "OFF"), ("ja", "nein"), ("0x1", "0x0"), ("1.0", "")])
def test_truth_values_and_text(tmp_path: Path, yes: str, no: str) -> None:
    """Yes and no are numbers; a column of text, wherever it stands, is none and does no harm."""
    lines = [f"ok,{t:.6f},{v},{i},{yes if p else no},x y" for t, v, i, p in ROWS]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["state,time,voltage,current,park,note", *lines]))
    channels = read_channels(Origin(path))
    assert set(channels) == {"voltage", "current", "park"}
    assert np.array_equal(np.nan_to_num(channels["park"].values), PARK)


DATES = [
    "%Y-%m-%d %H:%M:%S.%f", "%Y-%m-%dT%H:%M:%S.%fZ", "%d.%m.%Y %H:%M:%S.%f", "%m/%d/%Y %I:%M:%S.%f %p", "%H:%M:%S.%f",
]  # fmt: skip


@pytest.mark.parametrize("form", DATES)
@pytest.mark.parametrize("decimal", [".", ","])
def test_dates_over_midnight(tmp_path: Path, form: str, decimal: str) -> None:
    lines = []
    for time_s, volts, amperes, park in ROWS:
        written = (START + datetime.timedelta(seconds=time_s)).strftime(form)
        numbers = f"{volts};{amperes};{park}".replace(".", decimal)
        lines.append(f"{written};{numbers}")
    path = tmp_path / "a.csv"
    path.write_text("\n".join([";".join(NAMES), *lines]))
    same(path)


def test_moments_are_exact_to_a_microsecond() -> None:
    assert moment_of("2026-11-28T23:59:59.999999+01:00") == (datetime.date(2026, 11, 28).toordinal(), 86399.999999)
    assert moment_of("28.11.2026 12:00") == moment_of("11/28/2026 12:00 PM")
    assert moment_of("31.02.2026 12:00:00") is None
    assert [number_of(cell, ",") for cell in ("1.234,5", "-0,5", "1.5")] == [1234.5, -0.5, None]
    assert [number_of(cell, ".") for cell in ("1,234.5", "\u22120.5", "1_0")] == [1234.5, -0.5, None]


HEADS = {
    "a trailing comma": "time,voltage,current,park,\n",
    "a spreadsheet's hint": "sep=,\ntime,voltage,current,park\n",
    "units below": "time,voltage,current,park\ns,V,A,-\n",
    "units in words": "time,voltage,current,park\nsecond,Volt,Ampere,Volt\n",
    "units in brackets": "time,voltage,current,park\n[s],[V],[A],[]\n",
    "units above": "Vertical Units,V,A,V\nLabels,,,\ntime,voltage,current,park\n",
    "a long head": "Model,MSO44\n\nHorizontal Units,s,,\nSample Interval,0.001,,\nProbe Attenuation,10,1,1\n"
    "Vertical Units,V,A,V\n"
    "Vertical Offset,0,0,0\nLabel,,,\n\ntime,voltage,current,park\n",
    "LabVIEW": "LabVIEW Measurement\nSeparator,Comma\n***End_of_Header***\n\nChannels,3\nSamples,700,700,700\n"
    "***End_of_Header***,,,\ntime,voltage,current,park,Comment\n",
    "a comment": "# rig 3\n# supply\ntime,voltage,current,park\n",
}


@pytest.mark.parametrize("head", HEADS)
def test_heads(tmp_path: Path, head: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(HEADS[head] + text_of().partition("\n")[2])
    same(path)


@pytest.mark.parametrize("head", [
    "X,voltage,current,park,Start,Increment,\nSequence,Volt,Volt,Volt,-5.0e-01,1.0e-03,\n",
    "X,voltage,current,park,t0 = -0.5s, tInc = 0.001s\n",
])  # fmt: skip
def test_start_and_increment_in_the_head(tmp_path: Path, head: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(head + "".join(f"{k},{v},{i},{p},\n" for k, (_, v, i, p) in enumerate(ROWS)))
    same(path)
    assert read_channels(Origin(path))["voltage"].time_s[0] == -0.5


@pytest.mark.parametrize("told", ["time=-0.5:0.001", "time=:1[ms]", "time=0:1000[us]"])
def test_start_and_increment_as_an_option(tmp_path: Path, told: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text("voltage,current,park\n" + "".join(f"{v},{i},{p}\n" for _, v, i, p in ROWS))
    same(path, told)


def test_a_channel_a_file_is_joined_by_time(tmp_path: Path) -> None:
    """Analogue channels in files of their own, and a logic analyser that writes changes only."""
    for name, values in (("C1", VOLTS), ("C2", AMPERES)):
        rows = [f"{t:e},{v:.3f}" for t, v in zip(TIME_S, values, strict=True)]
        (tmp_path / f"{name}.csv").write_text(
            "\n".join(["LECROYHDO4024,1,Waveform", "Segments,1,SegmentSize,700", "Time,Ampl", *rows])
        )
    changes = [0, *np.flatnonzero(np.diff(PARK)) + 1, 650, 660]
    lines = [f"{TIME_S[k]:.9f},{p}" for k, p in zip(changes, (1, 0, 1, 0), strict=True)]
    (tmp_path / "digital.csv").write_text("\n".join(["Time [s],Channel 0", *lines]))
    joined = read_channels(Origin(Path("+".join(str(tmp_path / f"{n}.csv") for n in ("C1", "C2", "digital")))))
    assert np.allclose(joined["C1.Ampl"].values, VOLTS)
    assert np.allclose(joined["C2.Ampl"].values, AMPERES)
    assert joined["digital.Channel 0"].held
    assert not joined["C1.Ampl"].held


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
def test_dates_in_parquet(tmp_path: Path, unit: str) -> None:
    stamps = np.datetime64(START).astype(f"datetime64[{unit}]") + (TIME_S * 1e3).round().astype("timedelta64[ms]")
    path = tmp_path / "a.parquet"
    parquet.write_table(pa.table({"time": stamps, "voltage": VOLTS, "current": AMPERES, "park": PARK}), path)
    same(path)


def table_of(path: Path, time: pa.Array, park: pa.Array | np.ndarray = PARK) -> Path:
    parquet.write_table(pa.table({"time": time, "voltage": VOLTS, "current": AMPERES, "park": park}), path)
    return path


@pytest.mark.parametrize(("yes", "no"), [("on", "off"), ("True", "False"), ("ja", "nein"), ("1", "0"), ("0x1", "0x0")])
@pytest.mark.parametrize("kind", [
    pa.string(), pa.large_string(), pa.dictionary(pa.int8(), pa.string()), pa.dictionary(pa.int32(), pa.large_string()),
], ids=str)  # fmt: skip
def test_words_in_parquet_are_those_of_a_csv_file(tmp_path: Path, yes: str, no: str, kind: pa.DataType) -> None:
    words = [None if k == 400 else yes if each else no for k, each in enumerate(PARK)]
    park = pa.array(words, pa.string()).cast(kind)
    found = read_channels(Origin(table_of(tmp_path / "a.parquet", pa.array(TIME_S), park)))["park"].values
    assert np.allclose(found, np.where(np.arange(COUNT) == 400, np.nan, PARK), equal_nan=True)


def test_other_text_in_parquet(tmp_path: Path) -> None:
    """A column of text is left out; a text among numbers is named by its row."""
    path = tmp_path / "a.parquet"
    assert "park" not in read_channels(Origin(table_of(path, pa.array(TIME_S), pa.array(["x y"] * COUNT))))
    words = ["perhaps" if k == 399 else "on" for k in range(COUNT)]
    with pytest.raises(Failure, match=r"a\.parquet:400: 'perhaps' is not a number"):
        read_channels(Origin(table_of(path, pa.array(TIME_S), pa.array(words).dictionary_encode())))


@pytest.mark.parametrize(("kind", "per_s"), [
    (pa.time32("ms"), 1e3), (pa.time64("us"), 1e6), (pa.time64("ns"), 1e9),
])  # fmt: skip
@pytest.mark.parametrize("start_s", [0, 86399.6])
def test_times_of_the_day_in_parquet_go_on_over_midnight(
    tmp_path: Path, kind: pa.DataType, per_s: float, start_s: float
) -> None:
    ticks = np.round((start_s + TIME_S) % 86400.0 * per_s).astype("i4" if kind == pa.time32("ms") else "i8")
    same(table_of(tmp_path / "a.parquet", pa.array(ticks).cast(kind)))


@pytest.mark.parametrize("ending", ["csv", "parquet"])
@pytest.mark.parametrize("form", ["%Y-%m-%d %H:%M:%S.%f", "%H:%M:%S.%f"])
@pytest.mark.parametrize("empty", [0, 2, 699])
def test_a_date_that_is_not_there_takes_no_other_with_it(tmp_path: Path, ending: str, form: str, empty: int) -> None:
    """Beside the time it is a missing number; as the time, its row alone is complained of."""
    stamps = [START + datetime.timedelta(seconds=time_s) for time_s in TIME_S.tolist()]
    path = tmp_path / f"a.{ending}"
    for second in ("clock", "time"):
        names = {"clock": ["time", "clock"], "time": ["voltage", "time"]}[second]
        if ending == "csv":
            written = ["" if k == empty else stamp.strftime(form) for k, stamp in enumerate(stamps)]
            rows = [f"{time_s:.3f},{cell}" for time_s, cell in zip(TIME_S, written, strict=True)]
            path.write_text("\n".join([",".join(names), *rows]))
        else:
            cells = [None if k == empty else each if "Y" in form else each.time() for k, each in enumerate(stamps)]
            parquet.write_table(pa.table(dict(zip(names, (TIME_S, pa.array(cells)), strict=True))), path)
        if second == "clock":
            found = read_channels(Origin(path))["clock"].values
            truth = np.where(np.arange(COUNT) == empty, np.nan, TIME_S - TIME_S[int(empty == 0)])
            assert np.allclose(found, truth, atol=2e-7, equal_nan=True)
        else:
            line = empty + (2 if ending == "csv" else 1)
            with pytest.raises(Failure, match=rf":{line}: the row has no time; leave out rows without one$"):
                read_channels(Origin(path))


@pytest.mark.parametrize("word", ["OL", "n/a", "#N/A", "NULL", "-", "NaN", "None"])
def test_words_for_nothing(tmp_path: Path, word: str) -> None:
    lines = text_of().splitlines()
    lines[400] = f"0.399000,12.345,{word},0"
    path = tmp_path / "a.csv"
    path.write_text("\n".join(lines))
    assert np.flatnonzero(np.isnan(read_channels(Origin(path))["current"].values)).tolist() == [399]


def test_a_wrong_cell_is_named(tmp_path: Path) -> None:
    lines = text_of().splitlines()
    lines[400] = "0.399000,12.345,about 2,0"
    path = tmp_path / "a.csv"
    path.write_text("\n".join(lines))
    with pytest.raises(Failure, match=r"a\.csv:401: 'about 2' is not a number"):
        read_channels(Origin(path))
