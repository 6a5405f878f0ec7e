"""Faults in virtual time: those of a scenario and those of a test, what they leave behind, and what is refused."""

from pathlib import Path

import numpy as np
import pytest

from hilplant.bench import Bench, load_bench
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.run import simulate
from hilplant.simulation.scenario import Scenario, load_scenario
from hilplant.testing.evidence import recorded
from hilplant.testing.virtual_bench import VirtualBench
from hilplant.testing.wiper import WiperUnderTest


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("polynomial")


def scenario(folder: Path, text: str) -> Scenario:
    (folder / "own.yaml").write_text(text)
    return load_scenario(folder / "own.yaml")


FAULTS = """
seconds: 0.4
signals: {relay_on: [[0, true]]}
faults:
  - {fault: resistance_53, with: {resistance_ohm: 0.5}, at: 0.1, for: 0.1, ramp: 0.05}
  - {fault: supply_open, when: {current_a: {above: 5}}, at: 0.25, for: 0.01, pause: 0.02}
"""


def test_the_plant_s_faults_are_those_of_an_offline_run(bench: Bench, tmp_path: Path) -> None:
    wanted = scenario(tmp_path, FAULTS)
    virtual = VirtualBench(bench, wanted)
    virtual.run(400)
    offline = simulate(bench, wanted)
    begin = 2 + offline.inputs.shape[1]
    assert np.array_equal(virtual.tape.read_rows()[:, begin : begin + offline.outputs.shape[1]], offline.outputs)
    assert virtual.evidence().edges[0] == (100, "resistance_53", True)
    assert np.array_equal(bench.parameter_row, load_bench("polynomial").parameter_row), "the bench itself is as it was"


def test_a_fault_is_there_inside_its_with_and_gone_after_it(bench: Bench) -> None:
    wiper = WiperUnderTest(bench)
    wiper.send("RelayCommand", RelayOn=1)
    wiper.run(0.05)
    with wiper.fault("supply_open"):
        wiper.run(0.05)
        assert wiper["supply_current_a"] == 0.0
    wiper.run(0.05)
    assert wiper["supply_current_a"] > 0.5
    with wiper.fault("node_silent", direction="to plant"):
        wiper.run(0.6)
        assert wiper["relay_on"] == 0.0, "the plant lets go after 500 ms without a command"
    assert [there for _, name, there in wiper.virtual.evidence().edges if name == "supply_open"] == [True, False]


def test_times_of_a_fault_count_from_now(bench: Bench) -> None:
    wiper = WiperUnderTest(bench)
    wiper.run(0.02)
    wiper.insert_fault("park_stuck_open", at=0.01, for_=0.005)
    wiper.run(0.05)
    edges = wiper.virtual.evidence().edges
    assert edges == [(30, "park_stuck_open", True), (35, "park_stuck_open", False)]


@pytest.mark.parametrize(
    ("name", "keys", "text"),
    [
        ("park_stuck_opn", {}, "did you mean"),
        ("resistance_53", {"resistance_om": 1.0}, "resistance_ohm"),
        ("crc_wrong", {"message": "RelayCommand"}, "no protection"),
        ("frames_lost", {"message": "ParkSwich"}, "did you mean"),
        ("frames_lost", {"message": "ParkSwitch", "ramp": 1.0}, "cannot grow"),
        ("park_stuck_open", {"message": "ParkSwitch"}, "none of the bus"),
    ],
)
def test_a_fault_that_cannot_be_is_refused(bench: Bench, name: str, keys: dict[str, object], text: str) -> None:
    with pytest.raises(Failure, match=text):
        WiperUnderTest(bench).insert_fault(name, **keys)


def test_an_offline_run_has_no_bus(bench: Bench, tmp_path: Path) -> None:
    wanted = scenario(tmp_path, "seconds: 1\nfaults: [{fault: frames_lost, message: ParkSwitch}]\n")
    with pytest.raises(Failure, match=r"own.yaml:2: fault 'frames_lost' acts on frames"):
        simulate(bench, wanted)


def test_a_counter_that_stands_opens_the_relays_and_keeps_them_open_until_it_runs_again() -> None:
    wiper = WiperUnderTest(load_bench("protected"))
    wiper.send("RelayCommand", RelayOn=1)
    wiper.run(0.1)
    with wiper.fault("counter_stuck", message="RelayCommand"):
        wiper.run(0.6)
        wiper.expect.always("relay_on", equals="off", until=wiper.time_s + 1.2)
        wiper.run(1.2)
    assert wiper.judge() == []
    wiper.run(0.11)
    assert wiper["relay_on"] == 1.0


def test_a_recording_with_faults_of_plant_and_bus_replays(bench: Bench, tmp_path: Path) -> None:
    wiper = WiperUnderTest(bench)
    wiper.send("RelayCommand", RelayOn=1)
    wiper.insert_fault("frames_lost", direction="to plant", share=0.5, seed=2)
    wiper.insert_fault("value_wrong", message="RelayCommand", signal="RelayFast", value=1, at=0.1, for_=0.3)
    wiper.insert_fault("worn_brushes", resistance_ohm=0.4, at=0.15, for_=0.2, ramp=0.05)
    wiper.insert_fault("supply_open", when={"current_a": {"above": 2}}, for_=0.003, pause=0.02, probability=0.6)
    wiper.run(0.6)
    wiper.record(tmp_path / "run.hilrec")
    assert wiper.virtual.tape.read_rows()[:, 2 + INPUT_INDEX["relay_fast"]].any()
    result = replay(tmp_path / "run.hilrec")
    assert result.equal, result
    assert result.ticks == 600
    found = recorded(read_recording(tmp_path / "run.hilrec"))
    assert list(found.edges) == list(wiper.virtual.evidence().edges)
    assert {each.name for each in found.edges} == {"frames_lost", "value_wrong", "worn_brushes", "supply_open"}
