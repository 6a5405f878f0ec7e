"""The plant's equations once more, shared with the step in nothing but its records.

They are written down from the thesis (motor (3.30), (3.31); friction (4.49), (4.50); the load of a wiper with one
degree of freedom) and docs/plant.md (gear). Standstill is a mode of its own, whose ends the equations give as events.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.models import tables as channel
from hilplant.models.load import LOADS, NONE, POLYNOMIAL, WHOLE_WIPER
from hilplant.models.records import Blade, Brush, Friction, Parameters
from hilplant.signals import Inputs

#: Crank angle [rad] -> array [channels, 2] of values and derivatives, in the order of the tables.
Channels = Callable[[float], Floats]

#: The reference breaks away this much late, so that its rounding does not stop it again at once.
HAIR = 1e-6


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
