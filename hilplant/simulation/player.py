"""Plays a scenario into a loop, in virtual time or on the clock: inputs, relays over the bus, and faults."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, cast

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.bus.codec import SentMessage
from hilplant.bus.faulty_transport import FaultyTransport
from hilplant.bus.link import LinkSettings
from hilplant.bus.node import Node
from hilplant.faults.on_bus import placed_faults
from hilplant.faults.player import signal_row
from hilplant.faults.timing import Course
from hilplant.faults.written import SIGNALS, inserted
from hilplant.runtime import commands as c
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.held_faults import HeldFaults
from hilplant.runtime.loop import WAITING
from hilplant.runtime.row import FIRST_OUTPUT, FIRST_STATUS
from hilplant.signals import ECU_TX, INPUT_INDEX, INPUTS, OUTPUTS, STATUS_INDEX
from hilplant.simulation.scenario import FIRST_COMMAND, Scenario
from hilplant.units import SECOND_NS
from hilplant.verdicts.conditions import condition_of
from hilplant.verdicts.known import Known
from hilplant.verdicts.ticks import Row, margin

_RELAYS = frozenset((INPUT_INDEX["relay_on"], INPUT_INDEX["relay_fast"]))
_MODE = FIRST_STATUS + STATUS_INDEX["mode"]


class InputChange(NamedTuple):
    """From a step after time 0 on, an input has a value."""

    step: int
    element: int
    value: float


class ScenarioPlayer:
    """Holds the inputs of a loop as a scenario says; a source of commands for `Intake`, called at each tick's start.

    Time 0 is the first tick, or the one after that in which the scenario's `start` held; steps that were lost because
    ticks came late are not made up for. A relay goes over the bus, in the ECU's messages, by `transport`. `faults` are
    the loop's, `line` its row with the tick before, `ended` is called at the scenario's end.
    """

    def __init__(
        self,
        scenario: Scenario,
        bench: Bench,
        loop: tuple[HeldFaults, FaultyTransport, Floats],
        ended: Callable[[], None] = lambda: None,
    ) -> None:
        """Prepare all that is to be played.

        Raises
        ------
        Failure
            For faults of frames that the bench does not have, and inputs that cannot be.

        """
        self._faults, transport, self._line = loop
        self._step_ns, self._ended = bench.step_ns, ended
        self._inserted = inserted(scenario.faults, bench.step_ns / SECOND_NS)
        placed_faults([Course(each) for each in self._inserted], bench)
        self._left = sorted(changes(scenario, bench), reverse=True)
        self._commander = Commander(bench, transport) if commands_relays(scenario) else None
        self.ticks = round(scenario.seconds * SECOND_NS / bench.step_ns)
        self._condition = condition_of(
            {} if isinstance(scenario.start, str) else scenario.start, Known(1.0, 1.0, SIGNALS, {})
        )
        self._first_command, self._before = scenario.start == FIRST_COMMAND, cast("Row | None", None)
        self._limit_ns = round(scenario.start_within * SECOND_NS)
        #: Time 0 on the loop's clock; None while its condition has not come.
        self.start_ns: int | None = None
        self.over = False

    def __call__(self, now_ns: int) -> Sequence[ChannelCommand]:
        """Return what the scenario commands in the tick that begins now."""
        commands: list[ChannelCommand] = []
        if self.start_ns is None:
            if not self._begins():
                self._end_if(now_ns >= self._limit_ns)
                return commands
            self.start_ns = now_ns
            first_step = now_ns // self._step_ns
            for each in self._inserted:
                self._faults.hold(replace(each, at=each.at + first_step))
            commands.append(ChannelCommand(kind=c.START, owner=c.SCENARIO))
        step = (now_ns - self.start_ns) // self._step_ns
        due: dict[int, float] = {}
        while self._left and self._left[-1].step <= step:
            _, index, value = self._left.pop()
            due[index] = value
        commands += [self._held(index, value) for index, value in due.items() if not self._sent(index, value)]
        if self._commander is not None:
            self._commander.send(now_ns)
        self._end_if(step >= self.ticks)
        return commands

    def next_due_ns(self) -> float:
        """Return when it has something to do next; -inf while it waits for its begin."""
        if self.start_ns is None:
            return -math.inf
        steps = [each.step for each in self._left[-1:]] + ([] if self.over else [self.ticks])
        sends_ns = math.inf if self._commander is None else self._commander.next_due_ns()
        return min([sends_ns, *(self.start_ns + step * self._step_ns for step in steps)])

    def _sent(self, index: int, value: float) -> bool:
        """Take a relay's value for the bus; False for other inputs."""
        if self._commander is None or index not in _RELAYS:
            return False
        self._commander.values[index] = value
        return True

    def _held(self, index: int, value: float) -> ChannelCommand:
        return ChannelCommand(kind=c.OVERRIDE, owner=c.SCENARIO, element=index, value=value)

    def _end_if(self, over: bool) -> None:
        if over and not self.over:
            self.over = True
            self._ended()

    def _begins(self) -> bool:
        if self._first_command:
            return bool(self._line[1] or self._line[0]) and self._line[_MODE] != WAITING
        if not self._condition:
            return True
        line, before = self._line, self._before
        row: Row = signal_row(INPUTS, line[2:FIRST_OUTPUT]) | signal_row(OUTPUTS, line[FIRST_OUTPUT:FIRST_STATUS])
        self._before = row
        return bool(line[1] or line[0]) and margin(self._condition, row, before) >= 0.0


class Commander:
    """Sends the relays of a scenario as the ECU would: at each change, and at the cycle time."""

    def __init__(self, bench: Bench, transport: FaultyTransport) -> None:
        messages: list[SentMessage] = [each for each in bench.ecu_side().send if _RELAYS & set(each.sources)]
        self.values = [signal.default for signal in ECU_TX]
        self._node = Node((), messages, cast("Any", transport.own_end()), LinkSettings(), [])

    def next_due_ns(self) -> float:
        """Return when a message is due."""
        return self._node.send_due_ns

    def send(self, now_ns: int) -> None:
        """Send what is due."""
        self._node.send(now_ns, self.values)


def commands_relays(scenario: Scenario) -> bool:
    """Say whether a scenario commands a relay itself, so that no ECU may."""
    return bool(_RELAYS & set(scenario.entries))


def changes(scenario: Scenario, bench: Bench) -> Iterator[InputChange]:
    """Give what a scenario sets: each input where it is another than in the step before."""
    for index in scenario.entries:
        column = scenario.column(index, bench.input_row, bench.step_ns)
        changed = np.ones(column.shape, np.bool_)
        changed[1:] = column[1:] != column[:-1]
        for step in np.flatnonzero(changed).tolist():
            yield InputChange(step, index, float(column[step]))
