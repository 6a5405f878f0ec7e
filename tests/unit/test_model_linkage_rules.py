"""The rules of a linkage say what the check of a bench says, for any points, with the numbers of the check."""

import math
import random

import pytest

from hilplant.failure import Failure
from hilplant.mechanics.centre_driven import centre_driven
from hilplant.mechanics.master_driven import master_driven
from hilplant.mechanics.slave_driven import slave_driven
from hilplant.modelling.linkage_rules import KINDS, linkage_rules
from hilplant.modelling.model_files import ModelFiles
from hilplant.modelling.opening import open_model, with_library_part
from hilplant.modelling.view import checked

MAKERS = {"slave_driven": slave_driven, "master_driven": master_driven, "centre_driven": centre_driven}


def points_of(name: str) -> dict[str, list[float]]:
    return dict(checked(open_model_with(name)).values["plant"]["linkage"]["points_m"])


def open_model_with(name: str) -> ModelFiles:
    return with_library_part(open_model("default"), "linkage", name)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("side", ["rhd", "lhd"])
def test_rules_hold_exactly_where_the_check_lets_a_linkage_pass(kind: str, side: str) -> None:
    points, draw, seen = points_of(f"{side}_{kind}"), random.Random(kind + side), set()
    assert all(rule.keeps for rule in linkage_rules(kind, points))
    for _ in range(300):
        tried = {
            letter: [x + draw.gauss(0.0, 0.02), y + draw.gauss(0.0, 0.02)] for letter, (x, y, *_) in points.items()
        }
        rules = linkage_rules(kind, tried)
        broken = [rule for rule in rules if not rule.keeps]
        try:
            MAKERS[kind](tried)
            assert not broken
        except Failure as error:
            assert broken, str(error)
            assert broken[0].remedy and broken[0].remedy in str(error)
            assert all(rule.margin_m <= 0.0 for rule in broken)
        seen.add(bool(broken))
    assert seen == {True, False}


def test_a_crank_that_is_too_long_is_named_with_its_numbers_and_points() -> None:
    points = points_of("rhd_slave_driven") | {"A": [0.08, 0.0055, 0.0]}
    crank, grashof = linkage_rules("slave_driven", points)
    assert not crank.keeps
    assert crank.smaller_m == pytest.approx(math.hypot(0.08, 0.0055), abs=1e-15)
    assert "A" in crank.points and "A" in grashof.points
    assert crank.remedy.startswith("shorten OA below")


def test_an_assembly_has_no_rules_of_lengths() -> None:
    assert linkage_rules("assembly", {"O": [0, 0]}) == []
