"""The JSON Schemas: fresh, followed by every shipped file, and strict enough to refuse mistakes without hilplant."""

import json
from pathlib import Path
from typing import Any

import check_jsonschema
import pytest
from click.testing import CliRunner, Result

from hilplant.resources import shipped
from hilplant.signals import INPUTS, PUBLISHED
from hilplant.simulation.schema import KINDS, file_name, schema_text

SCHEMAS = shipped("config", "schemas")
FOLDERS = {kind: shipped("config", f"{kind}{'es' if kind == 'bench' else 's'}") for kind in KINDS if kind != "ecu"}
TWENTY = Path(__file__).parents[1] / "data" / "benches" / "twenty_mistakes"


def validated(kind: str, *files: Path) -> Result:
    return CliRunner().invoke(check_jsonschema.main, ["--schemafile", str(SCHEMAS / file_name(kind)), *map(str, files)])


def keys_of(schema: Any) -> dict[str, Any]:
    """Return every key that a schema describes, the last of each name."""
    found: dict[str, Any] = {}
    for inner in schema.values() if isinstance(schema, dict) else schema if isinstance(schema, list) else ():
        found |= keys_of(inner)
    if isinstance(schema, dict) and isinstance(schema.get("properties"), dict):
        found |= {key: described for key, described in schema["properties"].items() if isinstance(described, dict)}
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_the_committed_schema_is_the_one_that_the_descriptions_give(kind: str) -> None:
    renew = f"hilplant schema {kind} > config/schemas/{file_name(kind)}"
    assert (SCHEMAS / file_name(kind)).read_text(encoding="utf-8") == schema_text(kind), f"out of date; run: {renew}"


@pytest.mark.parametrize(("kind", "folder"), [*FOLDERS.items(), ("scenario", shipped("config", "tests"))])
def test_every_shipped_file_names_its_schema_and_follows_it(kind: str, folder: Path) -> None:
    files = sorted(folder.glob("*.yaml"))
    assert files
    for file in files:
        first = file.read_text(encoding="utf-8").splitlines()[0]
        assert first == f"# yaml-language-server: $schema=../schemas/{file_name(kind)}", file
    done = validated(kind, *files)
    assert done.exit_code == 0, done.output


def test_the_bench_with_twenty_mistakes_is_refused_and_so_is_its_motor() -> None:
    done = validated("bench", TWENTY / "bench.yaml")
    assert done.exit_code == 1
    for words in ("window_deg", "crank_angle_rad", "soaked", "profile", "pause"):
        assert words in done.output
    assert validated("motor", TWENTY / "motor.yaml").exit_code == 1


@pytest.mark.parametrize(
    ("text", "right"),
    [
        ("extends: default.yaml\nname: x\n", True),
        ("extends: default.yaml\nplant: {load: {model: none}}\n", True),
        ("name: x\nplant: {load: {model: none}}\n", False),
        ("extends: default.yaml\nplant: {load: {model: non}}\n", False),
        ("extends: default.yaml\nplant: {blades: {left: {force_n: 1}}}\n", False),
        ("extends: default.yaml\nbus: {receive: {A: {signals: {B: relay_on}}}}\n", True),
        ("extends: default.yaml\nbus: {receive: {A: {signals: {B: current_a}}}}\n", False),
        ("extends: default.yaml\nbus: {send: {A: {signals: {B: {signal: current_a, scale: 2}}}}}\n", True),
        ("extends: default.yaml\ninputs: {relay_on: on}\n", False),
    ],
)
def test_a_bench_that_extends_another_needs_only_what_differs(tmp_path: Path, text: str, right: bool) -> None:
    (tmp_path / "bench.yaml").write_text(text)
    assert validated("bench", tmp_path / "bench.yaml").exit_code == (0 if right else 1)


@pytest.mark.parametrize("kind", KINDS)
def test_every_key_has_words_and_every_number_with_a_unit_tells_it(kind: str) -> None:
    schema = json.loads(schema_text(kind))
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    assert schema["$id"] == f"urn:hilplant:schema:{kind}:{KINDS[kind][1]}"
    for key, described in keys_of(schema["properties"]).items():
        assert described.get("description"), key
    units = {"resistance_ohm": "ohm", "window_deg": "deg", "inertia_kg_m2": "kg m2", "supply_v": "V", "mass_kg": "kg"}
    for key, described in keys_of(schema).items():
        assert described.get("x-unit") == units.get(key, described.get("x-unit")), key


def test_signals_are_offered_by_name() -> None:
    bus = json.loads(schema_text("bench"))["properties"]["bus"]["properties"]
    for direction, signals in (("receive", INPUTS), ("send", PUBLISHED)):
        name = bus[direction]["additionalProperties"]["properties"]["signals"]["additionalProperties"]["anyOf"][0]
        assert name["enum"] == [signal.name for signal in signals]
