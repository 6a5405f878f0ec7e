"""The loop in virtual time: it may take at once the ticks in which nothing is due but the plant's step."""

import math
from typing import cast

from hilplant.bus.node import Node
from hilplant.models.plant import tick as plant_tick
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import Late, Loop, PlantRows
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import FIRST_OUTPUT, FIRST_STATUS
from hilplant.runtime.tape import Tape
from hilplant.signals import OUTPUT_INDEX, STATUS, STATUS_INDEX

_GUARD = OUTPUT_INDEX["guard"]
_TICK = STATUS_INDEX["tick"]


class VirtualLoop(Loop):
    """One plant on an in-memory bus; tick k is at k steps, and none is late. See :class:`Loop`."""

    def __init__(self, plant: PlantRows, node: Node, tape: Tape) -> None:
        super().__init__(plant, node, VirtualClock(), cast("Ring", tape), Late())
        self._tape = tape

    def quiet_ticks(self, most: int, before_ns: float) -> int:
        """Take the ticks before `before_ns` in which nothing is due, at most `most`; returns how many, 0 if none is.

        They leave the rows that `tick` would. The caller knows that no frame has come and that no command waits. The
        last of them is the one in which a signal has changed that makes a message due.
        """
        step_ns, first = self._plant.step_ns, self.progress.ticks
        due_ns = min(before_ns, self._node.next_due_ns(), self._intake_due_ns())
        watched, known = self._node.watched
        if due_ns <= first * step_ns or self.control is not None:
            return 0
        if due_ns < math.inf:
            most = min(most, math.ceil(due_ns / step_ns) - first)
        guard, watched = self._outputs[_GUARD], [FIRST_OUTPUT + index for index in watched]
        self._take_inputs(self._node.lost)
        self._status[:] = self._status_values(self._mode(first * step_ns))
        for tick in range(first, first + most):
            self._before[:] = self._state
            plant_tick(self._state, self._inputs, self._parameters, self._plant.tables, self._outputs)
            self.line[0] = self._status[_TICK] = tick
            self.line[1] = tick * step_ns
            self._tape.next_row()[:] = self.line
            self.progress.ticks = tick
            changed = [self.line.item(place) for place in watched] != known
            if changed:
                self._send_changed(tick * step_ns)
            self._tape.commit()
            if changed or self._outputs[_GUARD] != guard:
                break
        self.progress.ticks += 1
        self._node.skip((self.progress.ticks - 1) * step_ns)
        return self.progress.ticks - first

    def _intake_due_ns(self) -> float:
        return math.inf if self.intake is None else self.intake.next_due_ns()

    def _send_changed(self, bus_ns: int) -> None:
        self._bus_ns = bus_ns
        self._published = self.line[FIRST_OUTPUT : FIRST_STATUS + len(STATUS)].tolist()
        self._node.send(bus_ns, self._published)
