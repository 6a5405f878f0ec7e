"""Where a velocity controller sits: its memory between ticks, for the 1 kHz loop and for a node on the bus."""

from typing import Any

import numpy as np

from hilplant.control.closed_loop import Commanded, commanded, measure
from hilplant.control.controller import Tables, control
from hilplant.control.records import POWER_ON, Command, Controller, Measured, Memory
from hilplant.control.reference import OWN, Reference, wanted_speed
from hilplant.jit import compiled
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack, unpack, write
from hilplant.signals import INPUT_INDEX, WANTED, Inputs
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: The plant's inputs that a controller commands, by index.
COMMANDED = frozenset(INPUT_INDEX[name] for name in Commanded._fields)
#: A controller in the loop that was not asked for longer than this has been put aside: it begins anew.
ASIDE_NS = 50 * MILLISECOND_NS


class Seat:
    """A controller with its memory. Construction compiles it, so that no tick meets cold code."""

    stopped = ""  # why it was stopped, as one of a user's may be

    def __init__(self, controller: Controller, tables: Tables, reference: Reference) -> None:
        """Sit down; `reference` gives the wanted speed [rad/s] by the time [s]."""
        self.reference = reference
        self._controller, self._tables = controller, tables
        self.memory = POWER_ON
        _decide(POWER_ON, Measured(0.0, 0.0, 0.0), 0.0, controller, tables)

    def decide(self, now_s: float, measured: Measured, heard_rad_s: float = OWN) -> Command:
        """Take one tick; a wanted speed that was heard goes before the reference."""
        wanted = wanted_speed(self.reference, now_s, heard_rad_s)
        self.memory, command = _decide(self.memory, measured, wanted, self._controller, self._tables)
        return command

    def forget(self) -> None:
        """Begin anew at the next tick, as after power-on."""
        self.memory = POWER_ON


class LoopSeat(Seat):
    """A controller inside the plant's loop: it sees the state of each tick, and writes relays and supply for it."""

    def __init__(self, controller: Controller, tables: Tables, reference: Reference, parameter_row: Any) -> None:
        """Sit down beside a plant with these packed parameters."""
        super().__init__(controller, tables, reference)
        self._asked_ns = 0
        plant = (pack(State()), parameter_row, np.zeros(len(INPUT_INDEX)))
        _drive(POWER_ON, 0.0, controller, tables, plant)

    def drive(self, now_ns: int, state_row: Any, input_row: Any, parameter_row: Any) -> bool:
        """Take one tick on the loop's own rows; `input_row` gets the command. It is what ``Loop.control`` calls.

        While the loop is in its safe state it does not ask; after that the controller begins anew, as on the bus.
        """
        if now_ns - self._asked_ns > ASIDE_NS:
            self.forget()
        self._asked_ns = now_ns
        wanted = wanted_speed(self.reference, now_ns / SECOND_NS, input_row[WANTED])
        plant = (state_row, parameter_row, input_row)
        self.memory = _drive(self.memory, wanted, self._controller, self._tables, plant)
        return True


@compiled
def _decide(
    memory: Memory, measured: Measured, reference: float, controller: Controller, tables: Tables
) -> tuple[Memory, Command]:
    return control(memory, measured, reference, controller, tables)


@compiled
def _drive(memory: Memory, reference: float, controller: Controller, tables: Tables, plant: Any) -> Memory:
    state_row, parameter_row, input_row = plant
    parameters = unpack(Parameters, parameter_row)
    measured = measure(unpack(State, state_row), parameters)
    memory, command = control(memory, measured, reference, controller, tables)
    write(commanded(unpack(Inputs, input_row), command.voltage_v, command.fast), input_row)
    return memory
