"""A scenario as a test on a CAN interface, on the clock: the server is a process of its own, the ECU here or not."""

import contextlib
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from hilplant.bench import Bench
from hilplant.bus.transport import Transport, open_transport
from hilplant.channel.run_files import RunFile, runs
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import stalk_at
from hilplant.ecu.stalk_sender import StalkSender
from hilplant.ecu.vocabulary import Stalk
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.runtime.clock import Clock, WallClock, clock_at
from hilplant.runtime.commands import START
from hilplant.runtime.follower import Follower
from hilplant.runtime.row import ROW_WIDTH
from hilplant.simulation.player import commands_relays
from hilplant.simulation.scenario import Scenario
from hilplant.testing.evidence import Evidence, recorded
from hilplant.testing.known_signals import database_signals, protections_of
from hilplant.testing.scenario_test import Judged, ScenarioTest, expected, judged
from hilplant.units import MILLISECOND_NS, SECOND_NS
from hilplant.verdicts.judgement import Judgement

#: How long the server may take to begin, as it may have to compile, and to end; and longer than its scenario [s].
_BEGIN_S, _END_S, _LONGER_S = 600.0, 60.0, 30.0
NO_END = "the server was killed, or had to be, before its end"
#: How a server ends whose run was what it was to be, or not.
_ENDS = (0, 1)
_LOOK_NS = MILLISECOND_NS
#: Who acts here and comes later than this has made the ticks in between unfit for a verdict [ns].
LATE_NS = 25 * MILLISECOND_NS


class Actor(Protocol):
    """Who acts on the bus beside the plant."""

    def act(self, now_ns: int, stalk: Stalk) -> None:
        """Do what is due, with the stalk where it is."""


def run_on_interface(
    scenario: Scenario, bench: Bench, channel: str, stand_in: bool = True, bench_name: str | None = None
) -> ScenarioTest:
    """Run a scenario on a channel of the bench's interface, at the bench's pace, and judge its recording.

    With `stand_in` the stand-in ECU joins from here; else this end moves the stalk, as the bench's stalk message.

    Raises
    ------
    Failure
        Where the interface cannot be opened, the bench has no such signals, or the server does not begin; and at
        another pace than 1 without the stand-in.

    """
    bench = bench.at(channel)
    if not stand_in and bench.pace != 1.0:
        raise Failure(f"{bench.name}: pace {bench.pace:g} is for the stand-in ECU; an external ECU keeps its own time")
    database = database_signals(bench.sources, protections_of(bench))
    expectations = expected(scenario, database, bench.step_ns)
    folder = tempfile.TemporaryDirectory(prefix="hilplant-test-")
    recording = Path(folder.name) / "run.hilrec"
    transport = open_transport(bench.interface)
    command = server_command(scenario, bench, bench_name, recording)
    with contextlib.closing(transport), serving(command, str(scenario.path), recording.exists) as process:
        acting = _Acting(scenario, bench, _actor(scenario, bench, (transport, stand_in)))
        late = acting.until_it_ends(process)
    options = (f" --bench {bench_name}" if bench_name else "") + ("" if stand_in else " --ecu external")
    options += "" if bench.pace == 1.0 else f" --pace {bench.pace:g}"
    rerun = f"hilplant test {scenario.path} --on {channel}{options}"
    if process.returncode not in _ENDS:
        nothing = Evidence(bench.step_ns, np.zeros((0, ROW_WIDTH)), np.zeros(0, np.int64), ())
        undecided = tuple(Judged(each, Judgement("inconclusive", reason=NO_END)) for each in expectations)
        step_s = bench.step_ns / SECOND_NS
        return ScenarioTest(scenario, bench.name, step_s, nothing, database, undecided, rerun)
    evidence = replace(recorded(read_recording(recording)), hidden=tuple(late))
    if scenario.start and not evidence.begun:  # its time 0 has not come
        evidence = replace(evidence, start=round(evidence.rows[-1, 1] / bench.step_ns) + 1)
    done = judged(scenario, bench.name, evidence, database, expectations, rerun)

    def record(path: Path, kept: tempfile.TemporaryDirectory[str] = folder) -> None:
        shutil.copyfile(Path(kept.name) / recording.name, path)

    return replace(done, record=record)


def server_command(scenario: Scenario, bench: Bench, bench_name: str | None, recording: Path) -> list[str]:
    """Return the command line of the server that plays a scenario on the bench's channel, at its pace."""
    command = [sys.executable, "-m", "hilplant", "run", bench_name or scenario.bench or "default"]
    command += ["--channel", bench.interface["channel"], "--pace", str(bench.pace)]
    command += ["--scenario", str(scenario.path), "--record", str(recording)]
    return [*command, "--no-channel", "--no-verdicts"]


@contextmanager
def serving(command: list[str], wanted_by: str, ran: Callable[[], bool]) -> Iterator[subprocess.Popen[bytes]]:
    """Start a server, wait for its end or bring it about; Failure with its words unless it `ran`."""
    with tempfile.TemporaryFile() as said:
        options: dict[str, Any] = {"stdout": said, "stderr": subprocess.STDOUT, "stdin": subprocess.DEVNULL}
        process = subprocess.Popen(command, **options)
        try:
            yield process
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(_END_S)
        finally:
            for ask in (process.terminate, process.kill):
                with contextlib.suppress(subprocess.TimeoutExpired):
                    if process.poll() is None:
                        ask()
                        process.wait(_END_S)
        if not ran():
            said.seek(0)
            raise Failure(f"{wanted_by}: the server did not run: {said.read().decode(errors='replace').strip()}")


@dataclass
class _Acting:
    """Lets the actor act in the loop's own time, for as long as the loop runs."""

    scenario: Scenario
    bench: Bench
    actor: Actor | None
    start_ns: int | None = None
    late: list[int] = field(default_factory=list)

    def until_it_ends(self, process: subprocess.Popen[bytes]) -> list[int]:
        """Act until the loop has ended or should have; returns the steps that are unfit because this end came late."""
        run = run_of(process, WallClock())
        if run is None:
            return []
        clock, pace = clock_at(self.bench.pace), self.bench.pace
        follower = Follower(run.ring, history=True)
        period_ns, acted_ns = round(self.bench.ecu.period_ms * MILLISECOND_NS), 0
        limit_ns = clock.now_ns() + round(_BEGIN_S * pace * SECOND_NS)
        longest_s = self.scenario.seconds + self.scenario.start_within + _LONGER_S * pace
        with contextlib.closing(follower):
            while not follower.ended and process.poll() is None and clock.now_ns() < limit_ns:
                now_ns = int(follower.latest()[1])
                if now_ns and not acted_ns:
                    limit_ns = clock.now_ns() + round(longest_s * SECOND_NS)
                for event in follower.events().records:
                    if event["kind"] == START and self.start_ns is None:
                        self.start_ns = int(event["time_ns"])
                if now_ns >= acted_ns + period_ns:
                    self._act(now_ns, acted_ns)
                    acted_ns = now_ns
                clock.sleep_until_ns(clock.now_ns() + _LOOK_NS)
        return self.late

    def _act(self, now_ns: int, acted_ns: int) -> None:
        if self.actor is None:
            return
        step_ns = self.bench.step_ns
        if acted_ns and now_ns - acted_ns > LATE_NS:
            self.late.extend(range(acted_ns // step_ns, now_ns // step_ns + 1))
        stalk_s = -1.0 if self.start_ns is None else (now_ns - self.start_ns) / SECOND_NS
        self.actor.act(now_ns, stalk_at(self.scenario.stalk, stalk_s))


def run_of(process: subprocess.Popen[bytes], clock: Clock) -> RunFile | None:
    """Wait for the loop of a server that was started; None where it has ended before, or does not come."""
    end_ns = clock.now_ns() + round(_BEGIN_S * SECOND_NS)
    while process.poll() is None and clock.now_ns() < end_ns:
        run = next((each for each in runs() if each.pid == process.pid), None)
        if run is not None:
            return run
        clock.sleep_until_ns(clock.now_ns() + 20 * _LOOK_NS)
    return None


class _StandIn:
    """The stand-in ECU."""

    def __init__(self, bench: Bench, transport: Transport) -> None:
        self._node = EcuNode(bench.ecu_side(), transport, controller_settings(bench.ecu))

    def act(self, now_ns: int, stalk: Stalk) -> None:
        self._node.poll(now_ns, stalk)


def _actor(scenario: Scenario, bench: Bench, end: tuple[Transport, bool]) -> Actor | None:
    transport, stand_in = end
    if commands_relays(scenario):
        return None
    if stand_in:
        return _StandIn(bench, transport)
    if not scenario.stalk:
        return None
    if not bench.ecu_messages.driver:
        raise Failure(f"{scenario.path}: the bench's ecu section needs a message of the stalk, to move it on the bus")
    return StalkSender(bench.ecu_messages.driver, transport)
