"""A plant, and if wanted the stand-in ECU, on an in-memory bus in virtual time; every tick and every frame is kept."""

import math
from dataclasses import replace
from typing import Any, cast

from hilplant.bench import Bench
from hilplant.bench.assembly import initial_state
from hilplant.bus.in_memory import InMemoryBus
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import PlayedStalk
from hilplant.faults.acting import ActingFaults
from hilplant.faults.timing import Course
from hilplant.faults.written import FaultEntry
from hilplant.runtime.loop import Control
from hilplant.runtime.server import build_node
from hilplant.runtime.virtual_loop import VirtualLoop
from hilplant.simulation.player import ScenarioPlayer, commands_relays
from hilplant.simulation.scenario import Scenario
from hilplant.testing.kept_run import KeptRun
from hilplant.units import MILLISECOND_NS, SECOND_NS


class VirtualBench(KeptRun):
    """A bench that is stepped: plant, stand-in ECU (`stand_in`) and the scenario's hand on one bus.

    Time 0 is the first tick. A relay that the scenario commands goes over the bus, in the ECU's messages, and no
    stand-in ECU joins; every other input of a scenario is set in the plant itself, in its tick.
    """

    def __init__(self, bench: Bench, scenario: Scenario | None = None, stand_in: bool = True) -> None:
        if scenario is not None and scenario.initial:
            row = initial_state(bench.parameters, bench.initial | scenario.initial)
            bench = replace(bench, state_row=row)
        super().__init__(bench)
        self.bus = InMemoryBus()
        self._plant_end = self.bus.end()
        acting = ActingFaults(bench, self._plant_end)
        self._stalk = PlayedStalk(scenario.stalk if scenario is not None else ())
        self._loop = VirtualLoop(bench, build_node(bench, acting.transport), self.tape)
        intake = self._loop.listen(None, self.tape.events.append, acting)
        #: The faults of the loop; they take more.
        self.faults = intake.faults
        self.player: ScenarioPlayer | None = None
        if scenario is not None:
            self.player = ScenarioPlayer(scenario, bench, (self.faults, acting.transport, self._loop.line))
            intake.source = self.player
        commanded = scenario is not None and commands_relays(scenario)
        self.ecu: EcuNode | None = None
        if stand_in and not commanded:
            self.ecu = EcuNode(bench.ecu_side(), cast("Any", self.bus.end()), controller_settings(bench.ecu))
        self._poll_ticks = max(1, round(bench.ecu.period_ms * MILLISECOND_NS / bench.step_ns))

    def seat(self, control: Control) -> None:
        """Have a controller inside the loop; the bench is one that :func:`hilplant.ecu.loop_controller.seated` gave."""
        self._loop.control = control
        if self._loop.intake is not None:
            self._loop.intake.controlled = True

    @property
    def ticks(self) -> int:
        """How many ticks have passed."""
        return self.tape.ticks

    @property
    def now_ns(self) -> int:
        """The time of the next tick."""
        return self.tape.ticks * self.bench.step_ns

    def step(self, most: int = 1) -> int:
        """Take one tick: the scenario's hand, the plant, and the ECU when it is its turn; returns how many were taken.

        Of ticks in which nothing comes in it takes several, `most` at the most.
        """
        most = min(most, -self.tape.ticks % self._poll_ticks + 1)
        player_ns = math.inf if self.player is None else self.player.next_due_ns()
        taken = 0 if self._plant_end.coming else self._loop.quiet_ticks(most, player_ns)
        if not taken:
            self._loop.tick(self.now_ns)
            taken = 1
        self._poll()
        return taken

    def _poll(self) -> None:
        """Let the ECU act behind the last tick, when it is its turn."""
        last = self.tape.ticks - 1
        if self.ecu is not None and last % self._poll_ticks == 0:
            last_ns = last * self.bench.step_ns
            self.ecu.poll(last_ns, self._stalk((last_ns - self.start_ns) / SECOND_NS))

    @property
    def start_ns(self) -> int:
        """The scenario's time 0; the time of the next tick while it has not come."""
        start_ns = None if self.player is None else self.player.start_ns
        return 0 if self.player is None else self.now_ns if start_ns is None else start_ns

    def run_scenario(self) -> None:
        """Take ticks to the scenario's end, or to where its begin may no longer come."""
        player = self.player
        while player is not None and not player.over and not self._ended(player):
            self.step(self._poll_ticks)

    def _ended(self, player: ScenarioPlayer) -> bool:
        return player.start_ns is not None and self.now_ns >= player.start_ns + player.ticks * self.bench.step_ns

    def run(self, ticks: int) -> None:
        """Take many ticks."""
        while ticks > 0:
            ticks -= self.step(ticks)

    def set(self, index: int, value: float) -> None:
        """Set an input of the plant from the next tick on."""
        self._loop.commanded[index] = value

    def end_fault(self, course: Course) -> None:
        """Let a fault go."""
        self.faults.end(course)

    def insert_fault(self, entry: FaultEntry) -> Course:
        """Insert a fault; its times count from now."""
        made = entry.inserted(self.bench.step_ns / SECOND_NS)
        return self.faults.hold(replace(made, at=made.at + self.ticks))
