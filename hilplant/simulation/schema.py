"""The schemas of all kinds of files, as text."""

import json

from hilplant.bench import schema as bench_schema
from hilplant.checked_yaml.checked import Checked
from hilplant.simulation.scenario import ScenarioFile

KINDS: dict[str, tuple[type[Checked], int]] = {**bench_schema.KINDS, "scenario": (ScenarioFile, 1)}


def file_name(kind: str) -> str:
    """Return the name of the schema's file, with its version."""
    return f"{kind}-{KINDS[kind][1]}.json"


def schema_text(kind: str) -> str:
    """Return the schema of a kind of file as indented JSON."""
    model, version = KINDS[kind]
    return json.dumps(bench_schema.schema_of(kind, model, version), indent=1, ensure_ascii=False) + "\n"
