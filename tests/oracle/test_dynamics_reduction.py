"""The reduction to the crank against Lagrange multipliers, and against energy.

The multipliers come from one linear system of all constraints; the reduction never sees a constraint force. Energies
and paths are taken from positions alone, differentiated by Fourier series over the turn.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.mechanics.inverse_dynamics import AppliedForce, CrankMotion, inverse_dynamics
from hilplant.mechanics.motion import Motion, motion, point_motion
from hilplant.mechanics.reduction import Reduction, reduce
from hilplant.mechanics.wiper import Wiper, WiperParts, WiperSide, assemble

BOUND = 1e-9
TURN = 2.0 * np.pi
NODES = 256
PUBLISHED = "rhd_slave_driven"


def along_the_path(wiper: Wiper, moving: Motion, side: WiperSide, pin: tuple[str, tuple[float, float]]) -> Floats:
    """Return the unit vectors across the way from the pivot, anticlockwise: the sense of a rising rocker angle."""
    spoke = wiper.mechanism.point(moving.coordinates, pin) - wiper.mechanism.point(moving.coordinates, side.pivot)
    across = np.stack([-spoke[:, 1], spoke[:, 0]], axis=-1)
    return np.asarray(across / np.linalg.norm(across, axis=1, keepdims=True))


def disagreement(wiper: Wiper, random: np.random.Generator, loaded: bool) -> float:
    """Return how far both crank torques are apart, by the sum of the sizes of what they are made of."""
    crank_rad = random.uniform(-20.0, 20.0, 50)
    crank = CrankMotion(random.normal(0.0, 8.0, 50), random.normal(0.0, 80.0, 50))
    moving = motion(wiper, crank_rad)
    reduced = reduce(wiper, moving)
    torque, applied = reduced.moving_torque(*crank), []
    size = np.abs(reduced.inertia.value * crank.acceleration_rad_s2) + np.abs(reduced.gravity.value)
    size += np.abs(reduced.inertia.slope * np.square(crank.speed_rad_s) / 2.0)
    size += np.abs(reduced.damping.value * crank.speed_rad_s)
    for side, curves in zip(wiper.sides, (reduced.left, reduced.right), strict=True):
        for pin, curve in zip(side.friction, curves.points, strict=True):
            force = random.normal(0.0, 20.0, (50, 2)) * loaded
            applied.append(AppliedForce(pin, force))
            driving = (force * along_the_path(wiper, moving, side, pin)).sum(axis=1) * curve.value
            torque, size = torque - driving, size + np.abs(driving)
    truth = inverse_dynamics(wiper, moving, crank, applied).crank_torque_n_m
    return float((np.abs(truth - torque) / size).max())


@pytest.mark.parametrize("loaded", [False, True], ids=["bare", "blades pushed"])
def test_shipped_linkages_agree(every_parts: WiperParts, loaded: bool) -> None:
    wiper = assemble(replace(every_parts, points=4))
    error = max(disagreement(wiper, np.random.default_rng(seed), loaded) for seed in range(10))
    print(f"\nLagrange against reduction, {every_parts.linkage.kind}, 500 states: {error:.1e}")
    assert error < BOUND


def test_random_wipers_agree(random_parts: Callable[[np.random.Generator], WiperParts]) -> None:
    random = np.random.default_rng(21)
    wipers = [assemble(random_parts(random)) for _ in range(40)]
    error = max(disagreement(wiper, random, loaded=True) for wiper in wipers)
    print(f"\nLagrange against reduction, 40 random wipers of 50 states: {error:.1e}")
    assert error < BOUND


def over_the_turn(wiper: Wiper) -> tuple[Floats, Motion, Reduction]:
    crank_rad = np.linspace(0.0, TURN, NODES, endpoint=False)
    moving = motion(wiper, crank_rad)
    return crank_rad, moving, reduce(wiper, moving)


def by_fourier(values: Floats) -> Floats:
    """Return the derivative of periodic values [NODES, ...] by the crank angle, from their Fourier series."""
    waves = np.fft.fftfreq(NODES, 1.0 / NODES)
    waves[NODES // 2] = 0.0
    spectrum = np.fft.fft(values, axis=0) * (1j * waves).reshape(-1, *([1] * (values.ndim - 1)))
    return np.asarray(np.fft.ifft(spectrum, axis=0).real)


def ends(wiper: Wiper, moving: Motion) -> tuple[Floats, Floats]:
    """Return where both ends of every rod are, [m, bodies, 2]."""
    pairs = [
        [wiper.mechanism.point(moving.coordinates, pin) for pin in (body.first_end, body.second_end)]
        for body in wiper.bodies
    ]
    return np.stack([pair[0] for pair in pairs], axis=1), np.stack([pair[1] for pair in pairs], axis=1)


def test_inertia_and_gravity_are_those_of_rods_seen_from_their_ends(every_parts: WiperParts) -> None:
    """A rod's kinetic energy is m/6 (v1 v1 + v1 v2 + v2 v2) of its ends, its potential energy m g (y1 + y2)/2."""
    wiper = assemble(every_parts)
    _, moving, reduced = over_the_turn(wiper)
    first, second = ends(wiper, moving)
    v1, v2 = by_fourier(first), by_fourier(second)
    inertia = ((v1 * v1 + v1 * v2 + v2 * v2).sum(axis=2) / 3.0) @ wiper.masses_kg
    height = (first[..., 1] + second[..., 1]) / 2.0 @ wiper.masses_kg
    gravity = by_fourier(height * 9.81 * np.cos(every_parts.screen_angle_rad))
    for name, curve, truth in (("M", reduced.inertia, inertia), ("G", reduced.gravity, gravity)):
        error = np.abs(curve.value - truth).max() / np.abs(truth).max()
        print(f"\n{name} against rods' ends: {error:.1e}")
        assert error < BOUND


def test_every_derivative_is_that_of_the_fourier_series(every_parts: WiperParts) -> None:
    wiper = assemble(replace(every_parts, points=3))
    _, _, reduced = over_the_turn(wiper)
    for curve in (
        reduced.inertia, reduced.gravity, reduced.left.rocker, reduced.right.rocker, reduced.left.drag,
        reduced.right.drag, *reduced.left.points, *reduced.right.points,
    ):  # fmt: skip
        truth = by_fourier(curve.value)
        assert np.abs(curve.slope - truth).max() < 1e-8 * np.abs(truth).max()


def test_friction_points_move_as_their_jacobians_say(every_parts: WiperParts) -> None:
    wiper = assemble(replace(every_parts, points=5))
    _, moving, reduced = over_the_turn(wiper)
    for side, curves in zip(wiper.sides, (reduced.left, reduced.right), strict=True):
        for pin, curve in zip(side.friction, curves.points, strict=True):
            way = by_fourier(wiper.mechanism.point(moving.coordinates, pin))
            assert np.abs(np.abs(curve.value) - np.linalg.norm(way, axis=1)).max() < 1e-9
            assert np.abs((along_the_path(wiper, moving, side, pin) * way).sum(axis=1) - curve.value).max() < 1e-9
            moved = point_motion(wiper, moving, pin)
            assert np.abs(moved.rate - way).max() < 1e-9
            assert np.abs(moved.acceleration - by_fourier(way)).max() < 1e-7


def swinging_crank(crank_rad: Floats) -> CrankMotion:
    """Return a speed that swings between 4 and 9 rad/s within the turn, and the acceleration that goes with it."""
    speed = 6.0 + 2.0 * np.sin(crank_rad) + 0.8 * np.cos(3.0 * crank_rad + 0.4)
    return CrankMotion(speed, speed * (2.0 * np.cos(crank_rad) - 2.4 * np.sin(3.0 * crank_rad + 0.4)))


def test_energy_of_a_turn_closes_with_viscous_blades(every_parts: WiperParts) -> None:
    """Work of the crank = loss at the blades; kinetic and potential energy come back."""
    wiper = assemble(replace(every_parts, points=3))
    crank_rad, moving, _ = over_the_turn(wiper)
    crank, applied, lost = swinging_crank(crank_rad), [], 0.0
    for damping, pin in enumerate([pin for side in wiper.sides for pin in side.friction], start=1):
        velocity = by_fourier(wiper.mechanism.point(moving.coordinates, pin)) * np.c_[crank.speed_rad_s]
        applied.append(AppliedForce(pin, -damping * velocity))
        lost += float((damping * (velocity**2).sum(axis=1) / crank.speed_rad_s).sum() * TURN / NODES)
    loads = inverse_dynamics(wiper, moving, crank, applied)
    work = float(loads.crank_torque_n_m.sum() * TURN / NODES)
    print(f"\na turn: work {work:.12f} J, lost {lost:.12f} J, apart by {abs(work / lost - 1.0):.1e}")
    assert work == pytest.approx(lost, rel=BOUND)


def test_energy_of_a_part_of_the_turn_closes(every_parts: WiperParts) -> None:
    """Work of the crank = rise of kinetic and potential energy, wherever it begins and ends."""
    wiper = assemble(every_parts)
    nodes, weights = np.polynomial.legendre.leggauss(120)
    for begin, end in ((0.3, 2.4), (1.0, 5.9), (4.0, 4.5)):
        crank_rad = begin + (end - begin) * (nodes + 1.0) / 2.0
        torque = inverse_dynamics(wiper, motion(wiper, crank_rad), swinging_crank(crank_rad)).crank_torque_n_m
        work = float((torque * weights).sum() * (end - begin) / 2.0)
        before, after = energy(wiper, every_parts, np.array([begin, end]))
        size = max(before, after)
        error = abs(work - after + before) / size
        print(f"\n{begin} to {end} rad: work {work:.10f} J, apart by {error:.1e} of the energy")
        assert error < BOUND


def energy(wiper: Wiper, parts: WiperParts, crank_rad: Floats) -> Floats:
    """Return kinetic plus potential energy of the rods, from their ends."""
    moving = motion(wiper, crank_rad)
    speed = np.asarray(swinging_crank(crank_rad).speed_rad_s)
    total = np.zeros(crank_rad.size)
    for body, mass in zip(wiper.bodies, wiper.masses_kg, strict=True):
        first, second = (point_motion(wiper, moving, pin) for pin in (body.first_end, body.second_end))
        v1, v2 = first.rate * speed[:, np.newaxis], second.rate * speed[:, np.newaxis]
        total += mass / 6.0 * (v1 * v1 + v1 * v2 + v2 * v2).sum(axis=1)
        total += mass * 9.81 * np.cos(parts.screen_angle_rad) * (first.place + second.place)[:, 1] / 2.0
    return total


def test_a_turn_against_dry_friction_costs_force_times_way(shipped_parts: Callable[[str], WiperParts]) -> None:
    """The way of each blade is twice its arm's radius times its sweep, which two triangles give in closed form."""
    parts = replace(shipped_parts(PUBLISHED), points=1)
    wiper, forces = assemble(parts), (12.0, 9.0)
    dead, sweeps = closed_form_dead_centres_and_sweeps(parts)
    nodes, weights = np.polynomial.legendre.leggauss(200)
    work = 0.0
    for begin, end in ((dead[0], dead[1]), (dead[1], dead[0] + TURN)):
        crank_rad = begin + (end - begin) * (nodes + 1.0) / 2.0
        moving, crank = motion(wiper, crank_rad), swinging_crank(crank_rad)
        applied = []
        for side, force in zip(wiper.sides, forces, strict=True):
            way = point_motion(wiper, moving, side.friction[0]).rate
            applied.append(AppliedForce(side.friction[0], -force * way / np.linalg.norm(way, axis=1, keepdims=True)))
        torque = inverse_dynamics(wiper, moving, crank, applied).crank_torque_n_m
        work += float((torque * weights).sum() * (end - begin) / 2.0)
    radii = [np.hypot(*np.subtract(side.arm[-1], side.arm[0])) for side in (parts.left, parts.right)]
    known = sum(2.0 * f * r * sweep for f, r, sweep in zip(forces, radii, sweeps, strict=True))
    print(f"\ndry friction: work of a turn {work:.12f} J, force times way {known:.12f} J, {abs(work / known - 1):.1e}")
    assert np.degrees(sweeps) == pytest.approx([81.889, 82.794], abs=5e-4)
    assert work == pytest.approx(known, rel=BOUND)


def closed_form_dead_centres_and_sweeps(parts: WiperParts) -> tuple[list[float], list[float]]:
    """Return crank angles [rad] and sweeps [rad] from the triangles in which crank and coupler lie in one line."""
    o, a, b, c, d, e, f = (complex(*parts.linkage.points[name]) for name in "OABCDEF")
    rockers, cranks = [], []
    for way, toward in ((abs(b - a) - abs(a - o), -1.0), (abs(b - a) + abs(a - o), 1.0)):
        along = np.exp(1j * np.angle(c - o))
        opening = np.arccos((way**2 + abs(c - o) ** 2 - abs(b - c) ** 2) / (2.0 * way * abs(c - o)))
        side = np.sign(((b - o) / (c - o)).imag)
        joint = o + way * along * np.exp(1j * side * opening)
        cranks.append(float(np.angle(toward * (joint - o) / (a - o))))
        link_end = c + abs(d - c) * (joint - c) / abs(joint - c)
        distance = abs(f - link_end)
        reach = np.arccos((distance**2 + abs(e - f) ** 2 - abs(d - e) ** 2) / (2.0 * distance * abs(e - f)))
        turn = np.sign(((e - f) / (d - f)).imag)
        rockers.append((float(np.angle(joint - c)), float(np.angle(link_end - f) + turn * reach)))
    sweeps = [abs(float(np.angle(np.exp(1j * (x - y))))) for x, y in zip(*rockers, strict=True)]
    first, second = sorted(angle % TURN for angle in cranks)
    return [first, second], sweeps
