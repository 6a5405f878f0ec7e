"""What is said of descriptions of linkages that do not work."""

import copy
import re
from collections.abc import Callable
from typing import Any

import pytest
import yaml
from support.described_linkages import WATT, described

from hilplant.mechanics.assembly import Description, assembly
from hilplant.mechanics.design_points import GeometryError


def edited(edit: Callable[[dict[str, Any]], Any]) -> Description:
    data = copy.deepcopy(yaml.safe_load(WATT))
    edit(data)
    return Description(**data)


#: What is done to the description; what must be said; where the fault lies.
MISTAKES: list[tuple[Callable[[dict[str, Any]], Any], str, tuple[str | int, ...]]] = [
    (
        lambda d: d["joints"].pop(5),
        "linkage: 3 x 5 bodies - 2 x 6 revolute - 3 x 0 rigid - 3 x 0 grounded = 3 degrees of freedom, must be 1: "
        "joints are missing",
        (),
    ),
    (
        lambda d: d["joints"].append({"rigid": "D", "bodies": ["left_rocker", "link"]}),
        "= -2 degrees of freedom, must be 1: there are too many joints",
        (),
    ),
    (
        lambda d: (d["bodies"].update(stray=["A", "C"]), d["joints"].append({"ground": "nobody"})),
        "joint 8: there is no body nobody, only ground, crank, coupler, left_rocker, link, right_rocker, stray",
        ("joints", 7),
    ),
    (lambda d: d["bodies"].update(stray=["A", "C"]), "no row of joints connects stray with the ground", ()),
    (lambda d: d["bodies"].update(ground=["O", "C"]), "body ground: is there already", ("bodies", "ground")),
    (lambda d: d["bodies"].update(link=["D"]), "body link: needs two points or more, as [A, B]", ("bodies", "link")),
    (lambda d: d["bodies"].update(link="DE"), "body link: needs two points or more, as [A, B]", ("bodies", "link")),
    (
        lambda d: d["bodies"].update(link=["D", "X"]),
        "body link: there is no point X, only O, A, B, C, D, E, F",
        ("bodies", "link"),
    ),
    (
        lambda d: d["points"].update(E=d["points"]["D"]),
        "body link: D and E are one point, a body needs a length between its points",
        ("bodies", "link"),
    ),
    (lambda d: d["points"].update(X=[1, 1]), "point X: is on no body", ("points_m", "X")),
    (
        lambda d: d["joints"].__setitem__(2, {"hinge": "B", "bodies": ["coupler", "left_rocker"]}),
        "joint 3: must be {revolute: A, bodies: [crank, coupler]}, {rigid: P, bodies: [...]} or {ground: frame}, not",
        ("joints", 2),
    ),
    (
        lambda d: d["joints"].__setitem__(2, {"revolute": "B", "bodies": ["coupler"]}),
        "joint 3: needs two bodies or more, each once, not ['coupler']",
        ("joints", 2),
    ),
    (
        lambda d: d["joints"].__setitem__(2, {"revolute": "B", "bodies": ["crank", "left_rocker"]}),
        "joint 3: point B is not on body crank, which has O, A",
        ("joints", 2),
    ),
    (
        lambda d: d["joints"].__setitem__(2, {"revolute": "X", "bodies": ["crank", "left_rocker"]}),
        "joint 3: there is no point X, only O, A, B, C, D, E, F",
        ("joints", 2),
    ),
    (lambda d: d.update(crank="motor"), "crank: there is no body motor, only crank, coupler,", ("crank",)),
    (
        lambda d: d.update(left_rocker="link"),
        "left_rocker: body link must turn about one point of the ground, not 0",
        ("left_rocker",),
    ),
    (
        lambda d: d.update(left_rocker="right_rocker"),
        "crank, left_rocker and right_rocker must be three bodies",
        ("bodies",),
    ),
    (
        lambda d: d.update(left_rocker="right_rocker", right_rocker="left_rocker"),
        "left_rocker: its pivot F (x = 0.203 m) must lie to the left of the right rocker's, C (x = -0.272 m)",
        ("left_rocker",),
    ),
    (
        lambda d: d["points"].update(A=[0.0, 0.09]),
        "linkage: the crank cannot turn past ",
        (),
    ),
    (
        lambda d: d["points"].update(E=[0.2030, 0.0005]),
        "there E between link and right_rocker lies stretched, and its outer pins go farther apart than 0.4377 + ",
        (),
    ),
]


@pytest.mark.parametrize(("edit", "said", "part"), MISTAKES)
def test_a_mistake_is_named_in_one_line_with_its_place(
    edit: Callable[[dict[str, Any]], Any], said: str, part: tuple[str | int, ...]
) -> None:
    with pytest.raises(GeometryError, match=re.escape(said)) as caught:
        assembly(edited(edit))
    assert "\n" not in str(caught.value)
    assert caught.value.part == part


def test_a_start_in_a_dead_point_is_refused_with_the_bodies_that_are_loose() -> None:
    flat = {"E": [-0.2345 + 0.4375 * 0.9, -0.0111 + 0.0381 * 0.9]}  # on the line from D to F
    with pytest.raises(
        GeometryError,
        match="the design position is a dead point: with the crank held, link, right_rocker can still move",
    ):
        assembly(described(points={**yaml.safe_load(WATT)["points"], **flat}))


def test_bodies_held_twice_while_others_are_loose_are_refused_though_the_count_is_right() -> None:
    """Two rigid joints too many lock the crank's loop (-2), one joint is missing (+2): in sum one degree of freedom."""

    def edit(data: dict[str, Any]) -> None:
        data["joints"][2] = {"rigid": "B", "bodies": ["coupler", "left_rocker"]}
        data["joints"][4] = {"rigid": "D", "bodies": ["left_rocker", "link"]}
        data["joints"].pop(5)

    with pytest.raises(GeometryError, match="crank held, right_rocker can still move while other bodies are held more"):
        assembly(edited(edit))


def test_a_rocker_that_goes_round_with_the_crank_is_refused() -> None:
    """A drag link: the ground is the shortest, both ends of the coupler go round."""
    points = {
        "O": [0.0, 0.0],
        "A": [0.0, 0.5],
        "B": [0.6, 0.5],
        "C": [0.2, 0.0],
        "D": [0.3, 0.125],
        "E": [0.9, 0.3],
        "F": [1.0, -0.2],
    }
    with pytest.raises(GeometryError, match=r"left_rocker does not rock: after one turn .* turned by 360 deg"):
        assembly(described(points=points))
