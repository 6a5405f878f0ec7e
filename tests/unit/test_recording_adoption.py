"""Rows and columns of another version are adopted by name; what this version does not know changes nothing."""

from typing import Any

import numpy as np
import pyarrow as pa
import pytest

from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX, Parameters, State
from hilplant.recording.adoption import adopted_rows
from hilplant.recording.elements import FORMAT_1, ForeignElement, adopted_row, elements_of
from hilplant.recording.format import EVENT_TYPE, schema
from hilplant.signals import Inputs


@pytest.mark.parametrize(("key", "record"), [("parameter_row", Parameters), ("state_row", State)])
def test_every_name_of_format_1_is_still_an_element(key: str, record: type) -> None:
    assert set(FORMAT_1[key]) <= set(elements_of(record))
    assert len(FORMAT_1[key]) == {"parameter_row": 48, "state_row": 14}[key]


@pytest.mark.parametrize("seed", range(5))
def test_a_row_in_any_order_is_adopted_by_name_and_networks_stay_behind(seed: int) -> None:
    random = np.random.default_rng(seed)
    names = list(random.permutation(list(PARAMETER_INDEX)))
    row = random.normal(size=len(names) + 7)
    adopted = adopted_row(row, dict.fromkeys(names, 0.0), Parameters)
    assert [adopted[PARAMETER_INDEX[name]] for name in names] == row[: len(names)].tolist()
    assert adopted[len(names) :].tolist() == row[len(names) :].tolist()


def test_an_element_that_the_recording_lacks_takes_its_default() -> None:
    elements = {name: default for name, default in elements_of(State).items() if name != "noise"}
    adopted = adopted_row(np.full(len(elements), 7.0), elements, State)
    assert adopted[STATE_INDEX["noise"]] == 1.0
    assert (adopted == 7.0).sum() == len(elements)


def test_an_element_without_a_default_must_be_there() -> None:
    elements = {name: default for name, default in elements_of(Parameters).items() if name != "motor.inertia_kg_m2"}
    with pytest.raises(ForeignElement, match=r"it has no motor\.inertia_kg_m2"):
        adopted_row(np.ones(len(elements)), elements, Parameters)


@pytest.mark.parametrize("place", [0, 5, len(elements_of(State))])
def test_an_element_that_is_not_known_here_must_have_had_its_default(place: int) -> None:
    known = list(elements_of(State).items())
    elements = dict([*known[:place], ("tank.level", 0.5), *known[place:]])
    assert list(elements).index("tank.level") == place
    row = np.arange(1.0, len(elements) + 1)
    row[place] = 0.5
    assert adopted_row(row, elements, State).tolist() == np.delete(row, place).tolist()
    row[place] = 0.25
    with pytest.raises(ForeignElement, match=r"tank\.level is 0\.25, and this version has no such element"):
        adopted_row(row, elements, State)


def test_a_row_that_is_too_short_is_damage() -> None:
    with pytest.raises(ValueError, match="cannot hold"):
        adopted_row(np.zeros(3), elements_of(State), State)


def block(**changes: Any) -> pa.RecordBatch:
    """Three ticks, the second of which was lost; a change adds or replaces a column, None removes it."""
    columns = {"tick": [5, 6, 7], "deadline_ns": [5, None, 7]}
    columns |= {name: [[], [], []] if name in ("frames", "events") else [1.5, None, 2.5] for name in schema().names[2:]}
    columns = {name: values for name, values in (columns | changes).items() if values is not None}
    fields = {field.name: field.type for field in schema()}
    arrays = {name: pa.array(values, fields.get(name, pa.float64())) for name, values in columns.items()}
    return pa.RecordBatch.from_pydict(arrays)


def test_columns_are_adopted_by_name() -> None:
    stored = block(**{"in.supply_v": None, "out.current_a": None, "out.old": [1.0, None, 2.0]})
    rows = adopted_rows(stored, elements_of(Inputs))
    assert rows.schema.names == schema().names
    assert rows.column("in.supply_v").to_pylist() == [13.5, None, 13.5]
    assert rows.column("out.current_a").null_count == 3
    assert rows.column("in.screen").to_pylist() == [1.5, None, 2.5]


def test_an_input_that_is_not_known_here_must_have_had_its_default() -> None:
    inputs = {**elements_of(Inputs), "drag_n_m": 0.5}
    rows = adopted_rows(block(**{"in.drag_n_m": [0.5, None, 0.5]}), inputs)
    assert "in.drag_n_m" not in rows.schema.names
    with pytest.raises(ForeignElement, match=r"input drag_n_m is 0\.75, and this version has no such input"):
        adopted_rows(block(**{"in.drag_n_m": [0.5, None, 0.75]}), inputs)


@pytest.mark.parametrize(("name", "outcome"), [("motor.gear_ratio", "applied"), ("tank.volume_m3", "too late")])
def test_the_change_of_a_parameter_that_is_not_known_here_is_refused_where_it_was_applied(
    name: str, outcome: str
) -> None:
    event = {field.name: "" if field.type == pa.string() else 0 for field in EVENT_TYPE}
    event |= {"kind": "parameter", "name": name, "outcome": outcome}
    assert adopted_rows(block(events=[[], [event], []]), {}).column("events")[1].as_py()[0]["name"] == name
    event |= {"name": "tank.volume_m3", "outcome": "applied"}
    with pytest.raises(ForeignElement, match=r"tank\.volume_m3 was changed, and this version has no such element"):
        adopted_rows(block(events=[[], [event], []]), {})
