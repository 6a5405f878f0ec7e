"""A scenario as a test on a CAN interface, on the clock: the server is a process of its own, the ECU here or not."""

import contextlib
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from hilplant.bench import Bench
from hilplant.bus.transport import Transport, open_transport
from hilplant.channel.run_files import runs
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import stalk_at
from hilplant.ecu.vocabulary import Stalk
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.runtime.clock import Clock, WallClock
from hilplant.runtime.commands import START
from hilplant.runtime.follower import Follower
from hilplant.simulation.player import commands_relays
from hilplant.simulation.scenario import Scenario
from hilplant.testing.evidence import recorded
from hilplant.testing.known_signals import DatabaseSignals, database_signals, protections_of
from hilplant.testing.scenario_test import ScenarioTest, expected, judged
from hilplant.testing.sending import CyclicMessage
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: How long the server may take to begin: it may have to compile [s].
_BEGIN_S, _END_S = 600.0, 60.0
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
    """Run a scenario on a channel of the bench's interface, and judge its recording.

    With `stand_in` the stand-in ECU joins from here; else this end moves the stalk, as the bench's stalk message.

    Raises
    ------
    Failure
        Where the interface cannot be opened, the bench has no such signals, or the server does not begin.

    """
    database = database_signals(bench.sources, protections_of(bench))
    expectations = expected(scenario, database, bench.step_ns)
    folder = tempfile.TemporaryDirectory(prefix="hilplant-test-")
    recording = Path(folder.name) / "run.hilrec"
    transport = open_transport({**bench.interface, "channel": channel})
    with contextlib.closing(transport), _serving(scenario, channel, bench_name, recording) as process:
        late = _Acting(scenario, bench, _actor(scenario, bench, database, (transport, stand_in))).until_it_ends(process)
    evidence = replace(recorded(read_recording(recording)), hidden=tuple(late))
    options = (f" --bench {bench_name}" if bench_name else "") + ("" if stand_in else " --ecu external")
    rerun = f"hilplant test {scenario.path} --on {channel}{options}"
    done = judged(scenario, bench.name, evidence, database, expectations, rerun)

    def record(path: Path, kept: tempfile.TemporaryDirectory[str] = folder) -> None:
        shutil.copyfile(Path(kept.name) / recording.name, path)

    return replace(done, record=record)


@contextmanager
def _serving(
    scenario: Scenario, channel: str, bench_name: str | None, recording: Path
) -> Iterator[subprocess.Popen[bytes]]:
    command = [sys.executable, "-m", "hilplant", "run", bench_name or scenario.bench or "default"]
    command += ["--channel", channel, "--scenario", str(scenario.path), "--record", str(recording)]
    with tempfile.TemporaryFile() as said:
        options: dict[str, Any] = {"stdout": said, "stderr": subprocess.STDOUT, "stdin": subprocess.DEVNULL}
        process = subprocess.Popen([*command, "--no-channel", "--no-verdicts"], **options)
        try:
            yield process
            process.wait(_END_S)
        finally:
            if process.poll() is None:
                process.terminate()
                process.wait(_END_S)
        if not recording.exists():
            said.seek(0)
            raise Failure(f"{scenario.path}: the server did not run: {said.read().decode(errors='replace').strip()}")


@dataclass
class _Acting:
    """Lets the actor act in the loop's own time, for as long as the loop runs."""

    scenario: Scenario
    bench: Bench
    actor: Actor | None
    clock: Clock = field(default_factory=WallClock)
    start_ns: int | None = None
    late: list[int] = field(default_factory=list)

    def until_it_ends(self, process: subprocess.Popen[bytes]) -> list[int]:
        """Act until the loop has ended; returns the steps that are unfit because this end came late."""
        follower = self._follower(process)
        if follower is None:
            return []
        period_ns, acted_ns = round(self.bench.ecu.period_ms * MILLISECOND_NS), 0
        with contextlib.closing(follower):
            while not follower.ended and process.poll() is None:
                now_ns = int(follower.latest()[1])
                for event in follower.events().records:
                    if event["kind"] == START and self.start_ns is None:
                        self.start_ns = int(event["time_ns"])
                if self.actor is not None and now_ns >= acted_ns + period_ns:
                    self._act(self.actor, now_ns, acted_ns)
                    acted_ns = now_ns
                self.clock.sleep_until_ns(self.clock.now_ns() + _LOOK_NS)
        return self.late

    def _act(self, actor: Actor, now_ns: int, acted_ns: int) -> None:
        step_ns = self.bench.step_ns
        if acted_ns and now_ns - acted_ns > LATE_NS:
            self.late.extend(range(acted_ns // step_ns, now_ns // step_ns + 1))
        stalk_s = -1.0 if self.start_ns is None else (now_ns - self.start_ns) / SECOND_NS
        actor.act(now_ns, stalk_at(self.scenario.stalk, stalk_s))

    def _follower(self, process: subprocess.Popen[bytes]) -> Follower | None:
        """Wait for the loop's first row; None where the server has ended before."""
        end_ns = self.clock.now_ns() + round(_BEGIN_S * SECOND_NS)
        while process.poll() is None and self.clock.now_ns() < end_ns:
            run = next((each for each in runs() if each.pid == process.pid), None)
            if run is not None:
                return Follower(run.ring, history=True)
            self.clock.sleep_until_ns(self.clock.now_ns() + 20 * _LOOK_NS)
        return None


class _StandIn:
    """The stand-in ECU."""

    def __init__(self, bench: Bench, transport: Transport) -> None:
        self._node = EcuNode(bench.ecu_side(), transport, controller_settings(bench.ecu))

    def act(self, now_ns: int, stalk: Stalk) -> None:
        self._node.poll(now_ns, stalk)


class _Hand:
    """The driver's hand: the bench's stalk message, at its cycle time and when it changes."""

    def __init__(self, bench: Bench, database: DatabaseSignals, transport: Transport) -> None:
        (message,) = bench.ecu_messages.stalk
        self._message = CyclicMessage(database.messages[message.name], database.protections.get(message.name))
        self._names = _written(bench, message.name, database)
        self._transport, self._stalk, self._due_ns = transport, Stalk(), 0

    def act(self, now_ns: int, stalk: Stalk) -> None:
        if stalk != self._stalk or now_ns >= self._due_ns:
            self._stalk, self._due_ns = stalk, now_ns + (self._message.period_ns or 100 * MILLISECOND_NS)
            values = {"master_input": stalk.master.name.lower(), "intermittent_switch": stalk.interval}
            values |= {"flick_wipe": stalk.flick, "wash": stalk.wash}
            self._message.change(
                {written: labels.get(values[name], values[name]) for name, (written, labels) in self._names.items()}
            )
            self._transport.send(self._message.frame())
        self._transport.receive(1000)  # what others say is not for the hand


def _written(bench: Bench, message: str, database: DatabaseSignals) -> dict[str, tuple[str, dict[Any, str]]]:
    """Return by the stand-in's names the signals of the stalk's message, and the labels of their values."""
    found: dict[str, tuple[str, dict[Any, str]]] = {}
    for written, entries in (bench.ecu.receive or {})[message].signals.items():
        _, signal = database.signals[f"{message}.{written}"]
        labels: dict[Any, str] = {str(label).lower(): str(label) for label in (signal.choices or {}).values()}
        for entry in entries:
            labels |= {plant.lower(): label for label, plant in (entry.choices or {}).items()}
            found[entry.signal] = written, labels if entry.signal == "master_input" else {}
    return found


def _actor(scenario: Scenario, bench: Bench, database: DatabaseSignals, end: tuple[Transport, bool]) -> Actor | None:
    transport, stand_in = end
    if commands_relays(scenario):
        return None
    if stand_in:
        return _StandIn(bench, transport)
    if scenario.stalk and len(bench.ecu_messages.stalk) != 1:
        raise Failure(f"{scenario.path}: the bench's ecu section needs one message of the stalk, to move it on the bus")
    return _Hand(bench, database, transport) if scenario.stalk else None
