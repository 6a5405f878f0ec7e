"""Faults that clients and scenarios have inserted into a loop: whose they are, and until when."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

from hilplant.arrays import Floats
from hilplant.bus.faulty_transport import FaultyTransport
from hilplant.failure import Failure
from hilplant.faults.acting import ActingFaults
from hilplant.faults.player import signal_row
from hilplant.faults.timing import Course, Inserted, Row
from hilplant.faults.written import entry_from
from hilplant.runtime import commands as c
from hilplant.runtime.commands import ChannelCommand
from hilplant.signals import INPUTS, OUTPUTS, STATUS_INDEX
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: Most faults at a time, also those that wait.
MOST_FAULTS = 64
_SHOWN_FOR_NS = 100 * MILLISECOND_NS
_NEVER_NS = 1 << 62
_FIRST_OUTPUT = 2 + len(INPUTS)
_SEEN = _FIRST_OUTPUT + len(OUTPUTS)
_ACTIVE, _SHOWN = STATUS_INDEX["faults_active"], STATUS_INDEX["fault_shown"]


class _Holder(NamedTuple):
    owner: int = c.SCENARIO
    client: int = 0
    end_ns: int = _NEVER_NS
    lease_ns: int = 0


class HeldFaults:
    """Inserts, holds and clears the faults of one loop.

    `line` is the loop's row, with inputs and outputs of the tick before; `parameters` the row that the loop steps with;
    `counts` gets what the bus and the recording tell of faults; `tell` gets what happens.
    """

    def __init__(
        self,
        acting: ActingFaults,
        rows: tuple[Floats, Floats],
        counts: list[int],
        tell: Callable[[ChannelCommand], None],
    ) -> None:
        """`rows` are line and parameters."""
        self._acting, self._tell, self._counts = acting, tell, counts
        self._line, self._parameters = rows
        self._held: dict[Course, _Holder] = {}
        self._rebased: dict[int, float] = {}
        self._next_end_ns = _NEVER_NS
        self._step_ns = round(acting.step_s * SECOND_NS)

    @property
    def transport(self) -> FaultyTransport:
        """What lies between the node and its interface."""
        return self._acting.transport

    def insert(self, command: ChannelCommand, now_ns: int) -> str:
        """Insert the fault that a client's command describes, its times counted from now; returns why not, if not.

        It takes the place of the client's own of the same name about the same frames.
        """
        try:
            inserted = entry_from(command.text).inserted(self._acting.step_s)
            same = [each for each in self._held if not each.over and _same(each.inserted, inserted)]
            hands = [each for each in same if self._held[each].owner == c.HAND]
            if any(self._held[each].client != command.client for each in hands):
                return c.OUTCOMES[c.HELD_BY_OTHER]
            end_ns = now_ns + command.lease_ns if command.lease_ns else _NEVER_NS
            holder = _Holder(command.owner, command.client, end_ns, command.lease_ns)
            self.hold(replace(inserted, at=inserted.at + now_ns // self._step_ns), holder)
        except Failure as failure:
            return str(failure)
        for course in hands:
            self.end(course)
        return ""

    def hold(self, inserted: Inserted, holder: _Holder | None = None) -> Course:
        """Insert a fault, of the scenario where nobody is named; its times count from the first tick.

        Raises
        ------
        Failure
            For frames, signals and protections that the bench does not have, and where there are too many faults.

        """
        self._held = {each: held for each, held in self._held.items() if each.level or not each.over}
        if len(self._held) >= MOST_FAULTS:
            raise Failure(f"there are {MOST_FAULTS} faults already")
        made = self._acting.insert(inserted)
        self._held[made] = holder or _Holder()
        self._next_end_ns = min(self._next_end_ns, self._held[made].end_ns)
        return made

    def end(self, course: Course) -> None:
        """End a fault; who held it is known until it has gone."""
        self._acting.end(course)
        if not course.level:
            self._held.pop(course, None)

    def clear(self, command: ChannelCommand) -> int:
        """End a client's faults of a name, all where none is given; returns the outcome."""
        name = command.text.decode()
        there = [each for each in self._held if not each.over]
        named = [each for each in there if not name or each.inserted.fault.name == name]
        own = [each for each in named if self._held[each][:2] == (command.owner, command.client)]
        for course in own:
            self.end(course)
        if own or not name:
            return c.APPLIED
        return c.HELD_BY_OTHER if named else c.NOT_HELD

    def alive(self, client: int, now_ns: int) -> None:
        """Begin the leases of a client anew."""
        for course, each in self._held.items():
            if each.client == client and each.lease_ns and each.owner == c.HAND:
                self._held[course] = each._replace(end_ns=now_ns + each.lease_ns)

    def parameter(self, index: int, value: float) -> None:
        """Change a parameter; where a fault changes it too, what comes of both follows in this tick."""
        self._parameters[index] = value
        with_faults = self._acting.rebase(index, value)
        if with_faults != value:
            self._rebased[index] = with_faults

    def next_due_ns(self) -> float:
        """Return when there is something to do here by time alone; -inf while every tick needs it."""
        acting = self._acting
        if self._rebased or acting.watches or not acting.transport.idle or len(acting.present) > 1:
            return -math.inf
        return min(self._next_end_ns, acting.next_change * self._step_ns)

    def begin(self, tick: int, now_ns: int) -> None:
        """Go on to the next tick: leases that are over, parameters that change, faults that come and go."""
        if now_ns >= self._next_end_ns:
            self._expire(tick, now_ns)
        step, acting = now_ns // self._step_ns, self._acting
        changes = acting.begin(step, self._seen(tick) if acting.watches else None)
        at = ChannelCommand(tick=tick, time_ns=now_ns)
        for index, value in (self._rebased | changes.parameters).items():
            self._parameters[index] = value
            self._tell(at._replace(kind=c.PARAMETER, element=index, value=value))
        self._rebased.clear()
        for course, there in changes.edges:
            holder = self._held.get(course)
            who = at if holder is None else at._replace(owner=holder.owner, client=holder.client)
            self._tell(who._replace(kind=c.COMES if there else c.GOES, text=course.inserted.fault.name.encode()))
            if course.over:
                self._held.pop(course, None)
        self._show(now_ns)

    def _show(self, now_ns: int) -> None:
        present = self._acting.present
        self._counts[_ACTIVE] = len(present)
        self._counts[_SHOWN] = present[now_ns // _SHOWN_FOR_NS % len(present)] if present else 0

    def _seen(self, tick: int) -> Row | None:
        if not tick:
            return None
        line = self._line
        return signal_row(INPUTS, line[2:_FIRST_OUTPUT]) | signal_row(OUTPUTS, line[_FIRST_OUTPUT:_SEEN])

    def _expire(self, tick: int, now_ns: int) -> None:
        for course, holder in list(self._held.items()):
            if course.over or now_ns < holder.end_ns:
                continue
            self.end(course)
            event = ChannelCommand(tick, now_ns, holder.client, 0, c.CLEAR, holder.owner, c.LEASE_OVER)
            self._tell(event._replace(text=course.inserted.fault.name.encode()))
        ends = [holder.end_ns for course, holder in self._held.items() if not course.over]
        self._next_end_ns = min(ends, default=_NEVER_NS)


def _same(one: Inserted, other: Inserted) -> bool:
    """Say whether two are the same fault of the same message, whatever their quantities and times."""
    about, others = one.about, other.about
    return one.fault is other.fault and (about.message, about.signal, about.direction) == (
        others.message, others.signal, others.direction,
    )  # fmt: skip
