"""Units of a database that contradict the plant's are a warning, and what it says to write gives the right number."""

import json
import re
from pathlib import Path

import pytest
import yaml
from cantools.database import load_string
from typer.testing import CliRunner

from hilplant.bench import check_bench, load_bench
from hilplant.bench.mapping_description import SignalEntry
from hilplant.bench.unit_doubts import unit_doubt
from hilplant.bus.codec import Timing, received_message, sent_message
from hilplant.bus.mapping import SignalMapping, link
from hilplant.cli.main import app
from hilplant.resources import shipped
from hilplant.signals import ECU_STATUS, INPUTS, PUBLISHED, PUBLISHED_INDEX, STALK
from hilplant.units import quantity_of, unit_of

SIGNALS = (*INPUTS, *PUBLISHED, *STALK, *ECU_STATUS)


def database(unit: str, bits: str = "32@1- (0.001,0)") -> str:
    return f'VERSION "1"\nBU_: A B\nBO_ 291 Cmd: 8 A\n SG_ Value : 0|{bits} [0|0] "{unit}" B\n'


def doubt(unit: str, signal: str, bits: str = "32@1- (0.001,0)", **more: object) -> str:
    mapping = SignalMapping("Value", signal, **more)  # type: ignore[arg-type]
    (message,) = load_string(database(unit, bits), "dbc").messages
    return unit_doubt(link(message, mapping, SIGNALS), mapping)


def advised(text: str) -> SignalMapping:
    """Return the mapping that a warning tells the user to write, as a bench reads it."""
    found = re.search(r"write '(.*)'$", text)
    assert found, text
    ((name, written),) = yaml.safe_load(found[1]).items()
    entry = SignalEntry(**written)
    return SignalMapping(name, entry.signal, entry.scale, entry.offset)


@pytest.mark.parametrize(
    ("unit", "value", "signal", "truth"),
    [
        *((unit, 100.0, "vehicle_speed_m_s", 100_000.0 / 3600.0) for unit in ("km/h", "kph", "kmh", "KM/H", "km / h")),
        ("mph", 60.0, "vehicle_speed_m_s", 26.8224),
        ("mV", 13_500.0, "supply_v", 13.5),
        ("kV", 0.012, "supply_v", 12.0),
        ("degF", 212.0, "ambient_temperature_c", 100.0),
        ("°F", -40.0, "ambient_temperature_c", -40.0),
        ("K", 293.15, "ambient_temperature_c", 20.0),
        *((unit, 75.0, "screen", 0.75) for unit in ("%", "percent", "Prozent")),
        ("%", 120.0, "left_wear", 1.2),
        *((unit, 5000.0, "brake_torque_n_m", 5.0) for unit in ("mNm", "mN m", "mN·m", "mN*m", "Nmm")),
        ("kNm", 0.5, "brake_torque_n_m", 500.0),
        ("mm/min", 1.0, "rain_mm_h", 60.0),
        ("1/min", 60.0, "reference_rad_s", 6.283185307),
        ("°/s", 180.0, "reference_rad_s", 3.141592654),
    ],
)
def test_what_is_advised_decodes_to_the_right_number(unit: str, value: float, signal: str, truth: float) -> None:
    text = doubt(unit, signal)
    assert text.startswith(f"it is in {unit}, and {signal} ")
    (message,) = load_string(database(unit), "dbc").messages
    taken = received_message(message, [advised(text)], INPUTS)
    (decoded,) = taken.decode(message.encode({"Value": value}))
    assert decoded == pytest.approx(truth, rel=1e-6)
    assert unit_doubt(link(message, advised(text), SIGNALS), advised(text)) == ""


@pytest.mark.parametrize(
    ("signal", "truth", "unit", "value"),
    [
        ("current_a", 6.0, "mA", 6000.0),
        *(("motor_speed_rad_s", 314.159265, unit, 3000.0) for unit in ("rpm", "RPM", "U/min", "min-1", "min^-1")),
        *(("crank_angle_rad", 1.570796327, unit, 90.0) for unit in ("deg", "°", "Deg", "Â°", "\N{RING ABOVE}")),
        ("crank_angle_rad", 1.5, "mrad", 1500.0),
        ("crank_speed_rad_s", 5.235987756, "deg/s", 300.0),
        ("load_torque_n_m", 20.0, "Ncm", 2000.0),
        ("left_force_n", 7.5, "mN", 7500.0),
        ("left_force_n", 7.5, "kN", 0.0075),
        ("winding_temperature_c", 25.0, "degF", 77.0),
        ("winding_temperature_c", 25.0, "K", 298.15),
        ("wetness", 0.5, "%", 50.0),
        ("water_film_mm", 0.3, "µm", 300.0),
        ("water_film_mm", 0.3, "m", 0.0003),
        ("left_blade_m_s", 1.2, "mm/s", 1200.0),
        ("worst_latency_us", 1500.0, "ms", 1.5),
    ],
)
def test_what_is_advised_encodes_the_right_number(signal: str, truth: float, unit: str, value: float) -> None:
    bits = "32@1- (0.0001,0)"
    (message,) = load_string(database(unit, bits), "dbc").messages
    shown = sent_message(message, [advised(doubt(unit, signal, bits))], PUBLISHED, Timing(0))
    row = [0.0] * len(PUBLISHED)
    row[PUBLISHED_INDEX[signal]] = truth
    payload, limited = shown.encode(row)
    assert limited == 0
    assert message.decode(payload)["Value"] == pytest.approx(value, abs=6e-5)


@pytest.mark.parametrize(
    ("unit", "signal", "more"),
    [
        *((unit, "current_a", {}) for unit in ("A", "Ampere", "[A]", "", "-", "1", "bit", "?", "state")),
        *(
            (unit, "ambient_temperature_c", {})
            for unit in ("degC", "°C", "C", "Â°C", "deg C", "ºC", "\N{DEGREE CELSIUS}")
        ),
        *((unit, "brake_torque_n_m", {}) for unit in ("Nm", "N m", "N*m", "N·m", "N.m")),
        *((unit, "vehicle_speed_m_s", {}) for unit in ("m/s", "M/S", "m s^-1", "mps")),
        ("rad/s", "reference_rad_s", {}),
        ("us", "worst_latency_us", {}),
        ("\N{GREEK SMALL LETTER MU}s", "worst_latency_us", {}),
        ("mm", "water_film_mm", {}),
        ("km/h", "vehicle_speed_m_s", {"scale": 0.278}),  # within 1 %
        ("mA", "current_a", {"scale": -0.001}),  # the other direction
        ("deg", "crank_angle_rad", {"scale": 0.01745, "offset": 3.1416}),  # another zero
        ("K", "ambient_temperature_c", {"offset": -273.0}),
        ("degF", "ambient_temperature_c", {"scale": 0.5556, "offset": -17.78}),
        ("%", "screen", {"scale": 0.01}),
        ("V", "current_a", {"scale": 20.0}),  # a shunt
        ("%", "rain_mm_h", {"scale": 0.5}),
        ("A", "supply_v", {"scale": 2.0}),
    ],
)
def test_what_agrees_or_is_made_up_for_is_no_doubt(unit: str, signal: str, more: dict[str, float]) -> None:
    assert doubt(unit, signal, **more) == ""


@pytest.mark.parametrize(
    ("unit", "signal", "more", "wanted"),
    [
        ("mA", "current_a", {"scale": 1000.0}, "scale: 0.001}"),  # the wrong way round
        ("mA", "current_a", {"scale": -1.0}, "scale: -0.001}"),
        ("deg", "crank_angle_rad", {"offset": 3.0}, "scale: 0.0174532925, offset: 3}"),
        ("km/h", "vehicle_speed_m_s", {"scale": 0.25}, "scale: 0.277777778}"),
        ("K", "ambient_temperature_c", {"offset": 273.15}, "offset: -273.15}"),
        ("degF", "ambient_temperature_c", {"scale": 0.5556}, "scale: 0.555555556, offset: -17.7777778}"),
        ("%", "screen", {"scale": 0.1}, "scale: 0.01}"),
    ],
)
def test_a_scale_or_offset_that_does_not_make_up_for_the_unit(
    unit: str, signal: str, more: dict[str, float], wanted: str
) -> None:
    assert doubt(unit, signal, **more).endswith(f"write 'Value: {{signal: {signal}, {wanted}'")


@pytest.mark.parametrize(
    ("unit", "signal", "more", "said"),
    [
        (
            "V",
            "current_a",
            {},
            "it is in V, and current_a in A: map another signal, or write the scale between the two",
        ),
        ("mV", "current_a", {"scale": 0.001}, "it is in mV, and current_a in A: map another signal"),
        ("%", "supply_v", {}, "it is in %, and supply_v in V: map another signal"),
        ("degC", "screen", {}, "it is in degC, and screen has no unit: map another signal"),
        ("Hz", "motor_speed_rad_s", {}, "it is in Hz, and motor_speed_rad_s in rad/s: map another signal"),
        ("V", "overruns", {}, "it is in V, and overruns has no unit: map another signal"),
        ("s", "intermittent_switch", {}, "it is in s, and intermittent_switch has no unit: map another signal"),
    ],
)
def test_a_unit_of_another_quantity(unit: str, signal: str, more: dict[str, float], said: str) -> None:
    assert doubt(unit, signal, **more).startswith(said)


def test_a_flag_or_choice_with_a_unit_wants_choices_and_has_no_doubt_with_them() -> None:
    bits = "8@1+ (1,0)"
    for unit in ("V", "%"):
        text = doubt(unit, "relay_on", bits)
        assert text == f"it is in {unit}, and relay_on has no unit: say by choices which of its values are off and on"
        assert doubt(unit, "relay_on", bits, choices={"0": "off", "100": "on"}) == ""
    assert doubt("V", "master_input", bits).endswith("its values are off, intermittent, slow, fast")
    assert doubt("%", "screen", bits, choices={"0": "dry", "100": "wet"}) == ""


def test_every_unit_of_the_plant_is_one_that_is_known() -> None:
    assert {signal.unit for signal in SIGNALS if quantity_of(unit_of(signal.unit)) is None} == set()


def test_check_tells_it_with_file_and_line_for_plant_and_ecu(tmp_path: Path) -> None:
    own = """VERSION "1"
BU_: A B
BO_ 291 Cmd: 8 A
 SG_ On : 0|1@1+ (1,0) [0|1] "" B
 SG_ Spd : 24|16@1+ (0.01,0) [0|300] "km/h" B
BO_ 512 Stat: 8 B
 SG_ Curr : 0|16@1- (1,0) [0|0] "mA" A
BO_ 513 Stick: 8 A
 SG_ Gap : 0|8@1+ (1,0) [0|0] "s" B
"""
    (tmp_path / "own.dbc").write_text(own, encoding="cp1252")
    bench = tmp_path / "bench.yaml"
    bench.write_text("""name: x
extends: default.yaml
bus:
  database: own.dbc
  receive:
    Cmd:
      timeout_ms: 100
      signals:
        On: relay_on
        Spd: vehicle_speed_m_s
  send: {Stat: {period_ms: 10, signals: {Curr: current_a}}}
ecu:
  receive: {Stick: {timeout_ms: 100, signals: {Gap: intermittent_switch}}}
""")
    told = [
        "bench.yaml:10: warning: Cmd.Spd: it is in km/h, and vehicle_speed_m_s in m/s: "
        "write 'Spd: {signal: vehicle_speed_m_s, scale: 0.277777778}'",
        "bench.yaml:11: warning: Stat.Curr: it is in mA, and current_a in A: "
        "write 'Curr: {signal: current_a, scale: 0.001}'",
        "bench.yaml:13: warning: Stick.Gap: it is in s, and intermittent_switch has no unit: "
        "map another signal, or write the scale between the two",
    ]
    assert check_bench(bench) == []
    figures = tmp_path / "figures.json"
    result = CliRunner().invoke(app, ["check", str(bench), "--json", str(figures)])
    assert result.exit_code == 0
    written = json.loads(figures.read_text())
    assert [text[text.index("bench.yaml") :] for text in written["warning_messages"]] == told
    assert all(line in result.output for line in written["warning_messages"])


@pytest.mark.parametrize("name", sorted(path.stem for path in shipped("config", "benches").glob("*.yaml")))
def test_no_shipped_bench_has_units_that_contradict(name: str) -> None:
    assert [str(warning) for warning in load_bench(name).warnings if "it is in" in warning.text] == []
