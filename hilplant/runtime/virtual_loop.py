"""The loop in virtual time: it may take at once the ticks in which nothing comes in."""

import math
from typing import cast

from hilplant.arrays import Floats
from hilplant.bus.node import Node
from hilplant.models.plant import tick as plant_tick
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import Late, Loop, PlantRows
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import FIRST_OUTPUT, FIRST_OWNER, FIRST_STATE, FIRST_STATUS
from hilplant.runtime.tape import Tape
from hilplant.signals import OUTPUT_INDEX, STATUS_INDEX

_GUARD = OUTPUT_INDEX["guard"]
_TICK = STATUS_INDEX["tick"]
_TICK_PLACE = FIRST_STATUS + _TICK


class VirtualLoop(Loop):
    """One plant on an in-memory bus; tick k is at k steps, and none is late. See :class:`Loop`."""

    def __init__(self, plant: PlantRows, node: Node, tape: Tape) -> None:
        super().__init__(plant, node, VirtualClock(), cast("Ring", tape), Late())
        self._tape = tape

    def quiet_ticks(self, most: int, before_ns: float) -> int:
        """Take the ticks before `before_ns` in which nothing comes in, at most `most`; returns how many, 0 if none is.

        They leave the rows and frames that `tick` would. The caller knows that no frame has come and that no command
        waits.
        """
        step_ns, first = self._plant.step_ns, self.progress.ticks
        due_ns = min(before_ns, self._node.next_loss_ns(), self._intake_due_ns())
        if due_ns <= first * step_ns or self.control is not None:
            return 0
        if due_ns < math.inf:
            most = min(most, math.ceil(due_ns / step_ns) - first)
        self._take_inputs(self._node.lost)
        self.line[FIRST_STATUS:FIRST_STATE] = self._status_values(self._mode(first * step_ns))
        rows = self._tape.next_rows(most)
        rows[:] = self.line
        taken = self._take(rows)
        self.line[:] = rows[taken - 1]
        self._tape.commit(taken)
        self._node.skip(self._bus_ns)
        return taken

    def _take(self, rows: Floats) -> int:
        """Step and send, with the inputs that stand in all rows; stops behind the tick that changes more than that."""
        counts, before = self._node.counts, self._node.counts.copy()
        tables, guard = self._plant.tables, self._outputs[_GUARD]
        first = self.progress.ticks
        for row in rows:
            outputs = row[FIRST_OUTPUT:FIRST_STATUS]
            row[FIRST_STATE:FIRST_OWNER] = self._state
            plant_tick(self._state, self._inputs, self._parameters, tables, outputs)
            counts[_TICK] = before[_TICK] = row[0] = row[_TICK_PLACE] = self.progress.ticks
            row[1] = self._bus_ns = self.progress.ticks * self._plant.step_ns
            self._node.send(self._bus_ns, outputs.tolist() + before)
            self.progress.ticks += 1
            if outputs[_GUARD] != guard or counts != before:
                break
        return self.progress.ticks - first

    def _intake_due_ns(self) -> float:
        return math.inf if self.intake is None else self.intake.next_due_ns()
