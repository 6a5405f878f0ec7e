"""The heads that oscilloscopes and loggers write above their tables: names, units, time and values are right."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hilplant.measurements.columns import has_unit, unit_scale
from hilplant.measurements.files import Origin, read_channels

COUNT, STEP_S = 400, 1e-3
Row = tuple[int, float, float, float]
Instrument = Callable[[float, list[Row]], str]


def rows(start_s: float) -> list[Row]:
    times = start_s + STEP_S * np.arange(COUNT)
    volts = np.where(times < start_s + 0.1, 0.0, 12.25)
    amperes = np.round(np.where(volts > 0.0, 2.0 + np.sin(9.0 * times), 0.0), 3)
    return list(zip(range(COUNT), times.tolist(), volts.tolist(), amperes.tolist(), strict=True))


def rohde(_: float, table: list[Row]) -> str:
    return "in s,U in V,I in A\n" + "".join(f"{t:.9E},{v:.6E},{i:.6E}\n" for _, t, v, i in table)


def siglent(_: float, table: list[Row]) -> str:
    head = "Record Length,Analog:400\nSample Interval,Analog:0.001\nVertical Units,CH1:V,CH2:A\nHorizontal Units,s\n"
    head += "Model Number,SDS1104X-E\nSoftware Version,8.2.6\nSource,U,I\nSecond,Volt,Ampere\n"
    return head + "".join(f"{t:.9f},{v:.5f},{i:.5f}\n" for _, t, v, i in table)


def pico(_: float, table: list[Row]) -> str:
    return "Time,U,I\n(ms),(V),(mA)\n\n" + "".join(f"{1e3 * t:.6f},{v},{1e3 * i:.3f}\n" for _, t, v, i in table)


def pico_german(_: float, table: list[Row]) -> str:
    lines = [f"{1e3 * t:.6f};{v};{i}\n".replace(".", ",") for _, t, v, i in table]
    return "Zeit;U;I\n(ms);(V);(A)\n\n" + "".join(lines)


def rigol(start_s: float, table: list[Row]) -> str:
    head = f"X,U,I,Start,Increment,\nSequence,Volt,Ampere,{start_s:.6e},{STEP_S:.6e},\n"
    return head + "".join(f"{k},{v:.4e},{i:.3e},,\n" for k, _, v, i in table)


def rigol_new(start_s: float, table: list[Row]) -> str:
    head = f"Time(s),U(V),I(A),t0 = {start_s:g}s, tInc = {STEP_S:g}s\n"
    return head + "".join(f"{t:.9e},{v:.6e},{i:.6e},,\n" for _, t, v, i in table)


def keysight(_: float, table: list[Row]) -> str:
    return "x-axis,U,I\nsecond,Volt,Ampere\n" + "".join(f"{t:+.9E},{v:+.6E},{i:+.6E}\n" for _, t, v, i in table)


def tektronix(_: float, table: list[Row]) -> str:
    head = "Model,MSO44\nFirmware Version,1.28\nPoint Format,Y,,\nHorizontal Units,s,,\nSample Interval,0.001,,\n"
    head += "Gating,0.0% to 100.0%,,\nProbe Attenuation,10,1\nVertical Units,V,A\nLabel,,\n\nTIME,U,I\n"
    return head + "".join(f"{t:.9e},{v},{i}\n" for _, t, v, i in table)


def saleae(_: float, table: list[Row]) -> str:
    return "Time [s],U [V],I [A]\n" + "".join(f"{t:.9f},{v},{i}\n" for _, t, v, i in table)


def diadem(_: float, table: list[Row]) -> str:
    return "Zeit\tU\tI\ns\tV\tA\n" + "".join(f"{t:.6f}\t{v}\t{i}\n" for _, t, v, i in table)


INSTRUMENTS: list[Instrument] = [
    rohde, siglent, pico, pico_german, rigol, rigol_new, keysight, tektronix, saleae, diadem,
]  # fmt: skip


@pytest.mark.parametrize("instrument", INSTRUMENTS)
@pytest.mark.parametrize("start_s", [-0.5, 0.0, 3.25])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_heads_of_instruments(tmp_path: Path, instrument: Instrument, start_s: float, end: str) -> None:
    table = rows(start_s)
    path = tmp_path / "a.csv"
    path.write_bytes(instrument(start_s, table).replace("\n", end).encode())
    channels = read_channels(Origin(path))
    assert set(channels) == {"U", "I"}
    for name, role, place in (("U", "voltage", 2), ("I", "current", 3)):
        channel = channels[name]
        assert has_unit(role, channel.unit)
        assert np.allclose(
            channel.values * unit_scale("", role, channel.unit), [row[place] for row in table], atol=1e-6
        )
        assert np.allclose(channel.time_s, [row[1] for row in table], atol=1e-9)


@pytest.mark.parametrize("count", [1, 3])
def test_a_lecroy_file_has_a_head_of_its_own(tmp_path: Path, count: int) -> None:
    """With any number of segments; the table begins behind the list of their times."""
    head = f"LECROYHDO4024,12345,Waveform\nSegments,{count},SegmentSize,{COUNT}\nSegment,TrigTime,TimeSinceSegment1\n"
    head += "".join(f"#{k + 1},28-Nov-2026 12:00:0{k},{k}\n" for k in range(count)) + "Time,Ampl\n"
    path = tmp_path / "C1.csv"
    path.write_text(head + "".join(f"{t:.6e},{v}\n" for _, t, v, _ in rows(-0.5)))
    channels = read_channels(Origin(path))
    assert set(channels) == {"Ampl"}
    assert channels["Ampl"].values.tolist() == [row[2] for row in rows(-0.5)]


def test_a_german_logger(tmp_path: Path) -> None:
    numbers = [f"{v:.2f};{1e3 * i:.1f};{k % 2}\n".replace(".", ",") for k, _, v, i in rows(0.0)]
    lines = [f"28.11.2026 12:00:00.{k:03d};{cells}" for k, cells in enumerate(numbers)]
    path = tmp_path / "a.csv"
    path.write_text("Timestamp;U_Mot [V];I_Mot [mA];Park\n" + "".join(lines))
    channels = read_channels(Origin(path))
    assert {name: channel.unit for name, channel in channels.items()} == {"U_Mot": "V", "I_Mot": "mA", "Park": ""}
    assert np.allclose(channels["I_Mot"].values, [1e3 * row[3] for row in rows(0.0)])
    assert np.allclose(channels["U_Mot"].time_s, STEP_S * np.arange(COUNT), atol=1e-9)
