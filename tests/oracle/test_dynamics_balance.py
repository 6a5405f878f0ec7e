"""Every joint's force against Newton and Euler: each body, cut free, must move as its forces say.

The accelerations are sixth-order differences of positions along the motion, masses and inertias are worked out here
from points and lengths. Nothing of the solver is used but where the bodies are.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.mechanics.inverse_dynamics import AppliedForce, CrankMotion, Loads, inverse_dynamics
from hilplant.mechanics.motion import motion
from hilplant.mechanics.wiper import Wiper, WiperParts, assemble

#: Weights of the sixth-order central differences for the first and the second derivative.
FIRST = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
STEP_RAD = 1.2e-2
#: Of the largest force or moment in the system.
BOUND = 1e-9
STATES = 40


def by_differences(wiper: Wiper, crank_rad: Floats, crank: CrankMotion) -> tuple[Floats, Floats]:
    """Return velocities and accelerations of all coordinates over a time in which the crank moves as given."""
    speed, acceleration = (np.asarray(value)[:, np.newaxis] for value in crank)
    step_s = STEP_RAD / (np.abs(speed) + np.sqrt(np.abs(acceleration)))
    times = np.arange(-3, 4) * step_s
    path = crank_rad[:, np.newaxis] + speed * times + acceleration * times**2 / 2.0
    unbroken = np.stack([motion(wiper, angles).coordinates for angles in path.T])
    unbroken[..., 2::3] = np.unwrap(unbroken[..., 2::3], axis=0)
    return np.tensordot(FIRST, unbroken, 1) / step_s, np.tensordot(SECOND, unbroken, 1) / step_s**2


def states(random: np.random.Generator) -> tuple[Floats, CrankMotion]:
    speed = random.uniform(0.5, 12.0, STATES) * random.choice([-1.0, 1.0], STATES)
    return random.uniform(0.0, 2.0 * np.pi, STATES), CrankMotion(speed, random.normal(0.0, 40.0, STATES))


def blade_forces(wiper: Wiper, random: np.random.Generator) -> list[AppliedForce]:
    pins = [pin for side in wiper.sides for pin in side.friction]
    return [AppliedForce(pin, random.normal(0.0, 20.0, (STATES, 2))) for pin in pins]


def rod_masses(parts: WiperParts, wiper: Wiper) -> dict[str, tuple[float, float]]:
    """Return mass and moment of inertia of each body, the inertia as twelve small pieces of a rod would have it."""
    result = {}
    for body in wiper.bodies:
        owner, _, kind = body.name.partition("_")
        if kind.startswith(("arm", "blade")):
            side = parts.left if owner == "left" else parts.right
            word = kind.split("_")[0]
            family = [each for each in wiper.bodies if each.name.startswith(f"{owner}_{word}")]
            whole = side.arm_mass_kg if word == "arm" else side.blade_mass_kg
            mass = whole * body.length_m / sum(each.length_m for each in family)
        else:
            mass = parts.masses_kg.get(body.name, 0.0)
        nodes, weights = np.polynomial.legendre.leggauss(5)
        result[body.name] = mass, float(mass / 2.0 * (weights * (nodes * body.length_m / 2.0) ** 2).sum())
    return result


def left_over(wiper: Wiper, loads: Loads, applied: list[AppliedForce], crank_rad: Floats) -> dict[str, list[Floats]]:
    """Return force and moment about its centre that joints, blades, drive and gravity put on each body."""
    moving = motion(wiper, crank_rad)
    sums = {body.name: [np.zeros((STATES, 2)), np.zeros(STATES)] for body in wiper.bodies} | {
        "car": [np.zeros((STATES, 2)), np.zeros(STATES)]
    }

    def put(body: str, place: Floats, force: Floats, moment: Floats | float = 0.0) -> None:
        if body == "car":
            return
        index = wiper.mechanism.bodies[body]
        arm = place - moving.coordinates[:, 3 * index : 3 * index + 2]
        sums[body][0] += force
        sums[body][1] += arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0] + moment

    for joint in loads.joints:
        place = wiper.mechanism.point(moving.coordinates, joint.pin)
        put(joint.first, place, joint.force_n, joint.moment_n_m)
        put(joint.second, place, -joint.force_n, -joint.moment_n_m)
    for force in applied:
        put(force.pin[0], wiper.mechanism.point(moving.coordinates, force.pin), force.force_n)
    sums["crank"][1] += loads.crank_torque_n_m
    return sums


def check_balance(parts: WiperParts, random: np.random.Generator) -> float:
    """Return the largest force or moment that is left over on any body, as a part of the largest there is."""
    wiper = assemble(parts)
    crank_rad, crank = states(random)
    applied = blade_forces(wiper, random)
    loads = inverse_dynamics(wiper, motion(wiper, crank_rad), crank, applied)
    _, accelerations = by_differences(wiper, crank_rad, crank)
    masses, sums = rod_masses(parts, wiper), left_over(wiper, loads, applied, crank_rad)
    gravity = np.array([0.0, -9.81 * np.cos(parts.screen_angle_rad)])
    worst = 0.0
    for index, body in enumerate(wiper.bodies):
        mass, inertia = masses[body.name]
        force = sums[body.name][0] + mass * gravity - mass * accelerations[:, 3 * index : 3 * index + 2]
        moment = sums[body.name][1] - inertia * accelerations[:, 3 * index + 2]
        worst = max(worst, float(np.abs(force).max()), float(np.abs(moment).max()))
    return worst / max(float(np.abs(joint.force_n).max()) for joint in loads.joints)


def test_every_body_of_every_shipped_linkage_is_in_balance(every_parts: WiperParts) -> None:
    error = check_balance(replace(every_parts, points=3), np.random.default_rng(11))
    print(f"\n{every_parts.linkage.kind}: left over on the worst body {error:.1e} of the largest joint force")
    assert error < BOUND


def test_every_body_of_random_wipers_is_in_balance(
    random_parts: Callable[[np.random.Generator], WiperParts],
) -> None:
    random = np.random.default_rng(12)
    errors = [check_balance(random_parts(random), random) for _ in range(10)]
    print(f"\nrandom wipers: left over on the worst body {max(errors):.1e} of the largest joint force")
    assert max(errors) < BOUND


@pytest.mark.parametrize("points", [1, 4])
def test_the_crank_torque_is_what_virtual_power_demands(
    shipped_parts: Callable[[str], WiperParts], points: int
) -> None:
    """d'Alembert: what crank, gravity, blades and inertia would do along the motion sums up to nothing."""
    random, parts = np.random.default_rng(13), replace(shipped_parts("rhd_slave_driven"), points=points)
    wiper = assemble(parts)
    crank_rad, crank = states(random)
    moving, applied = motion(wiper, crank_rad), blade_forces(wiper, random)
    velocities, accelerations = by_differences(wiper, crank_rad, crank)
    power = np.zeros(STATES)
    for index, body in enumerate(wiper.bodies):
        mass, inertia = rod_masses(parts, wiper)[body.name]
        x, y, turn = (slice(3 * index + place, 3 * index + place + 1) for place in range(3))
        pull = accelerations[:, y] + 9.81 * np.cos(parts.screen_angle_rad)
        power += mass * (accelerations[:, x] * velocities[:, x] + pull * velocities[:, y])[:, 0]
        power += inertia * (accelerations[:, turn] * velocities[:, turn])[:, 0]
    for force in applied:
        index = 3 * wiper.mechanism.bodies[force.pin[0]]
        arm = wiper.mechanism.point(moving.coordinates, force.pin) - moving.coordinates[:, index : index + 2]
        across = np.stack([-arm[:, 1], arm[:, 0]], axis=-1) * velocities[:, index + 2 : index + 3]
        power -= (force.force_n * (velocities[:, index : index + 2] + across)).sum(axis=1)
    torque = inverse_dynamics(wiper, moving, crank, applied).crank_torque_n_m
    error = np.abs(torque - power / crank.speed_rad_s).max() / np.abs(torque).max()
    print(f"\ncrank torque against d'Alembert, {points} points: {error:.1e}")
    assert error < BOUND


def test_a_joint_that_turns_carries_no_moment_and_a_still_wiper_only_its_weight(
    shipped_parts: Callable[[str], WiperParts],
) -> None:
    wiper = assemble(shipped_parts("rhd_slave_driven"))
    loads = inverse_dynamics(wiper, motion(wiper, np.linspace(0.0, 6.0, 13)), CrankMotion(0.0, 0.0))
    turning = [joint for joint in loads.joints if joint.second in ("crank", "coupler", "link")]
    assert len(turning) == 2
    assert all(not joint.moment_n_m.any() for joint in turning)
    held = loads.joints[0]
    assert (held.first, held.second) == ("ground", "car")
    weight = 9.81 * np.cos(0.57) * wiper.masses_kg.sum()
    assert held.force_n[:, 0] == pytest.approx(0.0, abs=1e-9)
    assert held.force_n[:, 1] == pytest.approx(weight, rel=1e-12)
