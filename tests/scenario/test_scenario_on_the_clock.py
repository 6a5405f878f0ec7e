"""A scenario played into a running loop: time 0, inputs, relays and faults, and the verdicts, live and afterwards."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.channel_rig import Run
from support.loop_rig import SLOW
from typer.testing import CliRunner

from hilplant.bench import Bench, load_bench
from hilplant.cli.main import app
from hilplant.failure import Failure
from hilplant.recording.replay import replay
from hilplant.runtime import commands as c
from hilplant.runtime.follower import Follower
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.player import ScenarioPlayer
from hilplant.simulation.scenario import Scenario, load_scenario
from hilplant.testing.known_signals import database_signals, protections_of
from hilplant.testing.live import LiveJudge
from hilplant.testing.scenario_test import Judged, expected, run_virtually, ticks_of
from hilplant.testing.virtual_bench import VirtualBench

SUPPLY_V, RELAY_ON = INPUT_INDEX["supply_v"], INPUT_INDEX["relay_on"]

WIPES = """
title: wipes
seconds: 0.6
signals:
  relay_on: [[0.05, true], [0.4, false]]
  supply_v: [[0, 12], [0.3, {ramp_to: 10, seconds: 0.1}]]
faults:
  - {fault: resistance_53, with: {resistance_ohm: 0.4}, at: 0.1, for: 0.1}
  - {fault: frames_lost, message: ParkSwitch, at: 0.2, for: 0.2}
expect:
  - {always: current_a, below: 30}
  - {always: current_a, below: 3, until: 0.5}
  - {within: 0.2, signal: park_contact, equals: 0}
  - {settles: supply_v, to: 10, tolerance: 0.01, by: 0.5, hold: 0.05}
  - {response: {relay_on: rises}, then: {MotorCurrent: {above: 1}}, within: 0.03}
  - {count: {relay_on: rises}, equals: 1}
  - {frames: MotorStatus, period_ms: [0, 11], after: 0.01, until: 0.59}
  - {frames: RelayCommand, period_ms: [0, 51], after: 0.06}
  - {frames: PlantStatus, missing: 0, until: 0.5}
  - {never: {ParkContact: 1}, after: 0.5}
  - {within: 0.2, signal: park_contact, equals: 0, after: {crank_angle_rad: {above: 7}}}
"""


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("polynomial")


def scenario(folder: Path, text: str) -> Scenario:
    (folder / "own.yaml").write_text(text)
    return load_scenario(folder / "own.yaml")


class Played(Run):
    """A loop that plays a scenario, judged live."""

    def __init__(self, wanted: Scenario) -> None:
        super().__init__(bench="polynomial")
        intake = self.loop.intake
        assert intake is not None
        self.ended: list[int] = []
        self.player = ScenarioPlayer(
            wanted,
            self.bench,
            (intake.faults, intake.faults.transport, self.loop.line),
            lambda: self.ended.append(self.now),
        )
        intake.source = self.player
        database = database_signals(self.bench.sources, protections_of(self.bench))
        expectations = expected(wanted, database, self.bench.step_ns)
        self.judge = LiveJudge(expectations, database, self.bench.step_ns, ticks_of(wanted, self.bench.step_ns))
        self.beside = Follower(self.ring.name, history=True)

    def look(self) -> list[Judged]:
        return list(self.judge.look(self.beside))

    def close(self) -> None:
        self.beside.close()
        super().close()


def _said(judged: list[Judged] | tuple[Judged, ...]) -> list[object]:
    return [
        (j.expectation.text, j.judgement.ruling, j.judgement.tick, repr(j.judgement.robustness), j.judgement.reason)
        for j in judged
    ]


@pytest.fixture
def played(tmp_path: Path) -> Iterator[Played]:
    made = Played(scenario(tmp_path, WIPES))
    yield made
    made.close()


def test_live_on_a_loop_and_in_virtual_time_the_verdicts_are_the_same(played: Played, bench: Bench) -> None:
    virtual = run_virtually(played_scenario(played), bench, stand_in=False)
    early = []
    while not played.ended:
        played.tick(25)
        early += played.look()
    found = played.judge.end()
    assert _said(found) == _said(virtual.judged)
    assert {each.judgement.ruling for each in found} >= {"pass", "fail", "blocked"}
    told = {each.expectation.text: each.judgement.ruling for each in early}
    assert told.items() <= {each.expectation.text: each.judgement.ruling for each in found}.items()
    assert sorted(told.values()) == ["fail", "pass", "pass"], "what can be known early is told early"


def played_scenario(played: Played) -> Scenario:
    assert played.bench.name
    return load_scenario(next(iter(played.judge._live)).place.rpartition(":")[0])


def test_ticks_that_are_lost_in_a_window_leave_it_inconclusive(tmp_path: Path) -> None:
    played = Played(scenario(tmp_path, WIPES))
    while not played.ended:
        played.tick(25)
        played.now += 3  # as a loop that came late
        played.look()
    rulings = {each.judgement.ruling for each in played.judge.end()}
    assert rulings <= {"inconclusive", "blocked"}
    played.close()


def test_the_last_ticks_lost_leave_it_inconclusive(tmp_path: Path) -> None:
    """What holds at every tick that was seen may be broken in those at the end that were not."""
    played = Played(scenario(tmp_path, f"{WIPES}  - {{always: current_a, below: 100}}\n"))
    length = ticks_of(played_scenario(played), played.bench.step_ns)
    while played.now < length - 40:
        played.tick(20)
        played.look()
    played.now = length
    played.tick(1)
    played.look()
    assert played.ended
    (always,) = [each.judgement for each in played.judge.end() if each.expectation.text.endswith("below: 100")]
    assert (always.ruling, always.tick) == ("inconclusive", length - 1)
    played.close()


def test_inputs_are_the_scenarios_and_relays_go_over_the_bus(played: Played) -> None:
    played.tick(1)
    assert (played.input(SUPPLY_V), played.owner(SUPPLY_V)) == (12.0, "scenario")
    played.tick(60)
    assert (played.input(RELAY_ON), played.owner(RELAY_ON)) == (1.0, "bus")
    assert any(frame.identifier == SLOW.identifier for frame in played.transport.sent), "others hear it too"
    kinds = [kind for _, kind, _ in played.events()]
    assert kinds[0] == "start"


@pytest.mark.parametrize(
    ("start", "first"),
    [("first tick", 0), ("first command", 21), ("{supply_v: {below: 9}}", 31), ("{relay_on: rises}", 21)],
)
def test_time_0_is_the_first_tick_or_the_one_after_its_condition(tmp_path: Path, start: str, first: int) -> None:
    played = Played(scenario(tmp_path, f"seconds: 0.1\nstart: {start}\nsignals: {{screen: [[0.01, wet]]}}\n"))
    played.tick(20)
    played.transport.arrived.append(SLOW)
    played.tick(10)
    played.post(c.SET, SUPPLY_V, 8.0)
    played.tick(200)
    assert played.ended == [first + 100]
    starts = [tick for tick, kind, _ in played.events() if kind == "start"]
    assert starts == [first]
    played.close()


def test_a_start_that_does_not_come_has_its_limit_and_all_is_blocked(tmp_path: Path, bench: Bench) -> None:
    text = "seconds: 1\nstart: {relay_on: rises}\nstart_within: 0.05\nexpect: [{always: current_a, below: 5}]\n"
    wanted = scenario(tmp_path, text)
    played = Played(wanted)
    played.tick(60)
    played.look()
    assert played.ended == [50]
    assert [each.judgement.ruling for each in played.judge.end()] == ["blocked"]
    played.close()
    assert run_virtually(wanted, bench, stand_in=False).ruling == "blocked"


def test_in_virtual_time_the_stand_in_ecu_hears_the_stalk_from_time_0_on(tmp_path: Path, bench: Bench) -> None:
    text = "seconds: 0.2\nstart: {crank_angle_rad: {above: -1}}\nstalk: [[0.1, slow]]\n"
    virtual = VirtualBench(bench, scenario(tmp_path, text))
    virtual.run_scenario()
    rows = virtual.tape.read_rows()
    assert virtual.player is not None
    assert virtual.player.start_ns is not None
    begun = virtual.player.start_ns // bench.step_ns
    assert begun > 0
    assert len(rows) == begun + 200
    on = rows[:, 2 + RELAY_ON].argmax()
    assert begun + 100 < on <= begun + 107


def test_a_start_that_names_nothing_is_a_mistake_with_its_line(tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"own.yaml:2: .*no signal 'curent_a'"):
        scenario(tmp_path, "seconds: 1\nstart: {curent_a: {above: 1}}\n")


@pytest.mark.parametrize(("limit", "code"), [(30, 0), (3, 1)])
def test_the_daemon_plays_judges_and_its_recording_gets_the_same_verdict(tmp_path: Path, limit: int, code: int) -> None:
    text = WIPES[: WIPES.index("expect:")] + f"expect:\n  - {{always: current_a, below: {limit}}}\n"
    (tmp_path / "own.yaml").write_text(text)
    recording, told = tmp_path / "run.hilrec", tmp_path / "run.json"
    channel = f"played-{os.getpid()}-{limit}"
    done = subprocess.run(
        [
            *(sys.executable, "-m", "hilplant", "run", "virtual", "--channel", channel),
            *("--scenario", str(tmp_path / "own.yaml"), "--record", str(recording), "--json", str(told)),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    summary = json.loads(told.read_text())
    judged = CliRunner().invoke(app, ["judge", str(recording), str(tmp_path / "own.yaml"), "--json", str(told)])
    assert summary["scenario_ruling"] == json.loads(told.read_text())["results"][0]["ruling"], done.stdout
    assert f"own.yaml:11: {summary['scenario_ruling']}: always: current_a, below: {limit}" in done.stdout
    if not summary["overruns"]:
        assert (done.returncode, judged.exit_code) == (code, code), done.stdout + done.stderr
    assert replay(recording).equal
