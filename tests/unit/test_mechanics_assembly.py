"""Linkages from a description: the known kinds again, others, and what is said of descriptions that do not work."""

import copy
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import yaml

from hilplant.mechanics.assembly import Description, assembly
from hilplant.mechanics.centre_driven import centre_driven
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.dyads import taken_apart
from hilplant.mechanics.linkage import Linkage
from hilplant.mechanics.master_driven import master_driven
from hilplant.mechanics.newton_raphson import accelerations, positions
from hilplant.mechanics.planar import Body, Driving, Ground, Revolute
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.mechanics.transmission import _loosest, check_transmission, followed_turn
from hilplant.resources import shipped

WATT = """
points: {O: [0, 0], A: [0.0445, 0.0055], B: [-0.2240, -0.0218], C: [-0.2720, 0.0270],
         D: [-0.2345, -0.0111], E: [0.2325, -0.0175], F: [0.2030, 0.0270]}
bodies: {crank: [O, A], coupler: [A, B], left_rocker: [B, C, D], link: [D, E], right_rocker: [E, F]}
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, left_rocker]}
  - {revolute: C, bodies: [left_rocker, ground]}
  - {revolute: D, bodies: [left_rocker, link]}
  - {revolute: E, bodies: [link, right_rocker]}
  - {revolute: F, bodies: [right_rocker, ground]}
"""
#: The link hangs on the coupler instead, between its ends.
ON_THE_COUPLER = """
points: {O: [0, 0], A: [0.02, 0.0025], B: [-0.2240, -0.0218], C: [-0.2720, 0.0270],
         D: [-0.2000, -0.0300], E: [0.2325, -0.0300], F: [0.2030, 0.0600]}
bodies: {crank: [O, A], coupler: [A, B, D], left_rocker: [B, C], link: [D, E], right_rocker: [E, F]}
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, left_rocker]}
  - {revolute: C, bodies: [left_rocker, ground]}
  - {revolute: D, bodies: [coupler, link]}
  - {revolute: E, bodies: [link, right_rocker]}
  - {revolute: F, bodies: [right_rocker, ground]}
"""


def described(text: str = WATT, **changes: Any) -> Description:
    return Description(**{**yaml.safe_load(text), **changes})


def of_kind(linkage: Linkage) -> Description:
    """Return the description of a linkage of a known kind, with one joint for all bodies that share a pin."""
    bodies = {name: list(points) for name, points in linkage.body_points.items()}
    ground = bodies.pop("ground")
    joints = []
    for point in linkage.points:
        sharing = [name for name, points in bodies.items() if point in points]
        joints.append({"revolute": point, "bodies": ["ground", *sharing] if point in ground else sharing})
    return Description({name: list(at) for name, at in linkage.points.items()}, bodies, joints)


@pytest.mark.parametrize("hand", ["rhd", "lhd"])
@pytest.mark.parametrize(
    ("kind", "make"),
    [("slave_driven", slave_driven), ("master_driven", master_driven), ("centre_driven", centre_driven)],
)
def test_the_known_kinds_are_described_too(hand: str, kind: str, make: Callable[..., Linkage]) -> None:
    known = make(yaml.safe_load(shipped("config", "linkages", f"{hand}_{kind}.yaml").read_text())["points_m"])
    again = assembly(of_kind(known))
    assert (again.left_pivot, again.right_pivot) == (known.left_pivot, known.right_pivot)
    (one, first), (other, second) = followed_turn(known), followed_turn(again)
    for rocker in ("left_rocker", "right_rocker"):
        difference = first[:, one.angle(rocker)] - second[:, other.angle(rocker)]
        assert np.abs(difference).max() < 1e-12
    angles = [check_transmission(one).transmission_angle_rad for one in (again, known)]
    assert angles[0] == pytest.approx(angles[1], abs=1e-12)


def test_a_link_on_the_coupler_is_an_assembly_of_its_own() -> None:
    linkage = assembly(described(ON_THE_COUPLER))
    mechanism, coordinates = followed_turn(linkage)
    lengths = np.hypot(*(_at(linkage, coordinates, "link", "D") - _at(linkage, coordinates, "right_rocker", "F")).T)
    assert np.ptp(lengths) > 0.01
    for body, ends in (("coupler", "AD"), ("link", "DE")):
        apart = _at(linkage, coordinates, body, ends[0]) - _at(linkage, coordinates, body, ends[1])
        assert np.hypot(*apart.T) == pytest.approx(np.hypot(*_design(linkage, ends)), abs=1e-12)
    shared = _at(linkage, coordinates, "coupler", "D") - _at(linkage, coordinates, "link", "D")
    assert np.abs(shared).max() < 1e-12
    assert coordinates[-1, mechanism.angle("right_rocker")] == pytest.approx(
        coordinates[0, mechanism.angle("right_rocker")], abs=1e-12
    )


def _at(linkage: Linkage, coordinates: Any, body: str, point: str) -> Any:
    return linkage.mechanism().point(coordinates, (body, linkage.body(body).local(linkage.points[point])))


def _design(linkage: Linkage, ends: str) -> Any:
    return np.subtract(*(linkage.points[end] for end in ends))


def test_a_bracket_rigidly_joined_moves_as_if_it_were_one_body() -> None:
    whole = assembly(described())
    text = WATT.replace("left_rocker: [B, C, D]", "left_rocker: [B, C], bracket: [C, D]")
    text = text.replace("[left_rocker, link]", "[bracket, link]") + "  - {rigid: C, bodies: [left_rocker, bracket]}\n"
    parts = assembly(described(text, points={**yaml.safe_load(WATT)["points"], "D": [-0.24, -0.012]}))
    bent = assembly(described(points={**yaml.safe_load(WATT)["points"], "D": [-0.24, -0.012]}))
    (one, first), (other, second) = followed_turn(parts), followed_turn(bent)
    assert np.abs(first[:, one.angle("right_rocker")] - second[:, other.angle("right_rocker")]).max() < 1e-12
    assert len(parts.bodies) == len(whole.bodies) + 1
    assert [dyad.bodies for dyad in taken_apart(parts)[0]] == [
        ("coupler", "left_rocker"),
        ("link", "right_rocker"),
    ]


def test_a_grounded_frame_is_as_good_as_the_ground() -> None:
    text = WATT.replace("right_rocker: [E, F]}", "right_rocker: [E, F], frame: [O, C]}")
    text = text.replace("{revolute: O, bodies: [ground, crank]}", "{revolute: O, bodies: [frame, crank]}")
    framed = text.replace("bodies: [left_rocker, ground]", "bodies: [left_rocker, frame]") + "  - {ground: frame}\n"
    with pytest.raises(GeometryError, match="crank: body crank must turn about one point of the ground, not 0"):
        assembly(described(framed))
    extra = WATT.replace("right_rocker: [E, F]}", "right_rocker: [E, F], frame: [O, C]}") + "  - {ground: frame}\n"
    (one, first), (other, second) = followed_turn(assembly(described(extra))), followed_turn(assembly(described()))
    angles = first[:, one.angle("right_rocker")], second[:, other.angle("right_rocker")]
    assert np.array_equal(*angles) or np.abs(angles[0] - angles[1]).max() < 1e-12


#: A triangle carried by three links (no pair of bodies settles itself), the first of them swung by the crank.
TRIANGLE = """
points: {O: [0, 0], A: [0.03, 0.0], B: [0.3, 0.0], C: [0.3, 0.2], G: [0.3, 0.3], P: [0.55, 0.1], Q: [0.6, -0.2]}
bodies: {crank: [O, A], coupler: [A, B], plate: [B, C, P], left_rocker: [C, G], right_rocker: [P, Q]}
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, plate]}
  - {revolute: C, bodies: [plate, left_rocker]}
  - {revolute: G, bodies: [left_rocker, ground]}
  - {revolute: P, bodies: [plate, right_rocker]}
  - {revolute: Q, bodies: [right_rocker, ground]}
"""


def test_bodies_that_only_settle_each_other_are_solved() -> None:
    linkage = assembly(described(TRIANGLE))
    assert taken_apart(linkage) == ([], ["coupler", "plate", "left_rocker", "right_rocker"])
    mechanism, coordinates = followed_turn(linkage)
    step, drive = 1e-4, coordinates[::64, mechanism.angle("crank")]
    ahead, behind = (positions(mechanism, coordinates[::64], drive + side) for side in (step, -step))
    difference = (ahead + behind - 2.0 * coordinates[::64]) / step**2
    assert np.abs(accelerations(mechanism, coordinates[::64]) - difference).max() < 1e-5


def test_bodies_that_only_settle_each_other_are_refused_near_their_dead_point() -> None:
    """With a crank of 0.08671 m the turn just fails, so a little below it must come near to nothing."""
    cranks, told = (0.03, 0.06, 0.08, 0.0865, 0.086705), []
    for crank in cranks:
        points = {**yaml.safe_load(TRIANGLE)["points"], "A": [crank, 0.0]}
        linkage = assembly(described(TRIANGLE, points=points))
        told.append(np.degrees(check_transmission(linkage, 0.0).transmission_angle_rad))
    print("\n" + ", ".join(f"crank {crank}: {angle:.2f} deg" for crank, angle in zip(cranks, told, strict=True)))
    assert told == sorted(told, reverse=True)
    assert told[-1] < 0.5
    with pytest.raises(GeometryError, match="the transmission angle at coupler, plate, left_rocker, right_rocker is 0"):
        check_transmission(linkage)


@pytest.mark.parametrize("from_line_deg", [0.5, 3.0])
def test_the_measure_without_dyads_is_the_transmission_angle_where_there_is_one(from_line_deg: float) -> None:
    """Near the line, of any lengths: the same four-bar, once judged as a dyad and once by its singular value."""
    angle = np.radians(180.0 - from_line_deg)
    points = {"O": [0.0, 0.0], "A": [0.02, 0.0], "B": [1.0, 0.0]}
    points["C"] = [1.0 + 0.7 * np.cos(np.pi - angle), 0.7 * np.sin(np.pi - angle)]
    bodies = [Body.between("coupler", (0.02, 0.0), (1.0, 0.0)), Body.between("rocker", (1.0, 0.0), tuple(points["C"]))]
    crank = Body.between("crank", (0.0, 0.0), (0.02, 0.0))
    joints = (
        Ground("ground"),
        Revolute(("ground", (0.0, 0.0)), crank.first_end),
        Revolute(crank.second_end, bodies[0].first_end),
        Revolute(bodies[0].second_end, bodies[1].first_end),
        Revolute(bodies[1].second_end, ("ground", tuple(points["C"]))),
        Driving("crank"),
    )
    four_bar = Linkage("", {}, (Body.ground(), crank, *bodies), joints, {}, (0.0, 0.0), (0.0, 0.0))
    mechanism = four_bar.mechanism()
    place = _loosest(four_bar, mechanism, mechanism.design[np.newaxis], ["coupler", "rocker"])
    assert np.degrees(place.transmission_angle_rad) == pytest.approx(from_line_deg, rel=2e-3)


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
