"""All faults of one run: what changes in the parameters of each tick, and what happens to its frames."""

from typing import Protocol

from hilplant.arrays import Floats
from hilplant.bus.faulty_transport import FaultyTransport
from hilplant.bus.interface import Transport
from hilplant.faults.on_bus import BusSide, placed_faults
from hilplant.faults.player import FaultPlayer
from hilplant.faults.timing import Course, Inserted, Row
from hilplant.units import SECOND_NS


class FaultyBench(BusSide, Protocol):
    """What faults need of a bench."""

    @property
    def step_ns(self) -> int:
        """Length of a tick."""

    @property
    def parameter_row(self) -> Floats:
        """The packed parameters without faults."""


class ActingFaults:
    """Faults on a bench that runs; more can be inserted while it does.

    The loop is to be given `transport`, and to take at the start of each tick what `begin` returns.
    """

    def __init__(self, bench: FaultyBench, transport: Transport) -> None:
        self._bench = bench
        self.step_s = bench.step_ns / SECOND_NS
        self.transport = FaultyTransport(transport)
        self._player = FaultPlayer((), bench.parameter_row, self.step_s)
        #: When each came and went: tick, name, whether it is there from then on.
        self.edges: list[tuple[int, str, bool]] = []
        self._there: dict[Course, bool] = {}
        self._next_tick = 0.0
        #: Whether the parameters have always been those of the bench.
        self.parameters_kept = True

    def insert(self, inserted: Inserted) -> Course:
        """Insert a fault; its times count from the first tick.

        Raises
        ------
        Failure
            For frames, signals and protections that the bench does not have.

        """
        course = Course(inserted)
        self.transport.add(placed_faults([course], self._bench))
        self._player.add(course)
        self._there[course] = False
        self._next_tick = 0.0
        return course

    def end(self, course: Course) -> None:
        """Let a fault go."""
        course.end()
        self._next_tick = 0.0

    def marks(self) -> dict[str, float]:
        """Return when each first came and last went [s], by a name for people; what stays has no end."""
        found: dict[str, float] = {}
        for tick, name, there in self.edges:
            if there:
                found.setdefault(name, tick * self.step_s)
            else:
                found[f"{name} ends"] = tick * self.step_s
        return found

    @property
    def watches(self) -> bool:
        """Whether the signals of every tick are needed."""
        return self._player.watches

    def begin(self, tick: int, row: Row | None) -> dict[int, float]:
        """Go on to a tick; returns the elements of the parameters that change, with their new values.

        `row` are the signals of the tick before, by name, where something watches them.
        """
        if not self._there:
            return {}
        changes = self._go_on(tick, row) if tick >= self._next_tick or self.watches else {}
        self.transport.begin(tick * self._bench.step_ns)
        return changes

    def _go_on(self, tick: int, row: Row | None) -> dict[int, float]:
        changes = self._player.changes(tick, row)
        self.parameters_kept &= not changes
        self._next_tick = self._player.next_change(tick)
        for course, there in self._there.items():
            if (course.level > 0.0) is not there:
                self._there[course] = not there
                self.edges.append((tick, course.inserted.fault.name, not there))
        return changes
