"""What a bench becomes: the shipped ones, the rows for compiled code, the messages of both sides."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hilplant import load_bench
from hilplant.bench import Bench, check_bench
from hilplant.models.circuit import CIRCUITS
from hilplant.models.friction import coefficient
from hilplant.models.load import LOADS
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack, unpack
from hilplant.models.tables import LEFT_LIFT, RIGHT_LIFT, channels
from hilplant.resources import named, shipped
from hilplant.signals import ECU_TX, INPUT_INDEX, INPUTS, OUTPUTS, PUBLISHED, PUBLISHED_INDEX

BENCHES = sorted(path.stem for path in shipped("config", "benches").glob("*.yaml"))


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


@pytest.mark.parametrize("name", BENCHES)
def test_every_shipped_bench_loads_by_its_name(name: str) -> None:
    assert load_bench(name).name == name


def test_the_default_bench_holds_what_its_file_says(bench: Bench) -> None:
    assert bench.step_ns == 1_000_000
    assert bench.parameters.step_s == 0.001
    assert bench.parameters.motor.gear_ratio == 63.0
    load = bench.parameters.load
    assert (LOADS[int(load.model)], load.points) == ("reduced", 1.0)
    assert load.left_blade == load.right_blade == (7.615, 1.0)
    assert np.degrees(bench.parameters.park_switch[:3]).tolist() == pytest.approx([0.0, 7.0, 0.5])
    assert bench.parameters.park_switch[4:] == (0.0, 0.0)
    assert bench.interface == {"interface": "socketcan", "channel": "vcan0"}
    assert bench.safe == ((INPUT_INDEX["relay_on"], 0.0), (INPUT_INDEX["relay_fast"], 0.0))
    assert bench.input_row[INPUT_INDEX["supply_v"]] == 13.5
    assert bench.loop.reopen_ms == (100, 2000)


def test_the_default_friction_is_table_5_9_with_the_rules_that_tables_4_1_and_4_2_show(bench: Bench) -> None:
    friction = bench.parameters.load.friction
    assert friction[:4] == pytest.approx((0.3186, 0.1238, 1.996, 19.96))
    assert friction[4:11] == pytest.approx((0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3))
    assert friction.velocity_limit_mm_s == 1000.0
    peak, settled = friction.tacky_1 + friction.tacky_3, friction.dry_1 + friction.dry_3
    assert peak > friction.tacky_1 > settled > friction.wet_4, "tacky above dry above wet"


def test_the_polynomial_bench_is_the_default_one_with_another_load(bench: Bench) -> None:
    other = load_bench("polynomial")
    assert other.parameters.load[:3] == (1.0, 0.0035, 0.2738)
    assert other.parameters.motor == bench.parameters.motor
    assert other.tables[:, :2].tolist() == bench.tables[:, :2].tolist()


@pytest.mark.parametrize("points", [1, 5])
def test_rows_and_tables_are_what_compiled_code_takes(tmp_path: Path, points: int) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{load: {{model: reduced, points: {points}}}}}\n")
    bench = load_bench(path)
    parameters, state = pack(unpack(Parameters, bench.parameter_row)), pack(unpack(State, bench.state_row))
    assert (len(bench.parameter_row), len(bench.state_row)) == (len(parameters), len(state))
    assert parameters.tolist() == pack(bench.parameters).tolist()
    for row in (bench.parameter_row, bench.state_row, bench.input_row):
        assert row.dtype == np.float64
        assert row.ndim == 1
    assert bench.input_row.shape == (len(INPUTS),)
    assert bench.tables.dtype == np.float64
    assert bench.tables.flags.c_contiguous
    assert bench.tables.shape == (bench.tables.shape[0], channels(points), 2)
    assert bench.tables[0].tolist() == bench.tables[-1].tolist()


def test_what_the_files_say_reaches_the_records(tmp_path: Path) -> None:
    motor = shipped("config", "motors", "table_5_9.yaml").read_text()
    (tmp_path / "motor.yaml").write_text(motor + "gear_efficiency: 0.6\ngear_back_efficiency: 0.1\n")
    path = tmp_path / "bench.yaml"
    path.write_text(
        """
extends: default.yaml
name: x
plant:
  motor: motor.yaml
  screen: screens/table_4_2_friction_5.yaml
  blades:
    left: {force_n: 8, wear: 1.5, area_m2: 0.05, drag: 0.2, lift: [[90, 0.01], [135, 0.05], [200, 0.02]]}
    right: {force_n: 6}
  park_switch: {park_angle_deg: 0, window_deg: 10, circuit: depressed, reverse_angle_deg: 20}
inputs: {screen: tacky, left_screen: wet, right_screen: 0.25, right_wear: 3}
"""
    )
    bench = load_bench(path)
    load, motor_record = bench.parameters.load, bench.parameters.motor
    assert (motor_record.gear_efficiency, motor_record.gear_back_efficiency) == (0.6, 0.1)
    assert (load.left_blade, load.right_blade) == ((8.0, 1.5), (6.0, 1.0))
    assert load.friction.wet_7 == 0.05
    assert CIRCUITS[int(bench.parameters.park_switch.circuit)] == "depressed"
    assert np.degrees(bench.parameters.park_switch.reverse_angle_rad) == pytest.approx(20.0)
    inputs = {name: bench.input_row[index] for name, index in INPUT_INDEX.items()}
    assert [inputs[name] for name in ("screen", "left_screen", "right_screen", "right_wear")] == [0.5, 1.0, 0.25, 3.0]
    lift = bench.tables[:, LEFT_LIFT, 0]
    half_rho_area = 0.5 * 1.225 * 0.05
    assert lift.max() == pytest.approx(0.05 * half_rho_area, rel=1e-3), "the left arm passes 135 deg"
    assert not bench.tables[:, RIGHT_LIFT].any(), "no area, no lift"


@pytest.mark.parametrize("screen", sorted(path.stem for path in shipped("config", "screens").glob("*.yaml")))
def test_every_shipped_screen_keeps_the_rules_of_its_source_and_is_tackiest_with_little_water(
    tmp_path: Path, screen: str
) -> None:
    """mu_dry_4, mu_wet_2, mu_wet_5 are ten times another one; tacky friction is above dry at every speed."""
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{screen: screens/{screen}.yaml}}\n")
    friction = load_bench(path).parameters.load.friction
    ruled = (friction.dry_4, friction.wet_2, friction.wet_5)
    assert ruled == pytest.approx((10 * friction.dry_3, 10 * friction.wet_1, 10 * friction.wet_4))
    for speed_mm_s in (0.1, 1.0, 10.0, 100.0, 1000.0, 3000.0):
        dry, tacky = (coefficient(speed_mm_s, wetness, 10.0, friction)[0] for wetness in (0.0, 0.5))
        assert tacky > dry > 0.0


@pytest.mark.parametrize("motor", sorted(path.stem for path in shipped("config", "motors").glob("*.yaml")))
def test_every_shipped_motor_is_sound(tmp_path: Path, motor: str) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{motor: motors/{motor}.yaml}}\n")
    assert check_bench(path) == []


@pytest.mark.parametrize("linkage", sorted(path.stem for path in shipped("config", "linkages").glob("*.yaml")))
def test_every_shipped_linkage_is_sound_with_the_whole_load(tmp_path: Path, linkage: str) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{linkage: linkages/{linkage}.yaml}}\n")
    assert check_bench(path) == []


def test_a_parked_wiper_begins_with_its_contact_closed_and_another_one_does_not(tmp_path: Path) -> None:
    contacts = []
    for angle in (0.0, 0.12, 0.13, 3.0, 6.2):
        path = tmp_path / "bench.yaml"
        path.write_text(f"extends: default.yaml\nname: x\ninitial: {{crank_angle_rad: {angle}}}\n")
        contacts.append(load_bench(path).state_row[3])
    assert contacts == [1.0, 1.0, 0.0, 0.0, 1.0]


def test_supervision_and_periods_come_from_the_database_unless_the_bench_says_otherwise(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(
        """
extends: default.yaml
name: x
bus:
  receive:
    RelayCommand: {signals: {RelayOn: relay_on}}
    Environment: {timeout_ms: 250, signals: {VehicleSpeed: {signal: vehicle_speed_m_s, scale: 0.5}}}
  send:
    MotorStatus: {signals: {MotorCurrent: current_a}}
    ParkSwitch: {period_ms: 0, on_change: [park_contact], signals: {ParkContact: park_contact}}
"""
    )
    bench = load_bench(path)
    assert [(m.name, m.timeout_ns) for m in bench.receive] == [
        ("RelayCommand", 500_000_000),
        ("Environment", 250_000_000),
    ]
    assert [(m.name, m.period_ns) for m in bench.send] == [("MotorStatus", 10_000_000), ("ParkSwitch", 0)]
    assert bench.send[1].on_change == (PUBLISHED_INDEX["park_contact"],)
    assert bench.receive[1].decode(bytes([0, 0xE8, 0x03])) == (5.0,)  # 10 m/s by the database, halved


def test_the_two_sides_understand_each_other(bench: Bench) -> None:
    ecu = bench.ecu_side()
    numbers = {"supply_v": 12.345, "vehicle_speed_m_s": 33.33, "left_screen": -1.0, "right_screen": 0.37}
    heard = {signal.name: numbers.get(signal.name, min(signal.default + 0.5, signal.maximum)) for signal in ECU_TX}
    heard |= {signal.name: signal.maximum for signal in ECU_TX if signal.kind != "real" and signal.name not in numbers}
    inputs = [heard[signal.name] for signal in ECU_TX]
    for sent, received in zip(ecu.send, bench.receive, strict=True):
        assert (sent.name, sent.identifier) == (received.name, received.identifier)
        payload, limited = sent.encode(inputs)
        assert limited == 0
        for target, value in zip(received.targets, received.decode(payload), strict=True):
            assert value == pytest.approx(heard[INPUTS[target].name], abs=0.005)
    shown = [0.5] * len(OUTPUTS) + [min(3.0, signal.maximum) for signal in PUBLISHED[len(OUTPUTS) :]]
    for sent, received in zip(bench.send, ecu.receive, strict=True):
        payload, _ = sent.encode(shown)
        values = received.decode(payload)
        assert values == pytest.approx([shown[target] for target in received.targets], abs=0.51)


def test_a_protected_message_is_protected_on_both_sides(tmp_path: Path) -> None:
    database = shipped("dbc", "wiper.dbc").read_text().replace("RelayCommand: 2 ECU", "RelayCommand: 4 ECU")
    database = database.replace("SG_ RelayOn : 0|1@1+", "SG_ RelayOn : 16|1@1+")
    (tmp_path / "own.dbc").write_text(database)
    path = tmp_path / "bench.yaml"
    path.write_text(
        """
extends: default.yaml
name: x
bus:
  database: own.dbc
  receive:
    RelayCommand: {protection: {profile: 1, data_id: 0x123}, signals: {RelayOn: relay_on}}
"""
    )
    bench = load_bench(path)
    protection = bench.receive[0].protection
    assert protection is not None
    assert protection == bench.ecu_side().send[0].protection
    assert protection.data_id == 0x123


def test_the_text_of_every_file_is_kept_for_the_recording() -> None:
    sources = load_bench("virtual").sources
    names = {Path(name).name for name in sources}
    assert names == {"virtual.yaml", "default.yaml", "table_5_9.yaml", "rhd_slave_driven.yaml", "wiper.dbc"}
    assert sources[next(name for name in sources if name.endswith("virtual.yaml"))].startswith("#")


def test_an_own_interface_does_not_inherit_arguments_of_another(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: vector.yaml\nname: x\nbus:\n  interface: {interface: virtual, on: off}\n")
    assert load_bench(path).interface == {"interface": "virtual", "on": "off"}


def test_an_extending_bench_changes_one_key_of_a_section_and_keeps_the_others(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: x\nplant: {load: {model: none}}\ninputs: {supply_v: 12}\n")
    bench = load_bench(path)
    assert bench.parameters.load.model == 0.0
    assert bench.parameters.motor == load_bench("default").parameters.motor
    assert bench.input_row[INPUT_INDEX["supply_v"]] == 12.0


def test_a_name_is_a_path_first_and_a_shipped_file_otherwise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert named("benches", "default") == shipped("config", "benches", "default.yaml")
    assert named("benches", "default.yaml") == shipped("config", "benches", "default.yaml")
    (tmp_path / "default").write_text("")
    assert named("benches", "default") == Path("default")


def test_importing_the_package_loads_neither_compiler_nor_database_reader() -> None:
    code = "import sys, hilplant; print([m for m in ('numba', 'numpy', 'cantools', 'pydantic') if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_the_ecu_waits_ten_of_the_periods_at_which_the_bench_sends(tmp_path: Path) -> None:
    bench = tmp_path / "bench.yaml"
    section = "ParkSwitch: {period_ms: 500, signals: {ParkContact: park_contact}}"
    bench.write_text(f"extends: default.yaml\nname: slow\nbus:\n  send:\n    {section}\n")
    (park,) = load_bench(bench).ecu_side().receive
    assert park.timeout_ns == 5_000_000_000, "the database's cycle time is 20 ms"


def test_the_ecu_leaves_out_a_multiplexed_command_that_has_no_relay(tmp_path: Path) -> None:
    database = shipped("dbc", "wiper.dbc").read_text()
    paged = 'SupplyCommand: 3 ECU\n SG_ Page M : 16|8@1+ (1,0) [0|1] "" PLANT'
    database = database.replace("SupplyCommand: 2 ECU", paged)
    database = database.replace("SG_ SupplyVoltage :", "SG_ SupplyVoltage m1 :")
    (tmp_path / "own.dbc").write_text(database)
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: paged\nbus: {database: own.dbc}\n")
    bench = load_bench(path)
    assert [message.name for message in bench.receive] == ["RelayCommand", "SupplyCommand", "Environment", "Blades"]
    sent = [message.name for message in bench.ecu_side().send]
    assert {"RelayCommand", "Environment", "Blades"} <= set(sent)
    assert "SupplyCommand" not in sent


def test_an_fd_message_needs_an_interface_that_is_asked_for_fd(tmp_path: Path) -> None:
    database = shipped("dbc", "wiper.dbc").read_text()
    formats = 'BA_DEF_ BO_ "VFrameFormat" ENUM "StandardCAN","ExtendedCAN","StandardCAN_FD";'
    database = database.replace('BA_DEF_ "BusType" STRING ;', f'BA_DEF_ "BusType" STRING ;\n{formats}')
    database = database.replace('BA_ "BusType" "CAN";', 'BA_ "BusType" "CAN FD";\nBA_ "VFrameFormat" BO_ 288 2;')
    (tmp_path / "own.dbc").write_text(database)
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: fd\nbus: {database: own.dbc}\n")
    (problem,) = check_bench(path)
    assert problem.text == "RelayCommand: FD needs 'fd: true' here"
    interface = "{interface: socketcan, channel: vcan0, fd: true}"
    path.write_text(f"extends: default.yaml\nname: fd\nbus: {{database: own.dbc, interface: {interface}}}\n")
    assert check_bench(path) == []
