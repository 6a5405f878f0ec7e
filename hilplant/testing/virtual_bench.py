"""A plant, and if wanted the stand-in ECU, on an in-memory bus in virtual time; every tick and every frame is kept."""

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, cast

import numpy as np

from hilplant.bench import Bench
from hilplant.bench.assembly import initial_state
from hilplant.bus.codec import SentMessage
from hilplant.bus.in_memory import InMemoryBus
from hilplant.bus.node import LinkSettings, Node
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import stalk_at
from hilplant.faults.acting import ActingFaults
from hilplant.faults.timing import Course
from hilplant.faults.written import FaultEntry, inserted
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.commands import COMES, GOES
from hilplant.runtime.loop import ROW_WIDTH
from hilplant.runtime.ring import Ring
from hilplant.runtime.server import build_loop
from hilplant.runtime.tape import Tape
from hilplant.signals import ECU_TX, INPUT_INDEX
from hilplant.simulation.scenario import Scenario
from hilplant.testing.evidence import Evidence, FaultEdge
from hilplant.units import MILLISECOND_NS, SECOND_NS

_RELAYS = frozenset((INPUT_INDEX["relay_on"], INPUT_INDEX["relay_fast"]))
#: A run in virtual time has no date.
_NO_DATE = datetime(1970, 1, 1, tzinfo=UTC)


class VirtualBench:
    """A bench that is stepped: plant, stand-in ECU (`stand_in`) and the scenario's hand on one bus.

    Time 0 is the first tick. A relay that the scenario commands goes over the bus, in the ECU's messages, and no
    stand-in ECU joins; every other input of a scenario is set in the plant itself, in its tick.
    """

    def __init__(self, bench: Bench, scenario: Scenario | None = None, stand_in: bool = True) -> None:
        if scenario is not None and scenario.initial:
            row = initial_state(bench.parameters, bench.initial | scenario.initial)
            bench = replace(bench, state_row=row)
        self.bench, self.bus, self.tape = bench, InMemoryBus(), Tape()
        acting = ActingFaults(bench, self.bus.end())
        self._stalk = scenario.stalk if scenario is not None else ()
        self._loop = build_loop(bench, acting.transport, VirtualClock(), cast("Ring", self.tape))
        #: The faults of the scenario; they take more.
        self.faults = self._loop.listen(None, self.tape.events.append, acting).faults
        for each in inserted(scenario.faults, bench.step_ns / SECOND_NS) if scenario is not None else ():
            self.faults.hold(each)
        self._changes = {} if scenario is None else _changes(scenario, bench)
        commanded = scenario is not None and bool(_RELAYS & set(scenario.entries))
        self._commander = _Commander(bench, self.bus) if commanded else None
        self.ecu: EcuNode | None = None
        if stand_in and not commanded:
            self.ecu = EcuNode(bench.ecu_side(), cast("Any", self.bus.end()), controller_settings(bench.ecu))
        self._poll_ticks = max(1, round(bench.ecu.period_ms * MILLISECOND_NS / bench.step_ns))

    @property
    def ticks(self) -> int:
        """How many ticks have passed."""
        return self.tape.ticks

    @property
    def now_ns(self) -> int:
        """The time of the next tick."""
        return self.tape.ticks * self.bench.step_ns

    def step(self) -> None:
        """Take one tick: the scenario's hand, the plant, and the ECU when it is its turn."""
        tick, now_ns = self.tape.ticks, self.tape.ticks * self.bench.step_ns
        for index, value in self._changes.get(tick, ()):
            if self._commander is not None and index in _RELAYS:
                self._commander.values[index] = value
            else:
                self._loop.commanded[index] = value
        if self._commander is not None:
            self._commander.send(now_ns)
        self._loop.tick(now_ns)
        if self.ecu is not None and tick % self._poll_ticks == 0:
            self.ecu.poll(now_ns, stalk_at(self._stalk, now_ns / SECOND_NS))

    def run(self, ticks: int) -> None:
        """Take many ticks."""
        for _ in range(ticks):
            self.step()

    def set(self, index: int, value: float) -> None:
        """Set an input of the plant from the next tick on."""
        self._loop.commanded[index] = value

    def insert_fault(self, entry: FaultEntry) -> Course:
        """Insert a fault; its times count from now."""
        made = entry.inserted(self.bench.step_ns / SECOND_NS)
        return self.faults.hold(replace(made, at=made.at + self.ticks))

    def evidence(self) -> Evidence:
        """Return what has been so far."""
        frames = self.tape.frames
        places = np.array([bus_ns // self.bench.step_ns for _, bus_ns, _, _ in frames], np.int64)
        edges = [
            FaultEdge(event.time_ns // self.bench.step_ns, event.text.decode(), event.kind == COMES)
            for event in self.tape.events
            if event.kind in (COMES, GOES)
        ]
        return Evidence(self.bench.step_ns, self.tape.read_rows(), places, [frame for _, _, frame, _ in frames], edges)

    def record(self, path: Path) -> None:
        """Write what has been so far as a recording, over a file that is there."""
        from hilplant.recording.metadata import describe
        from hilplant.recording.writer import RecordingWriter

        path.unlink(missing_ok=True)
        writer = RecordingWriter(path, describe(self.bench, _NO_DATE), ROW_WIDTH)
        writer.add(self.tape.read_rows(), self.tape.read_frames(), self.tape.read_events())
        writer.write(last=True)
        writer.close()


class _Commander:
    """Sends the relays of a scenario as the ECU would: at each change, and at the cycle time."""

    def __init__(self, bench: Bench, bus: InMemoryBus) -> None:
        messages: list[SentMessage] = [each for each in bench.ecu_side().send if _RELAYS & set(each.sources)]
        self.values = [signal.default for signal in ECU_TX]
        self._node = Node((), messages, cast("Any", bus.end()), LinkSettings(), [])

    def send(self, now_ns: int) -> None:
        self._node.receive(now_ns)
        self._node.send(now_ns, self.values)


def _changes(scenario: Scenario, bench: Bench) -> Mapping[int, list[tuple[int, float]]]:
    """Return what a scenario sets, by tick: index and value of each input that is another than in the tick before."""
    rows = scenario.input_rows(bench.input_row, bench.step_ns)
    changed = np.ones(rows.shape, np.bool_)
    changed[1:] = rows[1:] != rows[:-1]
    found: dict[int, list[tuple[int, float]]] = defaultdict(list)
    for index in scenario.entries:
        for tick in np.flatnonzero(changed[:, index]).tolist():
            found[tick].append((index, float(rows[tick, index])))
    return dict(found)
