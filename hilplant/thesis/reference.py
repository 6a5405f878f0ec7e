"""The plant's equations once more, solved by an adaptive integrator: what the step is measured against.

Nothing is shared with the step but its records (:mod:`hilplant.thesis.reference_equations`). The ends of standstill and
of motion are located by the integrator's events.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from hilplant.arrays import Floats
from hilplant.models.records import Parameters
from hilplant.signals import Inputs
from hilplant.thesis.reference_equations import Channels, Equations, Terminals
from hilplant.units import TURN_RAD

RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11
#: Longest step of the integrator [s]: a short stop must not lie between two of its points.
LONGEST_STEP_S = 5e-3
#: Speed of the motor [rad/s] with which it leaves standstill.
FIRST_SPEED = 1e-9


def channels_of(tables: Floats) -> Channels:
    """Return what tables hold as functions of any angle, by scipy's own cubic Hermite splines."""
    knots = np.linspace(0.0, TURN_RAD, len(tables))
    spline = CubicHermiteSpline(knots, tables[..., 0], tables[..., 1], axis=0)
    slope = spline.derivative()
    return lambda angle: np.stack([spline(angle % TURN_RAD), slope(angle % TURN_RAD)], axis=-1)


@dataclass(frozen=True)
class Reference:
    """A plant, ready to be integrated through rows of inputs.

    `terminals` gives what drives the armature in a row; left out, the digital circuit of 7.1.1.
    """

    parameters: Parameters
    channels: Channels
    slowest_rad_s: float = 0.005
    terminals: Callable[[int, Inputs], Terminals] | None = None

    def run(self, input_rows: Floats, start: Sequence[float] = (0.0, 0.0, 0.0)) -> Floats:
        """Return current [A], motor speed [rad/s] and crank angle [rad, not wrapped] at each tick."""
        equations = [self._equations(k, Inputs(*row)) for k, row in enumerate(input_rows)]
        changes = [k for k in range(1, len(equations)) if not _same(equations[k], equations[k - 1])]
        rows = [np.array(start, dtype=np.float64)]
        for first, last in pairwise([0, *changes, len(equations) - 1]):
            if last > first:
                grid: Floats = np.arange(first, last + 1, dtype=np.float64) * self.parameters.step_s
                rows.extend(_integrate(equations[first], rows[-1].copy(), grid))
        return np.array(rows)

    def _equations(self, tick: int, inputs: Inputs) -> Equations:
        terminals = (self.terminals or self._digital)(tick, inputs)
        return Equations(self.parameters, self.channels, inputs, terminals, self.slowest_rad_s)

    def _digital(self, _: int, inputs: Inputs) -> Terminals:
        motor = self.parameters.motor
        brush = motor.fast if inputs.relay_fast > 0.5 else motor.slow
        return Terminals(brush, inputs.supply_v if inputs.relay_on > 0.5 else 0.0)


def _same(one: Equations, other: Equations) -> bool:
    return one.inputs == other.inputs and one.terminals == other.terminals


def _integrate(equations: Equations, x: Floats, grid: Floats) -> Iterator[Floats]:
    """Yield the state at grid[1:], going from event to event; the last one is where the next stretch starts."""
    if not equations.terminals.closed:
        x[0] = 0.0
    time = grid[0]
    stiff = equations.slowest_rad_s == 0.0 or equations.parameters.motor.inertia_kg_m2 < 1e-6
    while time < grid[-1]:
        direction = equations.direction(x)
        if direction and x[1] == 0.0 and not equations.frictionless:
            x[1] = direction * FIRST_SPEED  # else rounding may call the start of the motion its end
        run = solve_ivp(
            lambda _, y, d=direction: equations.rates(y, d),
            (time, grid[-1]),
            x,
            method="Radau" if stiff else "DOP853",
            t_eval=grid[grid > time],
            events=equations.end_of(direction),
            rtol=RELATIVE_TOLERANCE,
            atol=ABSOLUTE_TOLERANCE,
            max_step=LONGEST_STEP_S,
        )
        if run.status < 0:
            raise ArithmeticError(f"the reference stopped at {run.t[-1]} s: {run.message}")
        yield from np.asarray(run.y).T
        if run.status != 1:
            return
        time, x = run.t_events[0][0], run.y_events[0][0]
        if direction:
            x[1] = 0.0
