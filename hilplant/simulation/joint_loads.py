"""What every joint of a bench's wiper carries over a turn at even speed, with its friction, wind and masses, 4.3."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.mechanics.inverse_dynamics import AppliedForce, CrankMotion, Loads, inverse_dynamics
from hilplant.mechanics.motion import Motion, motion, point_motion
from hilplant.mechanics.reduction import SideCurves, reduce
from hilplant.mechanics.wiper import Wiper, WiperSide
from hilplant.models.friction import coefficient
from hilplant.models.records import Blade
from hilplant.models.reduced import MM_PER_M
from hilplant.simulation.crank_torque import Conditions
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Crank angles at which the turn is looked at.
ANGLES = 1440


class JointLoads(NamedTuple):
    """The turn, and what its joints carry; force and moment of each joint are [ANGLES, 2] and [ANGLES]."""

    moving: Motion
    loads: Loads

    def names(self) -> list[str]:
        """Return the joints in the mechanism's order, each `first - second`."""
        return [f"{joint.first} - {joint.second}" for joint in self.loads.joints]

    def sizes_n(self) -> list[Floats]:
        """Return the size of each joint's force [N]."""
        return [np.linalg.norm(joint.force_n, axis=1) for joint in self.loads.joints]

    def columns(self) -> dict[str, Floats]:
        """Return crank angle, crank torque, and each joint's force, its parts and its moment."""
        found = {"crank_deg": self.moving.crank_rad / RAD_PER_DEG, "crank_torque_n_m": self.loads.crank_torque_n_m}
        for name, joint, size in zip(self.names(), self.loads.joints, self.sizes_n(), strict=True):
            word = name.replace(" - ", "_to_")
            found |= {f"{word}_n": size, f"{word}_x_n": joint.force_n[:, 0], f"{word}_y_n": joint.force_n[:, 1]}
            found[f"{word}_n_m"] = joint.moment_n_m
        return found


def joint_loads(bench: Bench, crank_speed_rad_s: float, conditions: Conditions) -> JointLoads:
    """Return the loads of one turn at an even speed, from park on.

    The friction of each point of a blade acts against its motion, with the coefficient at its own speed and the force
    that lift leaves; drag acts on the blade's joint, (4.51). The crank's torque is that of the load `reduced`, which
    knows no joint: it checks this.
    """
    wiper = bench.plant.mechanics.wiper
    moving = motion(wiper, np.linspace(0.0, TURN_RAD, ANGLES, endpoint=False))
    reduced = reduce(wiper, moving)
    applied: list[AppliedForce] = []
    blades = bench.parameters.load.left_blade, bench.parameters.load.right_blade
    for side, curves, blade in zip(wiper.sides, (reduced.left, reduced.right), blades, strict=True):
        wind = conditions.vehicle_speed_m_s**2
        pressed = np.maximum(0.0, blade.force_n * conditions.pressed - wind * curves.lift.value)
        applied += _friction(bench, moving, side, (pressed, blade), (crank_speed_rad_s, conditions.wetness))
        if wind:
            applied.append(_drag(wiper, moving, side, curves, wind))
    return JointLoads(moving, inverse_dynamics(wiper, moving, CrankMotion(crank_speed_rad_s, 0.0), applied))


def _friction(
    bench: Bench, moving: Motion, side: WiperSide, held: tuple[Floats, Blade], going: tuple[float, float]
) -> list[AppliedForce]:
    """Return the friction of each point of a blade [N] [m, 2]."""
    (pressed, blade), (speed_rad_s, wetness) = held, going
    forces = []
    for pin in side.friction:
        way = point_motion(bench.plant.mechanics.wiper, moving, pin).rate
        length = np.linalg.norm(way, axis=1)

        curve = bench.parameters.load.friction
        speeds = MM_PER_M * length * abs(speed_rad_s)
        mu = [coefficient(speed, wetness, force, curve)[0] for speed, force in zip(speeds, pressed, strict=True)]
        size = blade.wear * pressed * np.array(mu) / len(side.friction) * np.sign(speed_rad_s)
        forces.append(AppliedForce(pin, -(size / np.where(length > 0.0, length, 1.0))[:, np.newaxis] * way))
    return forces


def _drag(wiper: Wiper, moving: Motion, side: WiperSide, curves: SideCurves, wind: float) -> AppliedForce:
    """Return the drag on a blade's joint: along its circle, so that its torque at the crank is that of the table."""
    reach = wiper.mechanism.point(moving.coordinates, side.centre) - np.array(
        wiper.mechanism.point(moving.coordinates, side.pivot)
    )
    radius = np.linalg.norm(reach, axis=1, keepdims=True)
    along = np.stack([-reach[:, 1], reach[:, 0]], axis=1) / radius
    rate = moving.rates[:, wiper.mechanism.angle(side.rocker)]
    safe = np.where(np.abs(rate) > 1e-9, rate, 1.0)
    size = np.where(np.abs(rate) > 1e-9, -wind * curves.drag.value / safe, 0.0) / radius[:, 0]
    return AppliedForce(side.centre, size[:, np.newaxis] * along)
