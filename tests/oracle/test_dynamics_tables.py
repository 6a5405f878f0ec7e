"""The run-time table against positions solved for themselves, Lagrange multipliers and forces written out by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from support.interpolation import interpolation_errors, knots_within, read_rows

from hilplant.arrays import Floats
from hilplant.mechanics.coefficients import Aerodynamics, Coefficient, CoefficientError
from hilplant.mechanics.inverse_dynamics import AppliedForce, CrankMotion, inverse_dynamics
from hilplant.mechanics.motion import motion, point_motion
from hilplant.mechanics.newton_raphson import follow, rates
from hilplant.mechanics.tables import channel_names, exact_rows, run_time_table
from hilplant.mechanics.wiper import Wiper, WiperParts, assemble
from hilplant.models.tables import (
    DRAG,
    GRAVITY,
    INERTIA,
    LEFT_LIFT,
    LEFT_ROCKER,
    POINTS,
    RIGHT_LIFT,
    RIGHT_ROCKER,
    channels,
)

Shipped = Callable[[str], WiperParts]
PUBLISHED = "rhd_slave_driven"
TURN = 2.0 * np.pi


def with_air(parts: WiperParts, drag: Coefficient, lift: Coefficient) -> WiperParts:
    air = Aerodynamics(0.07, drag, lift)
    return replace(parts, left=replace(parts.left, air=air), right=replace(parts.right, air=air))


def test_table_lies_in_memory_as_the_step_wants_it_and_closes(every_parts: WiperParts) -> None:
    table = run_time_table(assemble(replace(every_parts, points=4)), 256)
    assert table.shape == (257, channels(4), 2) == (257, len(channel_names(4)), 2)
    assert table.dtype == np.float64
    assert table.flags.c_contiguous
    assert np.array_equal(table[-1], table[0])
    assert np.isfinite(table).all()


def test_rockers_are_those_of_the_bare_linkage(every_parts: WiperParts) -> None:
    table = run_time_table(assemble(every_parts), 256)
    linkage, mechanism = every_parts.linkage, every_parts.linkage.mechanism()
    bare = follow(mechanism, linkage.design_crank_angle_rad + np.linspace(0.0, TURN, 257))
    turning = rates(mechanism, bare)
    for channel, rocker in ((LEFT_ROCKER, "left_rocker"), (RIGHT_ROCKER, "right_rocker")):
        angle = mechanism.angle(rocker)
        assert np.abs(table[:, channel, 0] - bare[:, angle]).max() < 1e-12
        assert np.abs(table[:, channel, 1] - turning[:, angle]).max() < 1e-12


def test_between_the_knots_the_table_keeps_to_the_exact_values(every_parts: WiperParts) -> None:
    errors = interpolation_errors(assemble(replace(every_parts, points=3)), 1024)
    print("\nlargest error between 1024 knots, as a part of the channel's largest value")
    for error in errors:
        value, slope = (
            part / whole if whole else 0.0
            for part, whole in ((error.value_error, error.largest_value), (error.slope_error, error.largest_slope))
        )
        print(f"  {error.name:32s} value {value:.1e}, derivative {slope:.1e}")
        assert error.value_error <= 1e-9 * error.largest_value
        assert error.relative_error < 5e-7


def test_the_error_falls_with_the_third_power_of_the_step_and_the_knots_are_found(shipped_parts: Shipped) -> None:
    wiper = assemble(shipped_parts(PUBLISHED))
    coarse, fine = (max(error.relative_error for error in interpolation_errors(wiper, knots)) for knots in (128, 256))
    assert 7.0 < coarse / fine < 9.0
    assert knots_within(wiper, 1.01 * coarse) == 128
    assert knots_within(wiper, 0.99 * coarse) == 256


def test_what_the_step_reads_gives_the_torque_of_the_full_equations(every_parts: WiperParts) -> None:
    wiper, random = assemble(every_parts), np.random.default_rng(31)
    table, crank_rad = run_time_table(wiper), random.uniform(0.0, TURN, 500)
    crank = CrankMotion(random.normal(0.0, 8.0, 500), random.normal(0.0, 50.0, 500))
    rows = read_rows(table, crank_rad)
    torque = rows[:, INERTIA, 0] * crank.acceleration_rad_s2 + rows[:, GRAVITY, 0]
    torque += rows[:, INERTIA, 1] * np.square(crank.speed_rad_s) / 2.0
    truth = inverse_dynamics(wiper, motion(wiper, crank_rad), crank).crank_torque_n_m
    error = np.abs(torque - truth).max() / np.abs(truth).max()
    print(f"\ntorque read from 1024 knots against Lagrange, {every_parts.linkage.kind}: {error:.1e} of the largest")
    assert error < 2e-7  # M' between the knots is 1.3e-7 off at most


def wind(wiper: Wiper, crank_rad: Floats, drag: tuple[float, float]) -> Floats:
    """Return the crank torque of forces [N] on both blades along their path, upwards in the forward wipe."""
    moving = motion(wiper, crank_rad)
    applied = []
    for side, force in zip(wiper.sides, drag, strict=True):
        joint = point_motion(wiper, moving, side.centre)
        spoke = joint.place - wiper.mechanism.point(moving.coordinates, side.pivot)
        across = np.stack([-spoke[:, 1], spoke[:, 0]], axis=-1) / np.linalg.norm(spoke, axis=1, keepdims=True)
        rising = (across[:, 1] * np.linalg.norm(spoke, axis=1)).mean()
        applied.append(AppliedForce(side.centre, force * np.sign(rising) * across))
    still = CrankMotion(0.0, 0.0)
    pushed = inverse_dynamics(wiper, moving, still, applied).crank_torque_n_m
    return np.asarray(pushed - inverse_dynamics(wiper, moving, still).crank_torque_n_m)


def test_drag_is_the_force_of_the_thesis_and_helps_while_the_arms_rise(every_parts: WiperParts) -> None:
    wiper, crank_rad = assemble(every_parts), np.linspace(0.0, TURN, 400, endpoint=False)
    drag = exact_rows(wiper, crank_rad)[:, DRAG, 0] * 40.0**2
    forces = [0.5 * 1.225 * 40.0**2 * area * coefficient for area, coefficient in ((0.07, 0.175), (0.06, 0.219))]
    assert drag == pytest.approx(wind(wiper, crank_rad, (forces[0], forces[1])), abs=1e-9)
    moving = motion(wiper, crank_rad)
    joints = [point_motion(wiper, moving, side.centre).rate[:, 1] for side in wiper.sides]
    both_rise, both_fall = (np.all([sign * rate > 0.02 for rate in joints], axis=0) for sign in (1.0, -1.0))
    assert both_rise.sum() > 50
    assert both_fall.sum() > 50
    assert (drag[both_rise] < 0.0).all()
    assert (drag[both_fall] > 0.0).all()


def test_lift_is_the_force_of_the_thesis(shipped_parts: Shipped) -> None:
    table = run_time_table(assemble(shipped_parts(PUBLISHED)), 64)
    lifts = [0.5 * 1.225 * 0.07 * 0.0517, 0.5 * 1.225 * 0.06 * -0.0694]
    for channel, lift in zip((LEFT_LIFT, RIGHT_LIFT), lifts, strict=True):
        assert table[:, channel, 0] == pytest.approx(lift, rel=1e-12)
        assert not table[:, channel, 1].any()


def test_tabled_coefficients_are_read_at_the_arms_angle(shipped_parts: Shipped) -> None:
    """Pairs on a straight line give that line; the derivatives are those of the values."""
    line = [(float(angle), 0.2 + 1e-3 * angle) for angle in (70, 80, 110, 150, 200)]
    wiper = assemble(with_air(shipped_parts(PUBLISHED), line, line))
    crank_rad, step = np.linspace(0.1, 6.2, 200), 1e-5
    rows, ahead, behind = (exact_rows(wiper, crank_rad + move) for move in (0.0, step, -step))
    pressed = 0.5 * 1.225 * 0.07
    for side, rocker, channel in ((wiper.left, LEFT_ROCKER, LEFT_LIFT), (wiper.right, RIGHT_ROCKER, RIGHT_LIFT)):
        arm_deg = np.degrees(rows[:, rocker, 0] + side.arm.offset_rad)
        assert rows[:, channel, 0] == pytest.approx(pressed * (0.2 + 1e-3 * arm_deg), rel=1e-12)
    for channel in (LEFT_LIFT, RIGHT_LIFT, DRAG):
        truth = (ahead - behind)[:, channel, 0] / (2.0 * step)
        assert np.abs(rows[:, channel, 1] - truth).max() < 1e-8 * np.abs(truth).max()
    plain = exact_rows(assemble(with_air(shipped_parts(PUBLISHED), 1.0, 0.0)), crank_rad)[:, DRAG, 0]
    lowest, highest = (rows[:, DRAG, 0] / plain).min(), (rows[:, DRAG, 0] / plain).max()
    assert 0.2 + 0.0787 - 1e-3 < lowest < highest < 0.2 + 0.18


def test_a_table_that_bends_stays_between_its_pairs(shipped_parts: Shipped) -> None:
    pairs = [(60.0, 0.1), (100.0, 0.1), (120.0, 0.5), (140.0, 0.2), (200.0, 0.2)]
    wiper = assemble(with_air(shipped_parts(PUBLISHED), 0.0, pairs))
    crank_rad, step = np.linspace(0.0, TURN, 2000, endpoint=False), 1e-6
    rows, ahead, behind = (exact_rows(wiper, crank_rad + move) for move in (0.0, step, -step))
    coefficient = rows[:, LEFT_LIFT, 0] / (0.5 * 1.225 * 0.07)
    assert 0.1 - 1e-12 <= coefficient.min() < coefficient.max() <= 0.5 + 1e-12
    assert coefficient.max() > 0.499
    truth = (ahead - behind)[:, LEFT_LIFT, 0] / (2.0 * step)
    assert np.abs(rows[:, LEFT_LIFT, 1] - truth).max() < 1e-4 * np.abs(truth).max()


def test_a_table_that_the_arm_leaves_is_refused(shipped_parts: Shipped) -> None:
    short = with_air(shipped_parts(PUBLISHED), 0.2, [(100.0, 0.05), (180.0, 0.05)])
    with pytest.raises(
        CoefficientError, match=r"left blade: lift: the table covers 100 to 180 deg, but the arm sweeps"
    ):
        run_time_table(assemble(short))


def test_without_masses_and_areas_only_the_geometry_is_left(shipped_parts: Shipped) -> None:
    parts = shipped_parts(PUBLISHED)
    bare = [
        replace(side, arm_mass_kg=0.0, blade=None, blade_mass_kg=0.0, air=Aerodynamics())
        for side in (parts.left, parts.right)
    ]
    table = run_time_table(assemble(replace(parts, left=bare[0], right=bare[1], masses_kg={}, points=2)))
    whole = run_time_table(assemble(parts))
    for channel in (INERTIA, GRAVITY, DRAG, LEFT_LIFT, RIGHT_LIFT):
        assert not table[:, channel].any()
    assert np.abs(table[:, [LEFT_ROCKER, RIGHT_ROCKER]] - whole[:, [LEFT_ROCKER, RIGHT_ROCKER]]).max() < 1e-12
    for channel in range(2):
        assert np.abs(table[:, POINTS + channel] - whole[:, POINTS]).max() < 1e-12
