"""What a refusal asks for is what would satisfy it; and how near to a dead point is too near."""

import cmath
import math
import re

import numpy as np
import pytest
import yaml

from hilplant.mechanics.design_points import GeometryError, projection_loss
from hilplant.mechanics.feasibility import check_crank, check_reach, reach
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.transmission import check_transmission
from hilplant.resources import shipped

Placed = dict[str, tuple[float, float]]


def shipped_points() -> Placed:
    """Return the published points, D exactly on its line."""
    written = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())["points_m"]
    points = {name: (at[0], at[1]) for name, at in written.items()}
    b, c, d = (complex(*points[name]) for name in "BCD")
    straight = c + abs(d - c) * (b - c) / abs(b - c)
    return points | {"D": (straight.real, straight.imag)}


def moved(points: Placed, name: str, ends: str, lengths: tuple[float, float]) -> Placed | None:
    """Return the points with one of them at new distances from two others, on the side where it was."""
    first, second, was = (complex(*points[point]) for point in (*ends, name))
    apart = abs(second - first)
    along = (apart**2 + lengths[0] ** 2 - lengths[1] ** 2) / (2.0 * apart)
    if abs(along) >= lengths[0]:
        return None
    side = math.copysign(1.0, ((second - first).conjugate() * (was - first)).imag)
    found = first + (second - first) / apart * complex(along, side * math.sqrt(lengths[0] ** 2 - along**2))
    return points | {name: (found.real, found.imag)}


def four_bar(random: np.random.Generator) -> Placed:
    return {name: tuple(map(float, random.normal(size=2))) for name in "OABC"}  # type: ignore[misc]


def crank_limit(points: Placed) -> float | None:
    try:
        check_crank(points)
    except GeometryError as error:
        found = re.search(r"shorten OA below ([\d.e-]+) m$", str(error))
        return float(found.group(1)) if found else None
    return None


def test_a_crank_shortened_as_the_refusal_asks_is_accepted_and_one_a_little_longer_is_not() -> None:
    random, tried = np.random.default_rng(4), 0
    for _ in range(300):
        points = four_bar(random)
        limit = crank_limit(points)
        if limit is None:
            continue
        coupler = math.dist(points["A"], points["B"])
        shorter, longer = (moved(points, "A", "OB", (share * limit, coupler)) for share in (0.999, 1.001))
        if shorter is None or longer is None:
            continue
        check_crank(shorter)
        with pytest.raises(GeometryError, match=r"the crank OA"):
            check_crank(longer)
        tried += 1
    print(f"\n{tried} random crank loops fixed as their refusal says")
    assert tried > 20


def test_where_no_crank_would_do_the_refusal_says_what_is_to_be_changed_first() -> None:
    points: Placed = {"O": (0.0, 0.0), "A": (1.0, 0.0), "B": (1.0, 0.3), "C": (-2.0, 0.3)}
    with pytest.raises(GeometryError, match=r"no crank would do, first shorten BC below AB \+ OC = 2\.322 m$"):
        check_crank(points)


def test_a_link_made_as_long_as_the_refusal_asks_is_accepted() -> None:
    random, tried = np.random.default_rng(6), 0
    good = shipped_points()
    while tried < 40:
        points = good | {"E": (good["E"][0] + random.normal(0.0, 0.05), good["E"][1] + random.normal(0.0, 0.05))}
        reached = reach(points, "OABC", "CDEF")
        try:
            check_reach(points, "CDEF", reached)
        except GeometryError as error:
            found = re.search(r": DE between ([\d.e-]+) and ([\d.e-]+) m would do$", str(error))
            if found is None:
                first = re.search(r"no DE would do, first make EF longer than ([\d.e-]+) m$", str(error))
                assert first and math.dist(points["E"], points["F"]) <= float(first.group(1)) * 1.001
                continue
            low, high = map(float, found.groups())
            fixed = moved(points, "E", "DF", ((low + high) / 2.0, math.dist(points["E"], points["F"])))
            assert fixed is not None
            check_reach(fixed, "CDEF", reached)
            tried += 1


def bent_to(points: Placed, from_line_deg: float) -> Placed:
    """Return the shipped linkage with a link DE such that E comes that near to the line when D and F are farthest."""
    farthest, rocker = reach(points, "OABC", "CDEF")[1], math.dist(points["E"], points["F"])
    angle = math.pi - math.radians(from_line_deg)
    link = rocker * math.cos(angle) + math.sqrt(farthest**2 - (rocker * math.sin(angle)) ** 2)
    fixed = moved(points, "E", "DF", (link, rocker))
    assert fixed is not None
    return fixed


@pytest.mark.parametrize("from_line_deg", [0.5, 3.0, 19.9])
def test_a_linkage_that_turns_but_comes_too_near_to_a_dead_point_is_refused_with_the_angle(
    from_line_deg: float,
) -> None:
    linkage = slave_driven(bent_to(shipped_points(), from_line_deg))
    with pytest.raises(GeometryError) as caught:
        check_transmission(linkage)
    told = re.search(
        r"too near to a dead point: the transmission angle at E between link and right_rocker is ([\d.]+) deg off "
        r"the line at crank angle [\d.]+ deg, which must be at least 20 deg",
        str(caught.value),
    )
    assert told and float(told.group(1)) == pytest.approx(from_line_deg, abs=0.02)


def test_the_limit_of_the_transmission_angle_is_chosen_by_the_caller() -> None:
    linkage = slave_driven(bent_to(shipped_points(), 3.0))
    assert math.degrees(check_transmission(linkage, 2.9).transmission_angle_rad) == pytest.approx(3.0, abs=0.02)
    assert math.degrees(check_transmission(slave_driven(shipped_points())).transmission_angle_rad) > 39.8


def test_projection_loses_the_lean_of_each_body() -> None:
    points = {"A": [0.0, 0.0, 0.1], "B": [0.3, 0.0, 0.5], "C": [0.3, 1.2, 0.0], "D": [0.7, 0.0]}
    loss = projection_loss(points, {"leaning": ("A", "B", "C"), "flat": ("D",), "level": ("A", "A")})
    assert loss == pytest.approx({"leaning": 1.3 - 1.2, "flat": 0.0, "level": 0.0} | {"leaning": 0.2}, abs=1e-15)


def test_links_in_parallel_planes_lose_nothing() -> None:
    points = {name: [*at, 0.02 * index] for index, (name, at) in enumerate(shipped_points().items())}
    flat = {name: [at[0], at[1], 0.02] for name, at in points.items()}
    bodies = slave_driven(flat).body_points
    assert set(projection_loss(flat, bodies).values()) == {0.0}
    lost = projection_loss(points, bodies)
    assert lost["crank"] == pytest.approx(math.hypot(0.0445, 0.0055, 0.02) - abs(cmath.polar(0.0445 + 0.0055j)[0]))
