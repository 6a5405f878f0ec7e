"""Joint forces where statics gives them by hand, and those of the published geometry as a table."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from hilplant.mechanics.inverse_dynamics import Loads
from hilplant.mechanics.joint_forces import loads_over_a_turn, peak_loads
from hilplant.mechanics.wiper import WiperParts, assemble

Shipped = Callable[[str], WiperParts]
TURN_A_SECOND = 2.0 * np.pi
#: Table 5-9: 7.615 N on each blade, dry, where (4.49) is level: mu_dry_1 + mu_dry_3 = 2.3146.
DRY_FORCE_N = 7.615 * (0.3186 + 1.996)


def weightless(parts: WiperParts) -> WiperParts:
    sides = [replace(side, arm_mass_kg=0.0, blade_mass_kg=0.0) for side in (parts.left, parts.right)]
    return replace(parts, left=sides[0], right=sides[1], masses_kg={})


def joint(loads: Loads, first: str, second: str) -> int:
    return next(index for index, each in enumerate(loads.joints) if {each.first, each.second} == {first, second})


def test_without_masses_the_link_pulls_along_itself_with_the_lever_of_its_rocker(shipped_parts: Shipped) -> None:
    """Friction times the arm's radius is the link's force times its distance from the right pivot."""
    parts = weightless(shipped_parts("rhd_slave_driven"))
    wiper = assemble(parts)
    moving, loads = loads_over_a_turn(wiper, TURN_A_SECOND, DRY_FORCE_N)
    far, near = (loads.joints[joint(loads, "link", rocker)] for rocker in ("right_rocker", "left_rocker"))
    assert np.abs(far.force_n + near.force_n).max() < 1e-9 * np.abs(far.force_n).max()
    ends = [wiper.mechanism.point(moving.coordinates, each.pin) for each in (far, near)]
    along = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0], axis=1, keepdims=True)
    spoke = ends[0] - np.array(parts.linkage.right_pivot)
    lever = np.abs(spoke[:, 0] * along[:, 1] - spoke[:, 1] * along[:, 0])
    radius = np.hypot(*parts.right.arm[-1])
    assert np.linalg.norm(far.force_n, axis=1) * lever == pytest.approx(DRY_FORCE_N * radius, rel=1e-9)
    across = far.force_n[:, 0] * along[:, 1] - far.force_n[:, 1] * along[:, 0]
    assert np.abs(across).max() < 1e-9 * np.abs(far.force_n).max()


def test_the_arm_passes_friction_on_as_a_moment_to_its_rocker(shipped_parts: Shipped) -> None:
    wiper = assemble(weightless(shipped_parts("rhd_slave_driven")))
    _, loads = loads_over_a_turn(wiper, TURN_A_SECOND, DRY_FORCE_N)
    for side in wiper.sides:
        held = loads.joints[joint(loads, side.rocker, side.bodies[0])]
        assert np.abs(held.moment_n_m) == pytest.approx(DRY_FORCE_N * side.arm.length_m, rel=1e-9)
        assert np.linalg.norm(held.force_n, axis=1) == pytest.approx(DRY_FORCE_N, rel=1e-9)


def test_largest_loads_of_the_published_geometry(shipped_parts: Shipped) -> None:
    """Prints the table of docs/dynamics.md: arms of 0.5 kg, blades of 0.3 kg (assumed), a turn each second, dry."""
    parts = shipped_parts("rhd_slave_driven")
    sides = [replace(side, arm_mass_kg=0.5, blade_mass_kg=0.3) for side in (parts.left, parts.right)]
    wiper = assemble(replace(parts, left=sides[0], right=sides[1]))
    bare, dry = (peak_loads(wiper, TURN_A_SECOND, force) for force in (0.0, DRY_FORCE_N))
    print(f"\n{'joint':32s} {'no friction':>22s} {'dry':>22s}   largest moment, dry")
    for free, loaded in zip(bare, dry, strict=True):
        figures = " ".join(f"{each.force_n:8.1f} N at {each.crank_deg:5.1f}°" for each in (free, loaded))
        print(f"{free.joint:32s} {figures} {loaded.moment_n_m:12.2f} N m")
    by_name = {peak.joint: peak for peak in dry}
    assert by_name["ground - crank"].force_n == pytest.approx(by_name["crank - coupler"].force_n, rel=0.01)
    assert by_name["ground - crank"].crank_deg == pytest.approx(177.95, abs=1.0)  # the upper dead centre
