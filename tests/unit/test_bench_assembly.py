"""What a bench becomes: the shipped ones, the rows for compiled code, the messages of both sides."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hilplant import load_bench
from hilplant.bench import Bench, check_bench
from hilplant.resources import named, shipped
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUTS, PUBLISHED, PUBLISHED_INDEX

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
    assert bench.parameters.load == (1.0, 0.0035, 0.2738)
    assert np.degrees(bench.parameters.park_switch[:3]).tolist() == pytest.approx([0.0, 7.0, 0.5])
    assert bench.interface == {"interface": "socketcan", "channel": "vcan0"}
    assert bench.safe == ((INPUT_INDEX["relay_on"], 0.0), (INPUT_INDEX["relay_fast"], 0.0))
    assert bench.input_row[INPUT_INDEX["supply_v"]] == 13.5
    assert bench.loop.reopen_ms == (100, 2000)


def test_rows_and_tables_are_what_compiled_code_takes(bench: Bench) -> None:
    for row, length in ((bench.parameter_row, 22), (bench.state_row, 6), (bench.input_row, len(INPUTS))):
        assert row.dtype == np.float64
        assert row.shape == (length,)
    assert bench.tables.dtype == np.float64
    assert bench.tables.flags.c_contiguous
    assert bench.tables.shape[0] == 2


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
    inputs = [1.0, 1.0, 12.345, 1.0, 33.33, 0.0]
    heard = dict(zip([*INPUT_INDEX], inputs, strict=True))
    for sent, received in zip(ecu.send, bench.receive, strict=True):
        assert (sent.name, sent.identifier) == (received.name, received.identifier)
        payload, limited = sent.encode(inputs)
        assert limited == 0
        for target, value in zip(received.targets, received.decode(payload), strict=True):
            assert value == pytest.approx(heard[INPUTS[target].name], abs=0.005)
    shown = [0.5] * len(OUTPUTS) + [3.0] * (len(PUBLISHED) - len(OUTPUTS))
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
    assert [message.name for message in bench.receive] == ["RelayCommand", "SupplyCommand", "Environment"]
    assert [message.name for message in bench.ecu_side().send] == ["RelayCommand", "Environment"]


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
