"""What a bench says of its bus: both sides of it, the plant's and the ECU's, fit each other."""

from pathlib import Path

import pytest

from hilplant import load_bench
from hilplant.bench import Bench, check_bench
from hilplant.resources import shipped
from hilplant.signals import ECU_TX, INPUTS, OUTPUTS, PUBLISHED, PUBLISHED_INDEX


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


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
