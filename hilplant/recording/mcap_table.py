"""Columns over time -> an MCAP file: one channel of JSON messages, its schema with unit and name of each signal."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic_core import to_json

from hilplant.units import SECOND_NS

if TYPE_CHECKING:
    from hilplant.recording.tables import Add, Columns

TOPIC = "hilplant"


@contextmanager
def mcap_table(path: Path, units: Mapping[str, str]) -> Iterator["Add"]:
    """Write a file in place; each row is one message, at its time since the run's start; NaN becomes null."""
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="hilplant")
        channel = 0

        def add(columns: "Columns") -> None:
            nonlocal channel
            names = list(columns)[1:]
            if not channel:
                schema = writer.register_schema("hilplant.Row", "jsonschema", _schema(names, units))
                channel = writer.register_channel(TOPIC, "json", schema)
            times_s, *values = (column.tolist() for column in columns.values())
            for time_s, *row in zip(times_s, *values, strict=True):
                time_ns = round(time_s * SECOND_NS)
                data = to_json(dict(zip(names, row, strict=True)), inf_nan_mode="null")
                writer.add_message(channel, time_ns, data, time_ns)

        yield add
        writer.finish()  # type: ignore[no-untyped-call]


def _schema(names: list[str], units: Mapping[str, str]) -> bytes:
    properties = {name: {"type": "number", "description": f"[{units.get(name, '') or '1'}]"} for name in names}
    return json.dumps({"type": "object", "title": "hilplant.Row", "properties": properties}).encode()
