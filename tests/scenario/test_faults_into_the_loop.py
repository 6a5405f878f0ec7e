"""Faults from beside the bus: there in the tick that is told, visible, released, cleared, recorded, and replayed."""

import json
import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.channel_rig import Run
from support.loop_rig import STEP_NS

from hilplant.faults.catalogue import FAULTS, NUMBERS, fault_named
from hilplant.models.records import PARAMETER_INDEX
from hilplant.recording.reader import read_recording
from hilplant.recording.recorder import description_now
from hilplant.recording.replay import replay
from hilplant.recording.rotation import Rotation
from hilplant.recording.writer import RecordingWriter, late_description
from hilplant.runtime import commands as c
from hilplant.runtime.held_faults import MOST_FAULTS
from hilplant.runtime.row import ROW_WIDTH
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUTS, STATUS_INDEX

RESISTANCE = PARAMETER_INDEX["wiring.wire_53.resistance_ohm"]
RELAY_ON = INPUT_INDEX["relay_on"]
FAULT_STATUS = 0x216


@pytest.fixture
def run() -> Iterator[Run]:
    run = Run(bench="polynomial")
    yield run
    run.close()


def insert(run: Run, fault: str, client: int = 1, lease_ns: int = 0, **keys: Any) -> None:
    run.post(c.FAULT, client=client, lease_ns=lease_ns, text=json.dumps({"fault": fault} | keys).encode())


def clear(run: Run, name: str = "", client: int = 1) -> None:
    run.post(c.CLEAR, client=client, text=name.encode())


def active(run: Run) -> tuple[int, int]:
    status = run.ring.latest()[2 + len(INPUTS) + len(OUTPUTS) :]
    return int(status[STATUS_INDEX["faults_active"]]), int(status[STATUS_INDEX["fault_shown"]])


def told(run: Run) -> list[tuple[int, str, str]]:
    found = run.follower.events().records
    return [(int(e["tick"]), c.KINDS[e["kind"]], c.OUTCOMES[e["outcome"]]) for e in found if e["kind"] != c.PARAMETER]


def test_a_fault_is_there_in_the_tick_that_is_told_and_goes_in_the_one_that_is_told(run: Run) -> None:
    run.tick(3)
    insert(run, "resistance_53", **{"with": {"resistance_ohm": 0.5}, "for": 0.004})
    run.tick()
    assert active(run) == (1, NUMBERS["resistance_53"])
    assert run.loop._parameters[RESISTANCE] == run.bench.parameter_row[RESISTANCE] + 0.5
    run.tick(4)
    assert active(run) == (0, 0)
    assert np.array_equal(run.loop._parameters, run.bench.parameter_row)
    assert told(run) == [(3, "fault", "applied"), (3, "comes", "applied"), (7, "goes", "applied")]


def test_a_fault_of_the_bus_acts_on_the_frames_of_its_tick(run: Run) -> None:
    run.tick(30, command_every=10)
    assert run.input(RELAY_ON) == 1.0
    insert(run, "frames_lost", message="RelayCommand")
    run.tick(501, command_every=10)
    assert run.input(RELAY_ON) == 0.0, "the plant lets go 500 ms after the last command that it has heard"
    clear(run)
    run.tick(11, command_every=10)
    assert run.input(RELAY_ON) == 1.0


def test_a_fault_goes_when_its_client_is_silent_for_the_lease(run: Run) -> None:
    insert(run, "supply_open", lease_ns=50 * STEP_NS)
    run.tick(30)
    run.post(c.ALIVE)  # in tick 30
    run.post(c.ALIVE, client=2)
    run.tick(50)
    assert active(run)[0] == 1
    run.tick()
    assert active(run)[0] == 0
    assert np.array_equal(run.loop._parameters, run.bench.parameter_row)
    assert told(run)[2:] == [(80, "clear", "lease over"), (80, "goes", "applied")]


def test_a_client_clears_its_own_faults_alone(run: Run) -> None:
    insert(run, "supply_open")
    insert(run, "park_stuck_open")
    for name in ("supply_open", "open_53"):
        clear(run, name, client=2)
    run.tick()
    assert [outcome for _, kind, outcome in told(run) if kind == "clear"] == ["held by another client", "not held"]
    clear(run, "supply_open")
    run.tick()
    assert active(run) == (1, NUMBERS["park_stuck_open"])
    clear(run, client=2)  # all of its own: none
    run.tick()
    assert active(run)[0] == 1
    clear(run)
    run.tick()
    assert active(run)[0] == 0


def test_the_same_fault_again_takes_the_place_of_the_one_before(run: Run) -> None:
    for resistance in (0.5, 0.7):
        insert(run, "resistance_53", **{"with": {"resistance_ohm": resistance}})
        run.tick()
        assert run.loop._parameters[RESISTANCE] == resistance
        assert active(run)[0] == 1
    insert(run, "resistance_53", client=2, **{"with": {"resistance_ohm": 1.0}})
    run.tick()
    assert run.loop._parameters[RESISTANCE] == 0.7
    assert run.follower.events().records["text"][-1] == b"held by another client"


def test_frames_of_two_messages_can_be_lost_at_once(run: Run) -> None:
    insert(run, "frames_lost", message="RelayCommand")
    insert(run, "frames_lost", message="SupplyCommand")
    run.tick()
    assert active(run)[0] == 2


def test_a_parameter_changed_under_a_fault_is_there_with_it_and_stays_after_it(run: Run) -> None:
    base, damping = run.bench.parameter_row, PARAMETER_INDEX["motor.coulomb_torque_n_m"]
    insert(run, "stiff_bearing", **{"with": {"torque_n_m": 0.2}})
    run.tick()
    run.post(c.PARAMETER, damping, 0.05)
    run.tick()
    assert run.loop._parameters[damping] == 0.05 + 0.2
    clear(run)
    run.tick()
    assert run.loop._parameters[damping] == 0.05
    assert base[damping] != 0.05


@pytest.mark.parametrize(
    ("written", "text"),
    [
        ({"fault": "open_54"}, "there is no fault 'open_54'"),
        ({"fault": "resistance_53"}, "needs resistance_ohm"),
        ({"fault": "frames_lost", "message": "ParkSwich"}, "did you mean"),
        ({"fault": "crc_wrong", "message": "ParkSwitch"}, "no protection"),
        ({"fault": "value_wrong", "message": "ParkSwitch", "signal": "Park", "value": 1}, "no signal 'Park'"),
        ({"fault": "open_53", "when": {"curent_a": {"above": 1}}}, "curent_a"),
        ({"fault": "open_53", "sometimes": True}, "sometimes"),
        ([], "one JSON object"),
    ],
)
def test_what_cannot_be_is_refused_with_its_reason_and_changes_nothing(run: Run, written: Any, text: str) -> None:
    run.post(c.FAULT, text=json.dumps(written).encode())
    run.post(c.FAULT, text=b"\xff{")
    run.tick()
    refused, garbled = run.follower.events().records
    assert c.OUTCOMES[refused["outcome"]] == c.OUTCOMES[garbled["outcome"]] == "refused"
    assert text in refused["text"].decode()
    assert active(run) == (0, 0)


def test_the_bus_tells_how_many_there_are_and_names_each_in_turn(run: Run) -> None:
    sent = run.transport.sent
    run.tick(5)
    sent.clear()
    for fault in ("supply_open", "park_stuck_open", "left_blade_off"):
        insert(run, fault)
    run.tick()
    first = [frame.data for frame in sent if frame.identifier == FAULT_STATUS]
    assert [data[0] for data in first] == [3], "at once"
    run.tick(310)
    shown = [frame.data[1] for frame in sent if frame.identifier == FAULT_STATUS]
    assert set(shown) == {NUMBERS[name] for name in ("supply_open", "park_stuck_open", "left_blade_off")}
    clear(run)
    sent.clear()
    run.tick()
    assert [frame.data for frame in sent if frame.identifier == FAULT_STATUS] == [bytes(2)]


def test_what_is_over_is_forgotten_and_too_many_are_refused(run: Run) -> None:
    for number in range(3 * MOST_FAULTS):
        insert(run, "frames_lost", message="ParkSwitch", **{"for": 0.001}, client=number)
        run.tick(3)
    acting = run.loop.intake.faults._acting  # type: ignore[union-attr]
    assert len(acting._there) == len(acting._player.courses) == 1
    assert len(acting.transport._out.faults) == 1
    for fault in (*FAULTS, *[fault_named("frames_lost")] * 40):
        number += 1
        keys = {"with": {each.name: each.maximum for each in fault.quantities}}
        insert(run, fault.name, client=number, at=1.0, **keys | ({"direction": "to plant"} if fault.on_frames else {}))
        run.tick()
    refused = [e for e in run.follower.events().records if e["outcome"] == c.REFUSED]
    assert refused
    assert {e["text"] for e in refused} <= {b"there are 64 faults already", b"held by another client"}


def randomly(run: Run, seed: int, ticks: int) -> None:
    """Insert, clear and change at random, for a while."""
    chance = random.Random(seed)
    plant = [fault for fault in FAULTS if not fault.name.startswith("current_sensor_noise")]
    for _ in range(ticks):
        draw = chance.random()
        if draw < 0.05:
            fault = chance.choice(plant)
            values = {q.name: chance.uniform(q.minimum, min(q.maximum, 2.0)) for q in fault.quantities}
            more = {"with": values, "for": chance.choice([0.002, 0.03]), "ramp": chance.choice([0.0, 0.01])}
            insert(run, fault.name, chance.randrange(1, 4), at=chance.choice([0.0, 0.005]), **more)
        elif draw < 0.06:
            clear(run, client=chance.randrange(1, 4))
        elif draw < 0.08:
            name = chance.choice(["motor.damping_n_m_s", "motor.coulomb_torque_n_m"])
            run.post(c.PARAMETER, PARAMETER_INDEX[name], chance.uniform(0.0, 1e-3))
        elif draw < 0.10:
            insert(run, "frames_lost", chance.randrange(1, 4), message="RelayCommand", **{"for": 0.6})
        run.tick(command_every=20)


@pytest.mark.parametrize("seed", range(5))
def test_a_run_with_random_faults_replays_bit_for_bit_whole_in_parts_and_begun_late(
    run: Run, tmp_path: Path, seed: int
) -> None:
    metadata = description_now(run.bench)
    randomly(run, 100 + seed, 60)
    run.ring.skip_history()
    run.tick()
    rotation = Rotation(part_ns=50 * STEP_NS) if seed % 2 else None
    path = tmp_path / "run.hilrec"
    writer = RecordingWriter(path, late_description(metadata, run.ring), ROW_WIDTH, rotation)
    randomly(run, seed, 200)
    writer.take(run.ring)
    writer.write(last=True)
    writer.close()
    result = replay(path)
    assert result.equal, result
    assert result.ticks == 201
    assert all(replay(part).equal for part in tmp_path.iterdir())
    events = read_recording(path).table(["events"]).column("events").combine_chunks().flatten().to_pylist()
    assert {"fault", "comes", "goes", "parameter"} <= {event["kind"] for event in events}
