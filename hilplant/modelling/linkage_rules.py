"""The rules that a linkage must keep to make its turn, each with its numbers: section 4.2.1, (4.24)-(4.33)."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from hilplant.failure import Failure
from hilplant.mechanics.design_points import named_points
from hilplant.mechanics.feasibility import check_crank, check_reach, crank_loop_links, reach
from hilplant.mechanics.joining import straightened
from hilplant.mechanics.planar import Point

Written = Mapping[str, Sequence[float]]
Points = Mapping[str, Point]


class KindOfLinkage(NamedTuple):
    """Names of the points, the loops with the crank, and the loop between the rockers."""

    points: str
    crank_loops: tuple[str, ...]
    rocker_loop: str = ""


KINDS = {
    "slave_driven": KindOfLinkage("OABCDEF", ("OABC",), "CDEF"),
    "master_driven": KindOfLinkage("OABCDE", ("OABC",), "CBDE"),
    "centre_driven": KindOfLinkage("OABCDE", ("OABC", "OADE")),
}


class LinkageRule(NamedTuple):
    """One rule: what must be less than what [m], whether it is, what would help, and the points that it is about.

    `loop` is the loop in which it holds, the code of Appendix D: 1 the crank's, 2 that between the rockers.
    """

    name: str
    loop: str
    smaller: str
    smaller_m: float
    greater: str
    greater_m: float
    keeps: bool
    remedy: str
    points: tuple[str, ...]

    @property
    def margin_m(self) -> float:
        """How far from its limit it is; negative where it is broken."""
        return self.greater_m - self.smaller_m


def linkage_rules(kind: str, written: Written) -> list[LinkageRule]:
    """Return every rule of a kind of linkage; none for an assembly, whose turn is followed instead.

    While the crank of a loop cannot turn, the sweep of its rocker is not defined, and the rules of the next loop are
    left out.

    Raises
    ------
    GeometryError
        For points that are missing or not numbers.

    """
    if kind not in KINDS:
        return []
    known = KINDS[kind]
    points = named_points("linkage", known.points, written)
    rules = [rule for loop in known.crank_loops for rule in _crank_rules(points, loop)]
    if known.rocker_loop and all(rule.keeps for rule in rules):
        rules += _reach_rules(points, known)
    return rules


def _crank_rules(points: Points, loop: str) -> Iterator[LinkageRule]:
    links = crank_loop_links(loop)
    lengths = {link: math.dist(points[link[0]], points[link[1]]) for link in links}
    crank = links[1]
    others = sorted((link for link in links if link != crank), key=lambda link: lengths[link])
    least, longest = others[0], others[-1]
    remedy = _remedy(lambda: check_crank(points, loop))
    shortest = lengths[crank] < lengths[least]
    yield LinkageRule(
        f"the crank {crank} is the shortest", loop, crank, lengths[crank], least, lengths[least], shortest,
        "" if shortest else remedy, _letters(crank, least),
    )  # fmt: skip
    pair = f"{others[0]} + {others[1]}"
    sums = lengths[crank] + lengths[longest], lengths[others[0]] + lengths[others[1]]
    turns = sums[0] < sums[1]
    yield LinkageRule(
        "the crank can turn (Grashof)", loop, f"{crank} + {longest}", sums[0], pair, sums[1], turns,
        "" if turns else remedy, _letters(crank, *others),
    )  # fmt: skip


def _reach_rules(points: Points, kind: KindOfLinkage) -> Iterator[LinkageRule]:
    loop = kind.rocker_loop
    pin, joint, far = loop[1], loop[2], loop[3]
    meant = {**points, "D": straightened(points, "BCD")} if pin == "D" else points
    reached = reach(meant, kind.crank_loops[0], loop)
    link, rocker = pin + joint, joint + far
    lengths = [math.dist(points[name[0]], points[name[1]]) for name in (link, rocker)]
    spread, gap = sum(lengths), abs(lengths[0] - lengths[1])
    remedy = _remedy(lambda: check_reach(points, loop, reached))
    about = _letters(loop[0] + pin, link, rocker)
    far_enough, near_enough = reached[1] < spread, gap < reached[0]
    yield LinkageRule(
        f"{rocker} can follow where {pin} is farthest", loop, f"{pin} to {far}, farthest", reached[1],
        f"{link} + {rocker}", spread, far_enough, "" if far_enough else remedy, about,
    )  # fmt: skip
    yield LinkageRule(
        f"{rocker} can follow where {pin} is nearest", loop, f"|{link} - {rocker}|", gap,
        f"{pin} to {far}, nearest", reached[0], near_enough, "" if near_enough else remedy, about,
    )  # fmt: skip


def _letters(*links: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys("".join(links)))


def _remedy(check: Callable[[], Any]) -> str:
    """Return what the check of a bench says would help."""
    try:
        check()
    except Failure as error:
        return str(error).rpartition(": ")[2]
    return ""
