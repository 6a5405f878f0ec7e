"""What is assembled from bodies and joints, beside the equations as the thesis prints them for each kind.

Typed in from (4.11), (4.23), (9.3) and (9.10), with bodies 1 to 6. Each kind prints the loop O-A-B-C alike, then how
body 5 hangs on it. Errata: (9.10) starts body 5 at O, where its Jacobian (9.11) has the crank's pin; the right sides
(4.23) have the opposite sign of what their definition (4.20) gives.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.newton_raphson import follow
from hilplant.units import TURN_RAD

Pair = tuple[Any, Any]


def half(q: Floats, body: int, length: float) -> Pair:
    """Return half the length of a body along its direction."""
    angle = q[3 * body - 1]
    return length / 2.0 * np.cos(angle), length / 2.0 * np.sin(angle)


def centre(q: Floats, body: int) -> Pair:
    return q[3 * body - 3], q[3 * body - 2]


def add(*terms: tuple[float, Pair]) -> Pair:
    x, y = (sum(sign * term[axis] for sign, term in terms) for axis in (0, 1))
    return x, y


def distance(at: dict[str, complex], ends: str) -> float:
    return abs(at[ends[0]] - at[ends[1]])


def point(at: dict[str, complex], name: str) -> Pair:
    return at[name].real, at[name].imag


def crank_rows(q: Floats, at: dict[str, complex]) -> list[Pair]:
    """Return C4 to C11, the same in (4.11), (9.3) and (9.10)."""
    two, three, four = (half(q, body, distance(at, ends)) for body, ends in ((2, "OA"), (3, "AB"), (4, "BC")))
    return [
        add((1, centre(q, 2)), (-1, two)),
        add((1, centre(q, 2)), (1, two), (-1, centre(q, 3)), (1, three)),
        add((1, centre(q, 3)), (1, three), (-1, centre(q, 4)), (1, four)),
        add((1, centre(q, 4)), (1, four), (-1, point(at, "C"))),
    ]


def slave_rows(q: Floats, at: dict[str, complex]) -> list[Pair]:
    """Return C12 to C17 of (4.11)."""
    five, six = half(q, 5, distance(at, "DE")), half(q, 6, distance(at, "EF"))
    to_d = half(q, 4, 2.0 * (distance(at, "CD") - distance(at, "BC") / 2.0))
    return [
        add((1, centre(q, 5)), (-1, five), (-1, centre(q, 4)), (1, to_d)),
        add((1, centre(q, 5)), (1, five), (-1, centre(q, 6)), (1, six)),
        add((1, centre(q, 6)), (1, six), (-1, point(at, "F"))),
    ]


def master_rows(q: Floats, at: dict[str, complex]) -> list[Pair]:
    """Return the last of (9.3): body 5 begins where body 3 ends."""
    three, five, six = half(q, 3, distance(at, "AB")), half(q, 5, distance(at, "BD")), half(q, 6, distance(at, "DE"))
    return [
        add((1, centre(q, 3)), (1, three), (-1, centre(q, 5)), (1, five)),
        add((1, centre(q, 5)), (1, five), (-1, centre(q, 6)), (1, six)),
        add((1, centre(q, 6)), (1, six), (-1, point(at, "E"))),
    ]


def centre_rows(q: Floats, at: dict[str, complex], sign: float = 1.0) -> list[Pair]:
    """Return the last of (9.10), with the crank's half added as in its Jacobian; printed is the sign -1."""
    two, five, six = half(q, 2, distance(at, "OA")), half(q, 5, distance(at, "AD")), half(q, 6, distance(at, "DE"))
    return [
        add((1, centre(q, 2)), (sign, two), (-1, centre(q, 5)), (1, five)),
        add((1, centre(q, 5)), (1, five), (-1, centre(q, 6)), (1, six)),
        add((1, centre(q, 6)), (1, six), (-1, point(at, "E"))),
    ]


ROWS: dict[str, Callable[..., list[Pair]]] = {
    "slave_driven": slave_rows,
    "master_driven": master_rows,
    "centre_driven": centre_rows,
}


def printed(kind: str, q: Floats, at: dict[str, complex], crank_rad: float) -> Floats:
    """Return all eighteen constraints."""
    pairs = crank_rows(q, at) + ROWS[kind](q, at)
    return np.array([q[0], q[1], q[2], *(value for pair in pairs for value in pair), q[5] - crank_rad])


def test_assembled_constraints_are_those_of_the_thesis_at_any_coordinates(
    linkage: Linkage, placed: dict[str, complex]
) -> None:
    random = np.random.default_rng(2)
    for _ in range(20):
        q = random.normal(size=18)
        q[:3] = 0.0  # the thesis leaves the base out of the other rows
        ours, theirs = linkage.mechanism().constraints(q, np.array(0.3)), printed(linkage.kind, q, placed, 0.3)
        assert np.abs(ours) == pytest.approx(np.abs(theirs), abs=1e-14)


def test_assembled_jacobians_are_the_derivatives_of_the_printed_constraints(
    linkage: Linkage, placed: dict[str, complex]
) -> None:
    q = np.random.default_rng(3).normal(size=18)
    q[:3] = 0.0
    theirs = np.array([printed(linkage.kind, q + 1e-30j * side, placed, 0.3).imag / 1e-30 for side in np.eye(18)]).T
    ours = linkage.mechanism().jacobian(q)
    assert np.abs(ours[:, 3:]) == pytest.approx(np.abs(theirs[:, 3:]), abs=1e-14)


def test_solved_coordinates_satisfy_the_printed_constraints_over_a_turn(
    linkage: Linkage, placed: dict[str, complex]
) -> None:
    crank = linkage.design_crank_angle_rad + np.linspace(0.0, TURN_RAD, 65)
    for q, angle in zip(follow(linkage.mechanism(), crank), crank, strict=True):
        assert np.abs(printed(linkage.kind, q, placed, angle)).max() < 1e-13


@pytest.mark.parametrize("written", ["rhd_centre_driven", "lhd_centre_driven"], indirect=True)
def test_the_centre_driven_linkage_does_not_move_with_the_sign_that_is_printed(
    linkage: Linkage, placed: dict[str, complex]
) -> None:
    """With the minus of (9.10) body 5 begins at O: the design points do not fit, and nothing drives it."""
    design = linkage.mechanism().design
    gaps = [np.hypot(*centre_rows(design, placed, sign)[0]) for sign in (1.0, -1.0)]
    assert gaps == pytest.approx([0.0, distance(placed, "OA")], abs=1e-15)


def printed_right_side(q: Floats, speeds: Floats, at: dict[str, complex]) -> Floats:
    """Return (4.23) of the slave-driven linkage, row by row as printed."""
    lengths = {2: "OA", 3: "AB", 4: "BC", 5: "DE", 6: "EF"}
    term = {body: add((speeds[body - 1] ** 2, half(q, body, distance(at, ends)))) for body, ends in lengths.items()}
    to_d = add((speeds[3] ** 2, half(q, 4, 2.0 * (distance(at, "CD") - distance(at, "BC") / 2.0))))
    pairs = [
        term[2],
        add((-1, term[2]), (-1, term[3])),
        add((-1, term[3]), (-1, term[4])),
        add((-1, term[4])),
        add((-1, to_d), (1, term[5])),
        add((-1, term[5]), (-1, term[6])),
        add((-1, term[6])),
    ]
    return np.array([0.0, 0.0, 0.0, *(value for pair in pairs for value in pair), 0.0])


@pytest.mark.parametrize("written", ["rhd_slave_driven", "lhd_slave_driven"], indirect=True)
def test_right_side_of_the_accelerations_is_the_printed_one_with_its_sign_put_right(
    linkage: Linkage, placed: dict[str, complex]
) -> None:
    mechanism, random = linkage.mechanism(), np.random.default_rng(5)
    q, velocities = random.normal(size=18), random.normal(size=18)
    q[:3] = velocities[:3] = 0.0
    theirs = printed_right_side(q, velocities[2::3], placed)
    constraints = printed(linkage.kind, q, placed, 0.0), mechanism.constraints(q, np.array(0.0))
    same_way = np.sign(constraints[0] * constraints[1])  # a joint's equation may be written the other way round
    assert same_way * mechanism.turning(q, velocities) == pytest.approx(-theirs, abs=1e-14)
