"""Plant and controller without a bus and without waiting: in virtual time, one ECU period after the other."""

import math
from copy import copy

import numpy as np

from hilplant.bench import Bench
from hilplant.ecu.relay_controller import ControllerState, advance
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.vocabulary import RELAYS_OFF, EcuInputs, Fault, RelaySettings, Stalk
from hilplant.models.plant import simulate_rows
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
from hilplant.units import MILLISECOND_NS, SECOND_NS, TURN_RAD

_ON, _FAST = INPUT_INDEX["relay_on"], INPUT_INDEX["relay_fast"]
_ANGLE, _CONTACT, _CURRENT, _SUPPLY = (
    OUTPUT_INDEX[name] for name in ("crank_angle_rad", "park_contact", "current_a", "supply_v")
)


class ClosedLoop:
    """A bench's plant and the stand-in ECU, tied together directly.

    In each of the bench's ECU periods the plant takes its ticks and the controller looks once, at the last of them;
    its relays act `delay_ticks` ticks later, at most a period. `inputs` is the plant's row of inputs, to be written to.
    `park_known` false keeps the park contact from the controller. `turns` is how far the crank has come.
    """

    def __init__(self, bench: Bench, settings: RelaySettings | None = None, delay_ticks: int = 1) -> None:
        ticks = max(1, round(bench.ecu.period_ms * MILLISECOND_NS / bench.step_ns))
        if not 0 <= delay_ticks <= ticks:
            raise ValueError(f"delay_ticks must be 0 to {ticks}, the ECU's period, not {delay_ticks}")
        self.settings = settings or controller_settings(bench.ecu)
        self.inputs = bench.input_row.copy()
        self.ecu, self.relays, self.fault = ControllerState(), RELAYS_OFF, Fault.NONE
        self.park_known = True
        self.time_s, self.turns = 0.0, 0.0
        self.period_s = ticks * bench.step_ns / SECOND_NS
        self._bench, self._plant, self._delay = bench, bench.state_row.copy(), delay_ticks
        self._acting, self._angle = RELAYS_OFF, float(bench.initial["crank_angle_rad"])
        self._rows = np.repeat(self.inputs[np.newaxis], ticks, axis=0)
        self._outputs = np.zeros((ticks, len(OUTPUTS)))

    def __getitem__(self, name: str) -> float:
        """Return an output of the plant, by its name, at the last tick."""
        return float(self._outputs[-1, OUTPUT_INDEX[name]])

    def copy(self) -> "ClosedLoop":
        """Return a loop that goes on from here without touching this one."""
        other = copy(self)
        other.inputs, other._outputs, other._plant = self.inputs.copy(), self._outputs.copy(), self._plant.copy()
        return other

    def drive(self, seconds: float, stalk: Stalk) -> None:
        """Hold the stalk for a while."""
        for _ in range(round(seconds / self.period_s)):
            self.step(stalk)

    def step(self, stalk: Stalk) -> None:
        """Let the plant run for a period of the ECU, and the controller look at where it has come."""
        rows, delay = self._rows, self._delay
        rows[:] = self.inputs
        rows[:delay, _ON], rows[:delay, _FAST] = self._acting
        rows[delay:, _ON], rows[delay:, _FAST] = self._acting = self.relays
        simulate_rows(self._plant, rows, self._bench.parameter_row, self._bench.tables, self._outputs)
        seen = self._outputs[-1].tolist()
        self.turns += math.remainder(seen[_ANGLE] - self._angle, TURN_RAD) / TURN_RAD
        self._angle = seen[_ANGLE]
        self.time_s += self.period_s
        contact = seen[_CONTACT] > 0.5 if self.park_known else None
        inputs = EcuInputs(stalk, contact, seen[_CURRENT], seen[_SUPPLY])
        self.ecu, self.relays, self.fault = advance(self.ecu, inputs, self.time_s, self.settings)
