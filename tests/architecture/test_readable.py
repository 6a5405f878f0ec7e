"""What keeps the sources readable and the shipped parameter sets sourced."""

import ast
import re
from pathlib import Path
from typing import Any

from hilplant.checked_yaml.checksummed import flaw

MOST_LINES = 260
MOST_FUNCTION_LINES = 45
BANNED = {"utils", "util", "manager", "handler", "process", "helper", "helpers", "misc", "common"}
STATUSES = {"measured", "identified", "published", "assumed"}
#: Folders of config/ whose files are parameter sets.
PARAMETER_SETS = ("motors", "linkages", "screens", "measurements", "profiles", "controllers")
#: Folders of config/ whose files say what to do, not what a thing is like.
DESCRIPTIONS = ("benches", "scenarios", "tests")
#: Folder of config/ whose files a command has written, each with a seal.
TRAINED = "surrogates"


def test_no_file_is_too_long_to_read(sources: list[Any], root: Path) -> None:
    files = [source.path for source in sources] + sorted((root / "tests").rglob("*.py"))
    long = {str(path.relative_to(root)) for path in files if len(path.read_text().splitlines()) > MOST_LINES}
    assert not long, f"more than {MOST_LINES} lines: {sorted(long)}"


def test_no_function_is_too_long_to_see_at_once(sources: list[Any]) -> None:
    long = [
        f"{source.name}: {node.name}"
        for source in sources
        for node in ast.walk(source.tree)
        if isinstance(node, ast.FunctionDef) and _lines_without_docstring(node) > MOST_FUNCTION_LINES
    ]
    assert not long, f"more than {MOST_FUNCTION_LINES} lines: {long}"


def _lines_without_docstring(node: ast.FunctionDef) -> int:
    docstring = ast.get_docstring(node, clean=False)
    lines = (node.end_lineno or node.lineno) - node.lineno
    return lines - (docstring.count("\n") + 1 if docstring else 0)


def test_a_type_of_arrays_has_one_name_for_all_rooms(sources: list[Any]) -> None:
    wrong = [
        f"{source.name}:{node.lineno}"
        for source in sources
        if source.name != "arrays.py"
        for node in source.tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.value).startswith("NDArray[")
    ]
    assert not wrong, f"belongs into arrays.py: {wrong}"


def test_no_class_name_stands_twice(sources: list[Any]) -> None:
    found: dict[str, list[str]] = {}
    for source in sources:
        for node in source.tree.body:
            if isinstance(node, ast.ClassDef):
                found.setdefault(node.name, []).append(source.name)
    twice = {name: files for name, files in found.items() if len(files) > 1}
    assert not twice, twice


def test_no_file_class_or_function_has_a_name_that_says_nothing(sources: list[Any]) -> None:
    named = [(source.name, source.path.stem) for source in sources]
    for source in sources:
        for node in ast.walk(source.tree):
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                named.append((source.name, node.name))
    wrong = [f"{file}: {name}" for file, name in named if _words(name) & BANNED]
    assert not wrong, "\n".join(wrong)


def _words(name: str) -> set[str]:
    """Split a name; `in_its_own_process` may say process, `process` or `ProcessManager` may not."""
    words = re.findall(r"[a-z]+|[A-Z][a-z]*", name)
    lowered = {word.lower() for word in words}
    return lowered if len(words) == 1 else lowered - {"process"}


def test_every_shipped_parameter_set_has_source_and_status(root: Path) -> None:
    for folder in PARAMETER_SETS:
        for path in sorted((root / "config" / folder).glob("*.yaml")):
            text = path.read_text(encoding="utf-8")
            assert re.search(r"^source: *\S", text, re.MULTILINE), f"{path.name}: no source"
            status = re.search(r"^status: *(\w+)", text, re.MULTILINE)
            assert status and status.group(1) in STATUSES, f"{path.name}: status is one of {sorted(STATUSES)}"


def test_every_folder_of_the_configuration_is_known_here(root: Path) -> None:
    folders = {path.name for path in (root / "config").iterdir() if path.is_dir()}
    assert folders <= {*PARAMETER_SETS, *DESCRIPTIONS, TRAINED, "schemas"}


def test_every_shipped_trained_file_is_as_its_command_has_written_it(root: Path) -> None:
    files = sorted((root / "config" / TRAINED).glob("*.yaml"))
    assert files
    for path in files:
        text = path.read_text(encoding="utf-8")
        assert flaw(text, text.splitlines()[0].removeprefix("format: ")) == "", path.name


def test_both_shipped_folders_are_in_the_wheel(root: Path) -> None:
    project = (root / "pyproject.toml").read_text(encoding="utf-8")
    for folder in ("config", "dbc"):
        assert f'"{folder}" = "hilplant/{folder}"' in project
