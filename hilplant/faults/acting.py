"""All faults of one run: what changes in the parameters of each tick, and what happens to its frames."""

import math
from typing import NamedTuple, Protocol

from hilplant.arrays import Floats
from hilplant.bus.database import database_among
from hilplant.bus.faulty_transport import FaultyTransport, PlacedFault
from hilplant.bus.interface import Transport
from hilplant.faults.catalogue import NUMBERS
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


class FaultChanges(NamedTuple):
    """What a tick begins with: elements of the parameters with their new values, and which faults came or went."""

    parameters: dict[int, float]
    edges: list[tuple[Course, bool]]


_NOTHING = FaultChanges({}, [])


class ActingFaults:
    """Faults on a bench that runs; more can be inserted while it does, and what is over is forgotten.

    The loop is to be given `transport`, and to take at the start of each tick what `begin` returns. Times are counted
    in steps from the first tick, also those in which no tick was done because it came late.
    """

    def __init__(self, bench: FaultyBench, transport: Transport) -> None:
        database_among(bench.sources)  # read now, so that no tick has to
        self._bench = bench
        self.step_s = bench.step_ns / SECOND_NS
        self.transport = FaultyTransport(transport)
        self._player = FaultPlayer((), bench.parameter_row, self.step_s)
        self._there: dict[Course, bool] = {}
        self._placed: dict[Course, list[PlacedFault]] = {}
        #: Numbers in the catalogue of the faults that are there now.
        self.present: tuple[int, ...] = ()
        self._next = 0.0

    def insert(self, inserted: Inserted) -> Course:
        """Insert a fault; its times count from the first tick.

        Raises
        ------
        Failure
            For frames, signals and protections that the bench does not have.

        """
        self._forget()
        course = Course(inserted)
        self._placed[course] = placed_faults([course], self._bench)
        self.transport.add(self._placed[course])
        self._player.add(course)
        self._there[course] = False
        self._next = 0.0
        return course

    def end(self, course: Course) -> None:
        """Let a fault go."""
        course.end()
        self._next = 0.0

    def rebase(self, index: int, value: float) -> float:
        """Change an element of the parameters without faults; returns its value with them."""
        return self._player.rebase(index, value)

    @property
    def watches(self) -> bool:
        """Whether the signals of every tick are needed."""
        return self._player.watches

    @property
    def next_change(self) -> float:
        """The step at which something may change by time alone; endless where nothing will."""
        return self._next if self._there else math.inf

    def begin(self, step: int, row: Row | None) -> FaultChanges:
        """Go on to a step; returns what changes in it.

        `row` are the signals of the tick before, by name, where something watches them.
        """
        if not self._there:
            return _NOTHING
        changes = self._go_on(step, row) if step >= self._next or self._player.watches else _NOTHING
        self.transport.begin(step * self._bench.step_ns)
        return changes

    def _go_on(self, step: int, row: Row | None) -> FaultChanges:
        parameters, edges = self._player.changes(step, row), []
        self._next = self._player.next_change(step)
        for course, there in self._there.items():
            if (course.level > 0.0) is not there:
                self._there[course] = not there
                edges.append((course, not there))
        if edges:
            self.present = tuple(NUMBERS[each.inserted.fault.name] for each, there in self._there.items() if there)
        return FaultChanges(parameters, edges)

    def _forget(self) -> None:
        """Forget the faults that are over and have nothing left to do."""
        for course in [each for each in self._there if each.over and not self._there[each]]:
            if all(placed.effect.spent for placed in self._placed[course]):
                self.transport.remove(self._placed.pop(course))
                self._player.remove(course)
                del self._there[course]
        self._next = 0.0 if self._there else math.inf
