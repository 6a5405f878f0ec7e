"""The motor network left alone, section 6.4.4: Figure 6-23, beside the guarded one and the physical motor."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench, initial_state
from hilplant.failure import Failure
from hilplant.models.load import LOADS
from hilplant.models.motor_choice import NARX
from hilplant.models.narx import NETWORK, SLOW_BRUSH, path_of, predict
from hilplant.models.plant import simulate_rows
from hilplant.models.records import PARAMETER_INDEX, Sample
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

#: The run: voltage [V] and constant torque at the crank [N m], how long it is [s], and when the bare network begins.
SUPPLY_V, TORQUE_N_M, END_S, BEGIN_S = 16.0, 8.0, 8.5, 1.0
#: What is not within the training: from when to when [s], at which voltage [V].
BEYOND = {"off": (5.2, 5.8, 0.0), "at_25_v": (6.5, 7.5, 25.0)}


class BareRun(NamedTuple):
    """The same voltage and torque on three models of a motor: current [A] and crank speed [rad/s] of each over time.

    `active` says where the guarded network was asked. The bare one begins at `BEGIN_S`; it is not-a-number before.
    """

    time_s: Floats
    voltage_v: Floats
    current_a: dict[str, Floats]
    speed_rad_s: dict[str, Floats]
    active: Floats

    def columns(self) -> dict[str, Floats]:
        """Return time, voltage and all curves by name."""
        found = {"time_s": self.time_s, "terminal_v": self.voltage_v, "guarded_active": self.active}
        for name in self.current_a:
            found |= {f"{name}_current_a": self.current_a[name], f"{name}_crank_speed_rad_s": self.speed_rad_s[name]}
        return found

    def errors(self, name: str) -> dict[str, float]:
        """Return the largest errors of current and speed in each part of `BEYOND`, and after them, once it settled."""
        spans = {part: (begin, end) for part, (begin, end, _) in BEYOND.items()} | {"after": (END_S - 0.5, END_S)}
        found: dict[str, float] = {}
        for part, (begin, end) in spans.items():
            within = (self.time_s > begin + 0.3) & (self.time_s < end) if part != "after" else self.time_s >= begin
            for unit, curves in (("current_a", self.current_a), ("crank_speed_rad_s", self.speed_rad_s)):
                found[f"{name}_{part}_{unit}"] = float(np.abs(curves[name] - curves["physical"])[within].max())
        return found


def bare_run(bench: Bench) -> BareRun:
    """Run the slow brush of a bench's motor network bare, guarded, and its physical motor, under a constant torque.

    Raises
    ------
    Failure
        For a bench without a motor network.

    """
    if bench.parameters.motor_model != NARX:
        raise Failure(f"{bench.path}: has no motor network; the bench networks has one")
    step_s = bench.parameters.step_s
    time_s: Floats = np.arange(round(END_S / step_s), dtype=np.float64) * step_s
    volts: Floats = np.full(len(time_s), SUPPLY_V)
    for begin_s, end_s, other in BEYOND.values():
        volts[(time_s >= begin_s) & (time_s < end_s)] = other
    currents, speeds = {}, {}
    for name, model in (("physical", 0.0), ("guarded", float(NARX))):
        outputs = _plant(bench, model, volts)
        currents[name], speeds[name] = (outputs[:, OUTPUT_INDEX[key]] for key in ("current_a", "crank_speed_rad_s"))
    active = (outputs[:, OUTPUT_INDEX["motor_mode"]] == NETWORK).astype(np.float64)
    begin = round(BEGIN_S / step_s)
    first = [
        Sample(SUPPLY_V, TORQUE_N_M, float(currents["physical"][tick]), float(speeds["physical"][tick]))
        for tick in (begin - 1, begin)
    ]
    alone = _bare(bench.parameters.networks, volts[begin:], first)
    for each, column in ((currents, alone[:, 0]), (speeds, alone[:, 1])):
        each["bare"] = np.concatenate([np.full(begin, np.nan), column])
    return BareRun(time_s, volts, currents, speeds, active)


def _plant(bench: Bench, model: float, volts: Floats) -> Floats:
    """Return the outputs of the step with one of its two motors, and no load but the constant torque."""
    row = bench.parameter_row.copy()
    row[PARAMETER_INDEX["motor_model"]] = model
    row[PARAMETER_INDEX["load.model"]] = LOADS.index("none")
    inputs = np.tile(bench.input_row, (len(volts), 1))
    given = {"relay_fast": 0.0, "brake_torque_n_m": TORQUE_N_M}
    for name, value in given.items():
        inputs[:, INPUT_INDEX[name]] = value
    inputs[:, INPUT_INDEX["relay_on"]] = volts > 0.0
    inputs[:, INPUT_INDEX["supply_v"]] = np.where(volts > 0.0, volts, SUPPLY_V)
    outputs = np.empty((len(volts), len(OUTPUTS)))
    simulate_rows(initial_state(bench.parameters, bench.initial), inputs, row, bench.tables, outputs)
    return outputs


def _bare(networks: Floats, volts: Floats, first: list[Sample]) -> Floats:
    """Return current and speed of each tick, the network reading its own answers, whatever they are."""
    before, now = first
    path, answers = path_of(networks, SLOW_BRUSH), np.empty((len(volts), 2))
    for tick, voltage in enumerate(volts):
        now = Sample(float(voltage), TORQUE_N_M, now.current_a, now.speed_rad_s)
        answers[tick] = now.current_a, now.speed_rad_s
        answer = predict(networks, path, now, before)
        before, now = now, Sample(now.terminal_v, TORQUE_N_M, answer.current_a, answer.speed_rad_s)
    return answers
