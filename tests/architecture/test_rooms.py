"""Rooms and their arrows: each is named, each import follows an arrow, no circle, no arrow upwards."""

from pathlib import Path

import pytest
from architecture.house import House
from architecture.rooms import ARROWS, FREE, LAYERS, PAGE, layer_of, with_drawing


@pytest.fixture(scope="module")
def house(root: Path) -> House:
    return House.of(root)


def test_every_room_is_named_with_its_layer_and_its_arrows(house: House) -> None:
    layered = {name for names in LAYERS.values() for name in names.split()}
    assert house.rooms.keys() == layered, "rooms without a layer, or layers without a room"
    assert house.rooms.keys() == {*ARROWS, FREE}, "rooms without arrows, or arrows without a room"


def test_every_import_follows_an_arrow(house: House) -> None:
    wrong = [
        f"{room.name} imports from {other}"
        for room in house.rooms.values()
        if room.name != FREE
        for other in sorted(room.arrows - set(ARROWS[room.name].split()))
    ]
    assert not wrong, "\n".join(wrong)


def test_no_arrow_points_upwards(house: House) -> None:
    allowed = {name: set(names.split()) for name, names in ARROWS.items()} | {FREE: house.rooms[FREE].arrows}
    wrong = [f"{name} -> {far}" for name, others in allowed.items() for far in others if layer_of(far) > layer_of(name)]
    assert not wrong, "\n".join(wrong)


def test_there_is_no_circle_of_rooms(house: House) -> None:
    assert house.circles == []


def test_nothing_but_the_command_line_imports_the_thesis(house: House) -> None:
    assert [room.name for room in house.rooms.values() if "thesis" in room.arrows] == ["cli"]


def test_the_picture_is_that_of_the_sources(house: House) -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert with_drawing(page, house) == page, "python -m tests.architecture.rooms --write draws it again"


def test_a_circle_and_an_arrow_that_follows_are_found(tmp_path: Path) -> None:
    for name, text in {
        "a": "from hilplant.b import x\nimport hilplant.c.y",
        "b": "from hilplant import c",
        "c": "import math",
        "d": "from hilplant.e import z",
        "e": "import hilplant.d",
    }.items():
        (tmp_path / "hilplant" / name).mkdir(parents=True)
        (tmp_path / "hilplant" / name / "__init__.py").write_text(text)
    found = House.of(tmp_path)
    assert found.circles == [{"d", "e"}]
    assert ("a", "b") in set(found.drawn())
    assert ("a", "c") not in set(found.drawn())
