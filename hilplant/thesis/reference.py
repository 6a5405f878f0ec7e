"""The plant's equations once more, solved by an adaptive integrator: what the step is measured against.

Nothing here is shared with the step but its records. The equations are written down from the thesis (motor (3.30),
(3.31); friction (4.49), (4.50); the load of a wiper with one degree of freedom) and docs/plant.md (gear), and
standstill is a mode of its own whose ends are located by the integrator's events.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicHermiteSpline

from hilplant.arrays import Floats
from hilplant.models import tables as channel
from hilplant.models.load import LOADS, NONE, POLYNOMIAL, WHOLE_WIPER
from hilplant.models.records import Blade, Brush, Friction, Parameters
from hilplant.signals import Inputs
from hilplant.units import TURN_RAD

#: Crank angle [rad] -> array [channels, 2] of values and derivatives, in the order of the tables.
Channels = Callable[[float], Floats]

RELATIVE_TOLERANCE = 1e-9
ABSOLUTE_TOLERANCE = 1e-11
#: Longest step of the integrator [s]: a short stop must not lie between two of its points.
LONGEST_STEP_S = 5e-3
#: The reference breaks away this much late, so that its rounding does not stop it again at once.
HAIR = 1e-6
#: Speed of the motor [rad/s] with which it leaves standstill.
FIRST_SPEED = 1e-9


def channels_of(tables: Floats) -> Channels:
    """Return what tables hold as functions of any angle, by scipy's own cubic Hermite splines."""
    knots = np.linspace(0.0, TURN_RAD, len(tables))
    spline = CubicHermiteSpline(knots, tables[..., 0], tables[..., 1], axis=0)
    slope = spline.derivative()
    return lambda angle: np.stack([spline(angle % TURN_RAD), slope(angle % TURN_RAD)], axis=-1)


@dataclass(frozen=True)
class Terminals:
    """What drives the armature: the brush, the voltage at it, and whether the circuit is closed."""

    brush: Brush
    voltage_v: float
    closed: bool = True


@dataclass(frozen=True)
class Equations:
    """The whole system while inputs and terminals hold.

    Below `slowest_rad_s` of the crank friction is as at that speed (the step's treatment of static friction). With
    0 the curves are as printed, zero at rest with a steep slope, and the system is stiff.
    """

    parameters: Parameters
    channels: Channels
    inputs: Inputs
    terminals: Terminals
    slowest_rad_s: float

    @property
    def torque_constant(self) -> float:
        """Torque by current [N m/A]; an open armature has none."""
        return self.terminals.brush.constant_v_s if self.terminals.closed else 0.0

    @property
    def frictionless(self) -> bool:
        """Whether nothing dry acts, so that standstill is a point like any other."""
        dry = self.parameters.motor.coulomb_torque_n_m + self.inputs.brake_torque_n_m
        return dry == 0.0 and self.parameters.load.model in {NONE, POLYNOMIAL}

    def resisting(self, angle: float, speed: float, direction: float) -> tuple[float, float]:
        """Return inertia and torque without it at the crank, against motion in `direction`."""
        load, inputs = self.parameters.load, self.inputs
        if load.model == NONE:
            return 0.0, inputs.brake_torque_n_m
        if load.model == POLYNOMIAL:
            return 0.0, max(
                0.0, polynomial_torque(angle, speed, load.c1, load.c2) * direction
            ) + inputs.brake_torque_n_m
        if load.model not in WHOLE_WIPER:
            raise ArithmeticError(f"the reference does not have the load {LOADS[int(load.model)]}")
        table, wind = self.channels(angle), inputs.vehicle_speed_m_s**2
        inertia, inertia_slope = table[channel.INERTIA]
        driving = 0.5 * inertia_slope * speed**2 + table[channel.GRAVITY, 0] + wind * table[channel.DRAG, 0]
        torque = direction * driving + inputs.brake_torque_n_m + table[channel.DAMPING, 0] * abs(speed)
        rubbing = max(abs(speed), self.slowest_rad_s)
        for side, blade in enumerate((load.left_blade, load.right_blade)):
            torque += self.rubbing_torque(side, blade, table, rubbing)
        return float(inertia), float(torque)

    def rubbing_torque(self, side: int, blade: Blade, table: Floats, speed: float) -> float:
        """Return the torque of one blade's friction at the crank."""
        load, inputs = self.parameters.load, self.inputs
        own, wear, factor = (
            (inputs.left_screen, inputs.left_wear, inputs.left_force),
            (inputs.right_screen, inputs.right_wear, inputs.right_force),
        )[side]
        lift = inputs.vehicle_speed_m_s**2 * table[channel.LEFT_LIFT + side, 0]
        force = max(0.0, blade.force_n * factor - lift)
        points = int(load.points)
        first = channel.POINTS + side * points
        ways = np.abs(table[first : first + points, 0])
        screen = own if own >= 0.0 else inputs.screen
        mu = [friction_coefficient(1000.0 * way * speed, screen, force, load.friction) for way in ways]
        return float(blade.wear * wear * force / points * np.dot(ways, mu))

    def motor_torque(self, current: float, speed: float, direction: float) -> float:
        """Return the motor's own torque in `direction`, its friction deducted."""
        motor = self.parameters.motor
        turning = self.torque_constant * current - motor.damping_n_m_s * speed
        return direction * turning - motor.coulomb_torque_n_m

    def acceleration(self, x: Sequence[float], direction: float) -> float:
        """Return the acceleration of the motor shaft; of driving and driven gear the one that applies."""
        motor = self.parameters.motor
        inertia, torque = self.resisting(x[2], x[1] / motor.gear_ratio, direction)
        own, ratio = self.motor_torque(x[0], x[1], direction), motor.gear_ratio
        if inertia * own / ratio + torque * motor.inertia_kg_m2 >= 0.0:
            driving = motor.inertia_kg_m2 + inertia / (ratio**2 * motor.gear_efficiency)
            return direction * (own - torque / (ratio * motor.gear_efficiency)) / driving
        back = motor.gear_back_efficiency
        return direction * (own - back * torque / ratio) / (motor.inertia_kg_m2 + back * inertia / ratio**2)

    def held(self, angle: float, direction: float) -> float:
        """Return the torque of the motor from which it breaks away in `direction`."""
        motor = self.parameters.motor
        _, torque = self.resisting(angle, 0.0, direction)
        passing = 1.0 / motor.gear_efficiency if torque > 0.0 else motor.gear_back_efficiency
        return motor.coulomb_torque_n_m + passing * torque / motor.gear_ratio

    def rates(self, x: Sequence[float], direction: float) -> list[float]:
        """Return the derivatives of current, motor speed and crank angle; direction 0 is standstill."""
        if self.frictionless:
            direction = math.copysign(1.0, x[1])
        brush, speed = self.terminals.brush, x[1] if direction else 0.0
        rise = (
            self.terminals.voltage_v - brush.resistance_ohm * x[0] - brush.constant_v_s * speed
        ) / brush.inductance_henry
        if not self.terminals.closed:
            rise = 0.0
        return [rise, self.acceleration(x, direction) if direction else 0.0, speed / self.parameters.motor.gear_ratio]

    def direction(self, x: Floats) -> float:
        """Return +1 or -1 when sliding, 0 when stuck."""
        if x[1] != 0.0 or self.frictionless:
            return math.copysign(1.0, x[1])
        torque = self.torque_constant * x[0]
        for direction in (1.0, -1.0):
            if direction * torque > self.late(self.held(x[2], direction)) * (1.0 - 1e-9):
                return direction
        return 0.0

    @staticmethod
    def late(torque: float) -> float:
        """Return where the reference lets go."""
        return torque + HAIR * abs(torque) + 1e-15

    def end_of(self, direction: float) -> Callable[[float, Floats], float]:
        """Return what falls through zero where sliding ends, or where sticking ends."""

        def stops(_: float, x: Floats) -> float:
            return float(direction * x[1])

        def breaks_away(_: float, x: Floats) -> float:
            torque = self.torque_constant * x[0]
            return float(min(self.late(self.held(x[2], s)) - s * torque for s in (1.0, -1.0)))

        event = stops if direction else breaks_away
        event.terminal = not self.frictionless  # type: ignore[attr-defined]
        event.direction = -1.0  # type: ignore[attr-defined]
        return event


def polynomial_torque(angle: float, speed: float, c1: float, c2: float) -> float:
    """Return (6.3)."""
    x = math.sin(angle)
    f = np.polyval([-0.19224, 0.021769, -0.15435, 0.077812, 0.68626], x)
    g = np.polyval([0.4184, -0.30315, -0.42441, 0.12634, 0.21484, -0.10093, -0.29859, 0.63276], x)
    return float(speed * c2 * ((f if x >= 0.0 else g) + speed * c1))


def friction_coefficient(velocity_mm_s: float, wetness: float, force_n: float, c: Friction) -> float:
    """Return the coefficient from the dry, tacky and wet curves, mixed by wetness."""
    v = min(velocity_mm_s, c.velocity_limit_mm_s)
    tanh = math.tanh
    dry = c.dry_1 * tanh(c.dry_2 * v) + c.dry_3 * tanh(c.dry_4 * v)
    tacky = c.tacky_1 * tanh(c.tacky_2 * v) + c.tacky_3 * (tanh(c.tacky_2 * v) - tanh(c.tacky_4 * v))
    stribeck = c.wet_1 * (tanh(c.wet_2 * v) - tanh(c.wet_3 * v))
    by_force, shape = c.wet_7 * force_n + c.wet_4, stribeck + c.wet_4 * tanh(c.wet_5 * v) - c.wet_6 * v
    return float(np.interp(wetness, [0.0, 0.5, 1.0], [dry, tacky, max(0.0, by_force) * max(0.0, shape)]))


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
