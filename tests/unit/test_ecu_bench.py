"""The ECU's section of a bench: its messages are built from it, and its mistakes are told with file and line."""

from pathlib import Path

import cantools
import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.bench.ecu_description import ControllerSettings
from hilplant.ecu.chart import Phase
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.vocabulary import Fault, Master, RelaySettings
from hilplant.resources import shipped
from hilplant.signals import ECU_FAULTS, ECU_RX, ECU_STATES, ECU_TX_INDEX, STALK_POSITIONS

DATABASE = cantools.database.load_file(shipped("dbc", "wiper.dbc"))


def bench(folder: Path, text: str) -> Path:
    path = folder / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\n{text}")
    return path


def test_the_shipped_stalk_is_read_as_cantools_writes_it() -> None:
    (stalk,) = load_bench().ecu_side().stalk
    written = {"Master_Input": "Fast", "Intermittent_Switch": 5, "Flick_Wipe": "Pressed", "Wash": "Released",
               "Automatic": "On"}  # fmt: skip
    values = stalk.decode(DATABASE.encode_message("StalkCommand", written))
    heard = {ECU_RX[target].name: value for target, value in zip(stalk.targets, values, strict=True)}
    assert heard == {"master_input": 3.0, "intermittent_switch": 5.0, "flick_wipe": 1.0, "wash": 0.0, "automatic": 1.0}
    assert stalk.timeout_ns == 0


def test_the_shipped_status_is_written_as_cantools_reads_it() -> None:
    (status,) = load_bench().ecu_side().status
    said = [0.0] * len(ECU_TX_INDEX)
    said[ECU_TX_INDEX["ecu_state"]] = float(ECU_STATES.index("wash_wipes"))
    said[ECU_TX_INDEX["ecu_fault"]] = 3.0
    said[ECU_TX_INDEX["ecu_tries"]] = 300.0
    data, _ = status.encode(said)
    shown = {name: str(value) for name, value in DATABASE.decode_message("EcuStatus", data).items()}
    assert shown == {"EcuState": "Wash_Wipes", "EcuFault": "Park_Never_Opens", "EcuTries": "255"}


RISING = "0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8"


def test_every_setting_of_the_controller_can_be_set(tmp_path: Path) -> None:
    changed = {
        "wash_wipes": 5, "debounce_s": 0.03, "turn_timeout_s": 6.0, "leave_timeout_s": 1.5, "bounce_edges": 20,
        "bounce_window_s": 2.0, "stall_current_a": 25.0, "stall_s": 0.7, "brown_out_v": 5.5, "resume_v": 7.5,
        "resume_s": 0.2, "tries": 4, "retry_pause_s": 1.0, "settle_s": 0.4,
        "rests_open": True, "warm_stall_current_a": 4.0, "warm_stall_s": 3.0, "rain_hold_s": 2.0,
    }  # fmt: skip
    written = "".join(f"  {name}: {str(value).lower()}\n" for name, value in changed.items())
    settings = controller_settings(
        load_bench(bench(tmp_path, f"ecu:\n  pauses_s: [1, 2, 3, 4, 5, 6]\n  rain_levels: [{RISING}]\n{written}")).ecu
    )
    assert settings._asdict() == changed | {
        "pauses_s": (1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
        "rain_levels": tuple(float(level) for level in RISING.split(",")),
    }


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("ecu: {pauses_s: [1, 2, 3]}", "3: pauses_s must have at least 6 entries, not 3"),
        ("ecu: {pauses_s: 3}", "3: pauses_s must be a list, not 3"),
        ("ecu: {pauses_s: [1, 2, 3, 4, 5, -6]}", "3: entry 6 of pauses_s must be greater than 0, not -6"),
        ("ecu: {pause_s: 3}", "3: unknown key 'pause_s', did you mean 'pauses_s'?"),
        ("ecu: {wash_wipes: 0}", "3: wash_wipes must be greater than or equal to 1, not 0"),
        ("ecu: {brown_out_v: 9}", "3: resume_v must be at least brown_out_v, which is 9"),
        ("ecu: {turn_timeout_s: 1}", "3: leave_timeout_s must be at most turn_timeout_s, which is 1"),
        ("ecu: {receive: {Stalk: {signals: {A: wash}}}}", "3: dbc/wiper.dbc has no message 'Stalk'"),
        (
            "ecu: {receive: {StalkCommand: {timeout_ms: 0, signals: {Wash: relay_on}}}}",
            "3: the plant has no signal 'relay_on' here",
        ),
        (
            "ecu: {receive: {StalkCommand: {timeout_ms: 50, signals: {Wash: wash}}}}",
            "3: timeout_ms must be longer than the message's cycle time of 100 ms, not 50",
        ),
        (
            "ecu: {send: {MotorStatus: {signals: {MotorCurrent: ecu_tries}}}}",
            "3: MotorStatus has the identifier 0x200 of MotorStatus; map one of them",
        ),
    ],
)
def test_mistakes_are_told_with_their_line(tmp_path: Path, section: str, said: str) -> None:
    texts = [f"{problem.line}: {problem.text}" for problem in check_bench(bench(tmp_path, section + "\n"))]
    assert any(said in text for text in texts), texts


def test_a_bench_with_a_database_of_its_own_need_not_have_the_shipped_stalk(tmp_path: Path) -> None:
    database = shipped("dbc", "wiper.dbc").read_text().replace("StalkCommand", "Lever").replace("EcuStatus", "Told")
    (tmp_path / "own.dbc").write_text(database)
    path = bench(tmp_path, "bus: {database: own.dbc}\n")
    assert check_bench(path) == []
    side = load_bench(path).ecu_side()
    assert side.stalk == side.status == ()


def test_the_names_on_the_bus_are_those_of_the_controller():
    assert tuple(phase.value for phase in Phase) == ECU_STATES
    assert tuple(fault.value for fault in Fault) == ECU_FAULTS
    assert tuple(position.name.lower() for position in Master) == STALK_POSITIONS
    assert [position.value for position in Master] == [0, 1, 2, 3], "Master_Input of Figure 8-7"


def test_the_benchs_defaults_are_the_controllers():
    assert set(ControllerSettings.model_fields) == set(RelaySettings._fields)
    assert controller_settings(ControllerSettings()) == RelaySettings()
