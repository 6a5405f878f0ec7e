"""What stage 1 saw and what it makes of it: raw and filtered data, and the transfer function's answer, 5-7 to 5-11."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.identify.breakaway import torque_part
from hilplant.identify.filters import filtered, held_answer
from hilplant.identify.first_stage import FirstStage, ModeResult
from hilplant.identify.srivc import TransferFit, simulated
from hilplant.measurements.measurement import Measurement, running


class ModeSignals(NamedTuple):
    """One mode: its time [s], voltage [V] and current [A] there, both behind the last filter, and the answer [A].

    The filter is 1/A of the transfer function, scaled to 1 at frequency 0, which (5.13) and (5.14) were found behind.
    """

    mode: str
    result: ModeResult
    time_s: Floats
    voltage_v: Floats
    current_a: Floats
    filtered_v: Floats
    filtered_a: Floats
    answer_a: Floats

    @property
    def rms_a(self) -> float:
        """Root mean square of the answer's error."""
        return float(np.sqrt(np.mean((self.answer_a - self.current_a) ** 2)))

    def columns(self) -> dict[str, Floats]:
        """Return time and all signals by name."""
        names = ("time_s", "voltage_v", "current_a", "filtered_v", "filtered_a", "answer_a")
        return {name: getattr(self, name) for name in names}


def stage_one_signals(results: FirstStage, judged: Measurement) -> list[ModeSignals]:
    """Answer the voltage of `judged` in each mode: of the data that stage 1 saw, or of others (Figures 5-10, 5-11)."""
    return [_signals(judged, mode, result) for mode, result in results.items()]


def _signals(data: Measurement, mode: str, result: ModeResult) -> ModeSignals:
    used = running(data) & (data.fast == float(mode == "fast"))
    places = np.flatnonzero(used)
    part = slice(max(0, int(places[0]) - 100), int(places[-1]) + 1) if len(places) else slice(0, len(data))
    voltage = np.where(used[part], data.voltage_v[part], 0.0)
    current = np.where(used[part], data.current_a[part], 0.0)
    model = np.array([result.fit.function.a1, result.fit.function.a0])
    behind = [filtered(values, model, data.period_s, held=True)[:, 1] * model[1] for values in (voltage, current)]
    answer = answer_from_rest(result.fit, voltage, data.period_s)
    return ModeSignals(mode, result, data.time_s[part], voltage, current, behind[0], behind[1], answer)


def answer_from_rest(fit: TransferFit, voltage_v: Floats, period_s: float) -> Floats:
    """Return the current [A] of a transfer function with its dry torque for a voltage that begins at rest."""
    rest = int(np.argmax(voltage_v > 0.0)) if np.any(voltage_v > 0.0) else len(voltage_v)
    function = fit.function
    model = np.array([function.a1, function.a0])
    theta = np.array([function.a1, function.a0, function.b1, function.b0, fit.friction])
    torque = torque_part(voltage_v, rest, period_s, theta if rest else None)
    linear = simulated(function, voltage_v, period_s)
    return np.asarray(linear + fit.friction * held_answer([0.0, 1.0], model, torque, period_s))
