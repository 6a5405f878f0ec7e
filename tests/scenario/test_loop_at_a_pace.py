"""A loop on a slowed clock: its seconds take longer, and a machine that is late by less than such a tick loses none."""

from datetime import UTC, datetime
from pathlib import Path

import pytest
from support.loop_rig import STEP_NS, ListedTransport, Rig

from hilplant.bench import load_bench
from hilplant.failure import Failure
from hilplant.recording.metadata import describe, parse
from hilplant.runtime import clock
from hilplant.runtime.server import StopRequest, build_loop
from hilplant.runtime.watchdog import Watchdog
from hilplant.simulation.scenario import load_scenario
from hilplant.testing.on_interface import run_on_interface, server_command

TICKS, LATE_NS = 1000, 4_200_000


class Machine:
    """What the clock asks of the machine, whose every sleep ends late."""

    def __init__(self) -> None:
        self.time_ns = 7_000_000_123

    def monotonic_ns(self) -> int:
        return self.time_ns

    def sleep(self, seconds: float) -> None:
        self.time_ns += round(seconds * 1e9) + LATE_NS


@pytest.fixture
def machine(monkeypatch: pytest.MonkeyPatch) -> Machine:
    made = Machine()
    monkeypatch.setattr(clock, "time", made)
    return made


@pytest.mark.parametrize(("pace", "lost_a_tick"), [(1.0, 4), (0.5, 2), (0.2, 0), (0.1, 0), (0.01, 0)])
def test_a_tick_takes_longer_and_is_lost_only_when_all_of_that_is_over(
    machine: Machine, pace: float, lost_a_tick: int
) -> None:
    loop, begun_ns = build_loop(Rig().bench, ListedTransport(), clock.clock_at(pace)), machine.time_ns
    loop.run(TICKS, StopRequest(), Watchdog())
    took_ns, tick_ns = machine.time_ns - begun_ns, STEP_NS / pace
    assert loop.progress.overruns == pytest.approx(lost_a_tick * TICKS / (1 + lost_a_tick), abs=lost_a_tick)
    assert loop.progress.ticks + loop.progress.overruns == pytest.approx(TICKS, abs=1 + lost_a_tick)
    assert took_ns == pytest.approx(TICKS * tick_ns, abs=2 * tick_ns + LATE_NS)
    assert loop.latency.worst_ns == pytest.approx(LATE_NS * pace, abs=2)


@pytest.mark.parametrize("pace", [1.0, 0.3, 0.1, 0.001])
def test_the_time_of_the_machine_is_found_again(machine: Machine, pace: float) -> None:
    slow = clock.clock_at(pace)
    for later_ns in (0, 1, 999, 10**6, 86_400 * 10**9):
        machine.time_ns += later_ns
        assert slow.monotonic_ns(slow.now_ns()) == pytest.approx(machine.time_ns, abs=1 / pace + 1)


@pytest.mark.parametrize("pace", [1.0, 0.1])
def test_the_watchdog_is_fed_as_often_in_the_time_of_the_machine(pace: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("WATCHDOG_USEC", "3000000")
    assert Watchdog(pace).period_ns / pace == pytest.approx(1e9)


def test_a_recording_tells_the_pace() -> None:
    bench = load_bench("default")
    assert parse(describe(bench.at(pace=0.1), datetime(2026, 1, 1, tzinfo=UTC))).pace == 0.1
    assert parse(describe(bench, datetime(2026, 1, 1, tzinfo=UTC))).pace == 1.0


def test_the_server_of_a_test_keeps_the_pace_of_the_test(tmp_path: Path) -> None:
    scenario = tmp_path / "rest.yaml"
    scenario.write_text("seconds: 1\nexpect: [{never: {relay_on: on}}]\n")
    command = server_command(load_scenario(scenario), load_bench("virtual").at("c", 0.1), None, tmp_path / "r.hilrec")
    assert command[command.index("--pace") + 1] == "0.1"
    with pytest.raises(Failure, match=r"pace 0\.1 is for the stand-in ECU; an external ECU keeps its own time"):
        run_on_interface(load_scenario(scenario), load_bench("virtual").at(pace=0.1), "c", stand_in=False)
