"""Stage 1 (section 5.3): a measurement -> the transfer function of each mode -> motor parameters, with standard errors.

(5.7) takes the load as proportional to the speed, but a wiper's load changes with the crank angle. Over a whole
recording that bends every coefficient, and often leaves none that a motor could have. So only the first `WINDOW_S`
after each step of the voltage are used: the crank hardly turns meanwhile, and any state at their start is allowed for.

Two ways lead from coefficients to parameters. `by_load` is the thesis': it assumes the load's drag, (5.15), and K and J
hang on that. `by_park` needs no assumption: the park switch gives the mean speed, so K follows from (5.18) over whole
turns, then J from the coefficients. Standard errors stand for the noise, not for what is left of the load.
"""

from collections.abc import Mapping
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from uncertainties import correlated_values

from hilplant.arrays import Flags, Floats
from hilplant.failure import Failure
from hilplant.identify.srivc import Stretch, TransferFit, fit
from hilplant.identify.transfer_function import (
    Coefficients,
    Equivalent,
    TransferFunction,
    by_constant,
    by_load,
    coefficients,
    load_constant,
)  # fmt: skip
from hilplant.measurements.alignment import resting, voltage_steps
from hilplant.measurements.measurement import Measurement, running
from hilplant.measurements.park import rising_edges
from hilplant.motor_bench.bench_measurements import (
    MotorFriction,
    back_emf_constant,
    mean_of,
    no_load_friction,
    quantity,
)
from hilplant.motor_bench.bench_measurements import SteadyRun as _Turn

#: How much of the data is used around each step: long for the electrical time constant, short for the load [s].
BEFORE_S, WINDOW_S = 0.01, 0.04
#: Standard error of a turn's time in samples: each of its two park edges lies anywhere between two of them.
EDGES_SAMPLES = (2.0 / 12.0) ** 0.5
#: A turn counts in which no more of the samples are bridged, and no more than so many in a row.
BRIDGED_PART, BRIDGED_RUN = 0.05, 5
_NO_STEP = "no step of the voltage with the motor on; record switching on at several voltages"


class ModeResult(NamedTuple):
    """What stage 1 found for one mode; every number carries its standard error.

    `by_park` is None where no whole turn lies in this mode. `load` is the mean torque at the shaft over the speed of
    those turns, motor and wiper together, as damping and dry torque; None without two different speeds. `left_out` says
    why whole turns do not count, or that there is none; "" where all do.
    """

    mode: str
    fit: TransferFit
    coefficients: Coefficients
    by_load: Equivalent
    by_park: Equivalent | None
    load: MotorFriction | None
    steps: int
    turns: int
    left_out: str


class _Turns(NamedTuple):
    counted: list[_Turn]
    left_out: str


class FirstStage(dict[str, ModeResult]):
    """Results by mode; `failures` says of each other mode that the data contain why nothing settles for it."""

    def __init__(self, results: Mapping[str, ModeResult], failures: Mapping[str, str]) -> None:
        super().__init__(results)
        self.failures = dict(failures)


def first_stage(data: Measurement, gear_ratio: float, drag_n_m_s: float | None = None) -> FirstStage:
    """Return what the data say of each mode that they contain.

    `drag_n_m_s` is the assumed b + gamma; left out, it is that of (5.15).

    Raises
    ------
    Failure
        When the mode is not known, or nothing settles for any mode that the data contain.

    """
    if np.all(np.isnan(data.fast)):
        raise Failure(
            f"{data.source}: nothing says whether the motor runs slow or fast; name a column (--columns fast=NAME) or "
            "say --mode slow"
        )
    results: dict[str, ModeResult] = {}
    failures: dict[str, str] = {}
    drag = drag_n_m_s or load_constant(gear_ratio=gear_ratio)
    steps = voltage_steps(data.voltage_v, data.period_s)
    for mode, value in (("slow", 0.0), ("fast", 1.0)):
        mask = running(data) & (data.fast == value)
        windows = _windows(data, mask, steps)
        if not windows:
            if np.count_nonzero(mask) * data.period_s > WINDOW_S:
                failures[mode] = _NO_STEP
            continue
        try:
            results[mode] = _mode(data, mode, windows, _turns(data, mask, gear_ratio), drag)
        except Failure as error:
            failures[mode] = str(error)
    if not results:
        told = "; ".join(f"{data.source}, {mode} mode: {text}" for mode, text in failures.items())
        raise Failure(told or f"{data.source}: {_NO_STEP}")
    return FirstStage(results, failures)


def _windows(data: Measurement, mask: Flags, steps: list[int]) -> list[slice]:
    """Return the samples about each step after which the motor stays on in this mode."""
    before, after = round(BEFORE_S / data.period_s), round(WINDOW_S / data.period_s)
    windows = []
    for step in steps:
        if not np.all(mask[step : step + after]):
            continue
        same = data.fast[step - before : step] == data.fast[step]
        windows.append(slice(step - before if np.all(same) else step, step + after))
    return windows


def _mode(data: Measurement, mode: str, windows: list[slice], turns: _Turns, drag_n_m_s: float) -> ModeResult:
    current = _bridged(data.current_a, data.valid)
    rest = resting(data.voltage_v, data.period_s)
    stretches = [
        Stretch(data.voltage_v[part], current[part], data.valid[part], int(np.count_nonzero(rest[part])))
        for part in windows
    ]
    found = fit(stretches, data.period_s, friction=True)
    if not _sound(found):
        raise Failure(
            f"the coefficients have no standard errors: the {len(windows)} steps of the "
            "voltage say too little beside noise and load; record more switching on, at several voltages"
        )
    named = coefficients(TransferFunction(*correlated_values([*found.function, found.friction], found.covariance)[:4]))
    _refuse_impossible(named)
    assumed = by_load(named, drag_n_m_s)
    told = ModeResult(mode, found, named, assumed, None, None, len(windows), len(turns.counted), turns.left_out)
    if not turns.counted:
        return told
    constants = [back_emf_constant(turn, assumed.resistance_ohm) for turn in turns.counted]
    motor = by_constant(named, mean_of(constants))
    return told._replace(by_park=motor, load=_load(turns.counted, motor))


def _sound(found: TransferFit) -> bool:
    """Say whether coefficients and covariance are such as a fit gives that settled."""
    values = np.array([*found.function, found.friction])
    return bool(np.all(np.isfinite(values)) and np.all(np.isfinite(found.covariance))
        and np.all(np.diag(found.covariance) > 0.0) and found.function.b1 != 0.0)  # fmt: skip


def _load(turns: list[_Turn], motor: Equivalent) -> MotorFriction | None:
    speeds = [quantity(turn.speed_rad_s).n for turn in turns]
    if max(speeds) - min(speeds) < 0.05 * max(speeds):
        return None
    return no_load_friction(turns, [motor.constant_v_s] * len(turns))


def _refuse_impossible(named: Coefficients) -> None:
    """Refuse coefficients that no motor has."""
    for name, value in named._asdict().items():
        if not value.n > 0.0:
            raise Failure(
                f"the data give {name} = {value.n:.3g}, which no motor has: the load hides "
                "it; record more switching on and steps of the voltage, or filter less"
            )


def _bridged(values: Floats, valid: Flags) -> Floats:
    """Put a straight line where samples do not count, so that a filter is not upset by what it must not see."""
    places = np.arange(len(values))
    return np.where(valid, values, np.interp(places, places[valid], values[valid]))


def _turns(data: Measurement, mask: Flags, gear_ratio: float) -> _Turns:
    """Return the means over each whole turn between park edges in this mode; L di/dt is nearly 0 there."""
    whole = [(begin, end) for begin, end in pairwise(rising_edges(data.park).tolist()) if np.all(mask[begin:end])]
    signals = [_bridged(values, data.valid) for values in (data.voltage_v, data.current_a)]
    counted = []
    for begin, end in whole:
        if _unbroken(data.valid, begin, end):
            seconds = quantity((end - begin) * data.period_s, EDGES_SAMPLES * data.period_s)
            volts, amperes = (float(np.mean(values[begin:end])) for values in signals)
            counted.append(_Turn(volts, amperes, 2.0 * np.pi * gear_ratio / seconds))
    if not whole:
        return _Turns([], "no whole turn between two park edges")
    lost = len(whole) - len(counted)
    why = (
        f"{lost} of {len(whole)} whole turns left out: more than {100.0 * BRIDGED_PART:g} % of the samples missing or "
        f"outliers, more than {BRIDGED_RUN} in a row, or one at a park edge"
    )
    return _Turns(counted, why if lost else "")


def _unbroken(valid: Flags, begin: int, end: int) -> bool:
    """Say whether few enough samples of a turn are bridged for its means, and none at the edges that give its time."""
    bad = ~valid[begin:end]
    runs = np.diff(np.flatnonzero(np.concatenate([[True], ~bad, [True]]))) - 1
    edges = np.concatenate([valid[begin - 1 : begin + 1], valid[end - 1 : end + 1]])
    return bool(np.all(edges)) and float(np.mean(bad)) <= BRIDGED_PART and int(np.max(runs)) <= BRIDGED_RUN
