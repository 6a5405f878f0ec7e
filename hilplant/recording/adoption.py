"""Blocks that another version recorded become what this one reads: each column by its name, none by its place.

Inputs as the elements of a row, see :mod:`hilplant.recording.elements`; outputs and status change nothing.
"""

from collections.abc import Mapping

import numpy as np
import pyarrow as pa

from hilplant.models.records import PARAMETER_INDEX
from hilplant.recording.elements import FORMAT_1, Elements, ForeignElement, elements_of
from hilplant.recording.format import INPUT_COLUMNS, numbers, schema
from hilplant.signals import Inputs

_COLUMNS = {"inputs": "in.", "outputs": "out.", "status": "status."}


def adopted_rows(stored: pa.RecordBatch, inputs: Elements) -> pa.RecordBatch:
    """Return a block as it is read: today's columns, null where the recording lacks an output or a status.

    Raises
    ------
    ForeignElement
        When an input that is not known here had another value than its default, or a parameter that is not was changed.
    """
    _check_changes(stored)
    there = stored.column("deadline_ns").is_valid().to_numpy(zero_copy_only=False)
    for column in unknown_columns(stored.schema, "in."):
        name = column.removeprefix("in.")
        others = [value for value in stored.column(column).drop_null().to_pylist() if value != inputs.get(name)]
        if others:
            raise ForeignElement(f"input {name} is {others[0]:g}, and this version has no such input")
    here, columns, names = elements_of(Inputs), schema(), set(stored.schema.names)
    arrays = []
    for field in columns:
        if field.name in names:
            arrays.append(numbers(stored.column(field.name), field.type))
        elif field.name in INPUT_COLUMNS:
            default = here[field.name.removeprefix("in.")]
            arrays.append(pa.array(np.full(len(there), default), mask=~there))
        elif pa.types.is_list(field.type):
            arrays.append(pa.array([[]] * len(there), field.type))
        else:
            arrays.append(pa.nulls(len(there), field.type))
    return pa.RecordBatch.from_arrays(arrays, schema=columns)


def _check_changes(stored: pa.RecordBatch) -> None:
    """Refuse the change of a parameter that is not known here."""
    if "events" not in stored.schema.names:
        return
    for event in stored.column("events").flatten().to_pylist():
        if (event["kind"], event["outcome"]) == ("parameter", "applied") and event["name"] not in PARAMETER_INDEX:
            raise ForeignElement(f"{event['name']} was changed, and this version has no such element")


def missing_columns(found: pa.Schema) -> tuple[str, ...]:
    """Return the outputs and status that a recording with these columns lacks, by the names of their columns."""
    return tuple(name for name in schema().names if name not in found.names and name.startswith(("out.", "status.")))


def unknown_columns(found: pa.Schema, *kinds: str) -> tuple[str, ...]:
    """Return the columns of these kinds (`in.`, `out.`, `status.`) that this version does not know."""
    known = schema().names
    return tuple(name for name in found.names if name not in known and name.startswith(kinds))


def undescribed_columns(found: pa.Schema, elements: Mapping[str, Elements]) -> list[str]:
    """Return the signals that have a column or a name in the description, but not both: damage, not another version."""
    kinds = tuple(_COLUMNS.values())
    if elements is FORMAT_1:  # whose signals all still exist
        return list(unknown_columns(found, *kinds))
    described = {prefix + name for key, prefix in _COLUMNS.items() for name in elements[key]}
    return sorted(described ^ {name for name in found.names if name.startswith(kinds)})
