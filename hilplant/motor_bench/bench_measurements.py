"""Motor parameters measured one by one on a bench, section 5.4, each with the standard error that its readings give it.

Every function takes readings as plain numbers or as ``uncertainties.ufloat`` (value, standard error); errors are
carried on to first order. All speeds are the motor shaft's.
"""

import warnings
from collections.abc import Sequence
from typing import NamedTuple, TypeAlias

import numpy as np
from scipy.optimize import least_squares
from uncertainties import UFloat, correlated_values, ufloat

from hilplant.arrays import Floats
from hilplant.failure import Failure

Number: TypeAlias = float | UFloat


class SteadyRun(NamedTuple):
    """One steady point: voltage at the terminals, current, shaft speed."""

    voltage_v: Number
    current_a: Number
    speed_rad_s: Number


class MotorFriction(NamedTuple):
    """The motor's own friction: K i = b w + T while it turns without a load."""

    damping_n_m_s: Number
    coulomb_torque_n_m: Number


def quantity(value: Number, error: float = 0.0) -> UFloat:
    """Return a reading as a quantity; a plain number has the standard error that is given, else none."""
    if isinstance(value, UFloat):
        return value
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # it warns of quantities without an error; they are meant
        return ufloat(value, error)


def mean_of(readings: Sequence[Number]) -> UFloat:
    """Return the mean; its error is the larger of what the readings' errors and what their scatter give."""
    quantities = [quantity(reading) for reading in readings]
    mean = sum(quantities) / len(quantities)
    if len(quantities) < 2:
        return quantity(mean)
    scatter = float(np.std([each.nominal_value for each in quantities], ddof=1)) / len(quantities) ** 0.5
    return quantity(mean.nominal_value, max(mean.std_dev, scatter))


def resistance(readings: Sequence[tuple[Number, Number]]) -> UFloat:
    """Return V/I [ohm] of a motor that is held still, from voltages and currents; (5.16), (5.17) with speed 0.

    Take it at currents as in use, and warm: brushes and copper change.
    """
    return mean_of([voltage / current for voltage, current in readings])


def back_emf_constant(run: SteadyRun, resistance_ohm: Number) -> UFloat:
    """Return (V - R I)/w [V s/rad] of one steady point, (5.18)."""
    return quantity((run.voltage_v - resistance_ohm * run.current_a) / run.speed_rad_s)


def shaft_speed(turns: int, seconds: Number, gear_ratio: float) -> UFloat:
    """Return the shaft's mean speed [rad/s] over whole turns of the crank between park edges."""
    return quantity(2.0 * np.pi * turns * gear_ratio / seconds)


def inductance(time_constant_s: Number, resistance_ohm: Number) -> UFloat:
    """Return tau R [H] of a motor that is held still, (5.19), (5.20)."""
    return quantity(time_constant_s * resistance_ohm)


def fall_time(time_s: Floats, current_a: Floats, step_s: float) -> float:
    """Return the time after `step_s` until the current has fallen to 1/e of its value at the step, read as in 5.4.3.

    Raises
    ------
    Failure
        When the current never falls that far.

    """
    before = current_a[time_s < step_s]
    start = float(np.mean(before[-10:])) if len(before) else float(current_a[0])
    below = np.flatnonzero((time_s >= step_s) & (current_a <= start / np.e))
    if not below.size:
        text = "is the rotor blocked and the supply at 0 V?"
        raise Failure(f"the current does not fall to 36.8 % of its value at the step; {text}")
    index = int(below[0])
    pair = slice(max(index - 1, 0), index + 1)
    return float(np.interp(-start / np.e, -current_a[pair], time_s[pair])) - step_s


def decay(time_s: Floats, current_a: Floats) -> tuple[UFloat, UFloat, UFloat]:
    """Return time constant [s], height [A] and end value [A] of a current that decays, by least squares.

    All samples count, not the one where it crosses 36.8 %; the samples must begin at or after the step.

    Raises
    ------
    Failure
        When the current does not decay.

    """
    elapsed = time_s - time_s[0]
    span = float(current_a[0] - current_a[-1])

    def residuals(x: Floats) -> Floats:
        return np.asarray(x[2] + x[1] * np.exp(-elapsed / np.exp(x[0])) - current_a, np.float64)

    fits = [least_squares(residuals, [np.log(elapsed[-1] / part), span, current_a[-1]]) for part in (2, 6, 20, 60)]
    best = min(fits, key=lambda found: float(found.cost))
    log_tau, height, end = correlated_values(best.x, _covariance(best.jac, best.fun))
    tau_s = np.exp(best.x[0]) * (1.0 + (log_tau - best.x[0]))
    if not 0.0 < tau_s.nominal_value < elapsed[-1] or tau_s.std_dev > 0.5 * tau_s.nominal_value:
        text = "give the samples from the step to some five time constants after it"
        raise Failure(f"the current shows no exponential decay; {text}")
    return quantity(tau_s), quantity(height), quantity(end)


def cylinder_inertia(mass_kg: Number, radius_m: Number) -> UFloat:
    """Return m r^2/2 [kg m2] of an armature as a solid cylinder, (5.21): an upper estimate, for its edge has slots."""
    return quantity(0.5 * mass_kg * radius_m * radius_m)


def no_load_friction(runs: Sequence[SteadyRun], constants_v_s: Sequence[Number]) -> MotorFriction:
    """Return damping and Coulomb torque from no-load points at different speeds: a straight line K I = b w + T.

    Errors come from the points' distance from the line; two points leave none, so theirs come from the readings alone.

    Raises
    ------
    Failure
        With fewer than two speeds.

    """
    torques = [constant * run.current_a for run, constant in zip(runs, constants_v_s, strict=True)]
    speeds = [quantity(run.speed_rad_s) for run in runs]
    count, spread = len(runs), [speed - sum(speeds) / len(speeds) for speed in speeds]
    denominator = sum(each * each for each in spread)
    if count < 2 or quantity(denominator).nominal_value <= 0.0:
        raise Failure("damping and Coulomb torque need no-load points at two speeds at least")
    slope = sum(each * torque for each, torque in zip(spread, torques, strict=True)) / denominator
    level = sum(torques) / count - slope * sum(speeds) / count
    if count == 2:
        return MotorFriction(quantity(slope), quantity(level))
    return _with_scatter(torques, speeds, quantity(slope), quantity(level))


def bounded_friction(runs: Sequence[SteadyRun], constants_v_s: Sequence[Number]) -> MotorFriction:
    """Return :func:`no_load_friction` where neither is negative; the one that is, within its error, is 0.

    Within two standard errors 0 explains the points as well; the other is then what the points say beside it. One that
    is farther below 0 is returned as it is.
    """
    damping, dry = (quantity(each) for each in no_load_friction(runs, constants_v_s))
    torques = [quantity(constant * run.current_a) for run, constant in zip(runs, constants_v_s, strict=True)]
    if -2.0 * damping.s <= damping.n < 0.0:
        return MotorFriction(quantity(0.0, damping.s), mean_of(torques))
    if -2.0 * dry.s <= dry.n < 0.0:
        slopes = [torque / run.speed_rad_s for run, torque in zip(runs, torques, strict=True)]
        return MotorFriction(mean_of(slopes), quantity(0.0, dry.s))
    return MotorFriction(damping, dry)


def _with_scatter(torques: Sequence[Number], speeds: Sequence[UFloat], slope: UFloat, level: UFloat) -> MotorFriction:
    x = np.array([speed.nominal_value for speed in speeds])
    y = np.array([quantity(torque).nominal_value for torque in torques])
    design = np.column_stack([x, np.ones_like(x)])
    errors = y - design @ [slope.nominal_value, level.nominal_value]
    covariance = np.linalg.inv(design.T @ design) * float(errors @ errors) / (len(x) - 2)
    found = (max(each.std_dev, float(np.sqrt(covariance[i, i]))) for i, each in enumerate((slope, level)))
    return MotorFriction(
        *(quantity(each.nominal_value, error) for each, error in zip((slope, level), found, strict=True))
    )


def run_down(time_s: Floats, speed_rad_s: Floats, friction: MotorFriction) -> UFloat:
    """Return the inertia [kg m2] from a run-down without current: J dw/dt = -b w - T, with b and T known.

    The terminals must be open: the speed is then the open voltage over K. Only the ratio of friction to inertia shows
    in a run-down, so the friction's error is carried on.

    Raises
    ------
    Failure
        When the speed does not fall.

    """
    elapsed = time_s - time_s[0]

    def speed(x: Floats) -> Floats:
        b, torque = (quantity(each).nominal_value for each in friction)
        if abs(b) * elapsed[-1] < 1e-9 * x[1]:
            return np.asarray(np.maximum(x[0] - torque * elapsed / x[1], 0.0), np.float64)
        return np.asarray(np.maximum((x[0] + torque / b) * np.exp(-b * elapsed / x[1]) - torque / b, 0.0), np.float64)

    if not float(np.mean(speed_rad_s[-5:])) < 0.9 * float(np.mean(speed_rad_s[:5])):
        raise Failure("the speed does not fall by a tenth; a run-down needs open terminals and no supply")
    slope = (speed_rad_s[0] - speed_rad_s[len(elapsed) // 2]) / elapsed[len(elapsed) // 2]
    guess = quantity(friction[0] * speed_rad_s[0] + friction[1]).nominal_value / max(slope, 1e-9)

    def residuals(x: Floats) -> Floats:
        return speed(np.array([x[0] * speed_rad_s[0], x[1] * guess])) - speed_rad_s

    fit = least_squares(residuals, [1.0, 1.0], bounds=([0.0, 1e-3], [10.0, 1e3]))
    error = float(np.sqrt(_covariance(fit.jac, fit.fun)[1, 1])) * guess
    level = speed_rad_s[0] / 2.0
    scale = (friction[0] * level + friction[1]) / quantity(friction[0] * level + friction[1]).nominal_value
    return quantity(quantity(fit.x[1] * guess, error) * scale)


def _covariance(jacobian: Floats, residuals: Floats) -> Floats:
    freedom = max(1, len(residuals) - jacobian.shape[1])
    return np.asarray(np.linalg.pinv(jacobian.T @ jacobian) * float(residuals @ residuals) / freedom, np.float64)
