"""A motor from its data sheet: no-load and stall points of both speeds -> parameters, and what the sheet does not say.

For each brush: R = V/I_stall, K = (V - R I_0)/w_0 (5.18). K I_0 = b w_0 + T at two speeds gives damping and Coulomb
torque.
The stall torque is known from K and I_stall already, so it tells the gear's efficiency: T_stall = e N (K I_stall - T).
Inductance and inertia are on no such sheet; both need a record over time.
"""

from typing import NamedTuple

from uncertainties import UFloat

from hilplant.failure import Failure
from hilplant.motor_bench.bench_measurements import (
    MotorFriction,
    Number,
    SteadyRun,
    back_emf_constant,
    bounded_friction,
    mean_of,
    quantity,
)  # fmt: skip


class SpeedSheet(NamedTuple):
    """What a sheet says of one speed; speed and torque are at the gear's output."""

    voltage_v: Number
    no_load_current_a: Number
    no_load_speed_rad_s: Number
    stall_current_a: Number
    stall_torque_n_m: Number | None = None


class SheetMotor(NamedTuple):
    """Parameters from a sheet; `unknown` names those that it cannot tell."""

    slow_resistance_ohm: UFloat
    slow_constant_v_s: UFloat
    fast_resistance_ohm: UFloat
    fast_constant_v_s: UFloat
    friction: MotorFriction
    gear_efficiency: UFloat | None
    unknown: tuple[str, ...] = ("slow_inductance_henry", "fast_inductance_henry", "inertia_kg_m2")


def with_error(value: float, relative: float) -> UFloat:
    """Return a number of a sheet with a relative standard error: a tolerance of +-10 % is one of 0.058."""
    return quantity(value, abs(value) * relative)


def from_sheet(slow: SpeedSheet, fast: SpeedSheet, gear_ratio: Number) -> SheetMotor:
    """Return the parameters with their standard errors.

    Raises
    ------
    Failure
        When the numbers cannot be those of a motor, naming the ones that contradict one another.

    """
    for name, sheet in (("slow", slow), ("fast", fast)):
        _check(name, sheet)
    resistances = [quantity(sheet.voltage_v / sheet.stall_current_a) for sheet in (slow, fast)]
    runs = [
        SteadyRun(sheet.voltage_v, sheet.no_load_current_a, sheet.no_load_speed_rad_s * gear_ratio)
        for sheet in (slow, fast)
    ]
    constants = [back_emf_constant(run, ohm) for run, ohm in zip(runs, resistances, strict=True)]
    if not constants[1].n < constants[0].n:
        raise Failure("data sheet: the fast speed's no-load speed must be above the slow one's at the same voltage")
    friction = bounded_friction(runs, constants)
    efficiency = _efficiency((slow, fast), constants, friction, gear_ratio)
    return SheetMotor(resistances[0], constants[0], resistances[1], constants[1], friction, efficiency)


def _check(name: str, sheet: SpeedSheet) -> None:
    for field, value in sheet._asdict().items():
        if value is not None and not quantity(value).n > 0.0:
            raise Failure(f"data sheet, {name}: {field} must be above 0, not {value}")
    if not quantity(sheet.no_load_current_a).n < quantity(sheet.stall_current_a).n:
        raise Failure(f"data sheet, {name}: the no-load current must be below the stall current; are they exchanged?")


def _efficiency(
    sheets: tuple[SpeedSheet, SpeedSheet], constants: list[UFloat], friction: MotorFriction, gear_ratio: Number
) -> UFloat | None:
    """Return the mean efficiency from the stall torques that are given; one above 1 contradicts its own sheet."""
    found = []
    for name, sheet, constant in zip(("slow", "fast"), sheets, constants, strict=True):
        if sheet.stall_torque_n_m is None:
            continue
        at_shaft = constant * sheet.stall_current_a - friction.coulomb_torque_n_m
        efficiency = quantity(sheet.stall_torque_n_m / (gear_ratio * at_shaft))
        if not 0.0 < efficiency.n - 2.0 * efficiency.s <= 1.0:
            text = f"the stall torque needs a gear efficiency of {efficiency.n:.2f}"
            raise Failure(f"data sheet, {name}: {text}; check torque, current, speed and gear ratio")
        found.append(efficiency)
    return mean_of(found) if found else None
