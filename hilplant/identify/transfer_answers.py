"""A bench's motor by its equations and by its transfer function (5.7), side by side: Figure 5-7."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench, initial_state
from hilplant.failure import Failure
from hilplant.identify.srivc import simulated
from hilplant.identify.transfer_function import Equivalent, TransferFunction, of_motor
from hilplant.models.load import LOADS
from hilplant.models.plant import simulate_rows
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

ON_S, OFF_S, END_S = 0.5, 2.5, 3.5


class TransferAnswer(NamedTuple):
    """One brush at a step of the voltage: its transfer function, and both currents [A] over time [s]."""

    brush: str
    function: TransferFunction
    time_s: Floats
    plant_a: Floats
    answer_a: Floats

    @property
    def worst_a(self) -> float:
        """Largest difference."""
        return float(np.abs(self.answer_a - self.plant_a).max())


def transfer_answers(bench: Bench, supply_v: float) -> list[TransferAnswer]:
    """Switch the motor on and off with each brush.

    Raises
    ------
    Failure
        For a bench with a load, or a motor with dry friction: (5.7) has neither.

    """
    if LOADS[int(bench.parameters.load.model)] != "none" or bench.parameters.motor.coulomb_torque_n_m:
        raise Failure(f"{bench.path}: (5.7) is of a motor without load and dry friction; the bench appendix_a has one")
    return [_answered(bench, supply_v, fast) for fast in (False, True)]


def _answered(bench: Bench, supply_v: float, fast: bool) -> TransferAnswer:
    parameters, step_s = bench.parameters, bench.parameters.step_s
    time_s: Floats = np.arange(round(END_S / step_s), dtype=np.float64) * step_s
    volts: Floats = np.where((time_s >= ON_S) & (time_s < OFF_S), supply_v, 0.0)
    rows = np.tile(bench.input_row, (len(time_s), 1))
    for name, values in (
        ("relay_on", (volts > 0.0).astype(float)),
        ("relay_fast", float(fast)),
        ("supply_v", supply_v),
    ):
        rows[:, INPUT_INDEX[name]] = values
    outputs = np.empty((len(rows), len(OUTPUTS)))
    simulate_rows(initial_state(parameters, bench.initial), rows, bench.parameter_row, bench.tables, outputs)
    brush = parameters.motor.fast if fast else parameters.motor.slow
    motor = Equivalent(*brush, parameters.motor.inertia_kg_m2, parameters.motor.damping_n_m_s)
    function = of_motor(motor)
    answer = simulated(function, volts, step_s)
    plant = outputs[:, OUTPUT_INDEX["current_a"]]
    return TransferAnswer("fast" if fast else "slow", function, time_s, plant, answer)
