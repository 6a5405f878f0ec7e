"""What a recording says about its run: configuration and versions, exact to the last bit."""

import base64
import json
import platform
import secrets
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hilplant import __version__
from hilplant.arrays import Floats
from hilplant.recording.elements import FORMAT_1, ROWS, Elements, adopted_row, elements_of
from hilplant.recording.recorded_bench import RecordedBench

FORMAT_VERSION = "3"
_AT_THE_START = {"first_tick": "0", "first_ns": "0"}


@dataclass(frozen=True)
class RunDescription:
    """The metadata of a recording."""

    name: str
    step_ns: int
    parameter_row: Floats
    tables: Floats
    state_row: Floats
    sources: dict[str, str]
    start_utc: datetime  # when the recorder was ready; the first tick follows within the loop's start-up
    build: dict[str, str]  # versions of everything that the outputs' bits depend on
    elements: Mapping[str, Elements]  # of what was recorded, by the keys of `elements.ROWS`
    series: str  # the same in all parts of one run, and in no other
    part: int  # counted from 1
    first_tick: int  # of this part; `state_row` is the state before it
    first_ns: int  # when that tick was due, from the loop's start
    pace: float = 1.0  # seconds of the plant in a second of the clock


def current_build() -> dict[str, str]:
    """Name everything here that the bits of an output depend on."""
    from hilplant.jit import MODELS_HASH  # brings the compiler, which a reader does without

    versions = {name: _version(name) for name in ("numpy", "numba", "llvmlite")}
    return {
        "models_hash": MODELS_HASH,
        "python": platform.python_version(),
        "cpu": _cpu(),
        "hilplant": __version__,
        **versions,
    }


def describe(bench: RecordedBench, start_utc: datetime) -> dict[str, str]:
    """Return the metadata of a run of `bench`, as texts by key."""
    texts = {
        "format": FORMAT_VERSION,
        "name": bench.name,
        "step_ns": str(bench.step_ns),
        "pace": str(bench.pace),
        "parameter_row": _encode(bench.parameter_row),
        "tables": _encode(bench.tables),
        "state_row": _encode(bench.state_row),
        "sources": json.dumps(dict(bench.sources)),
        "start_utc": start_utc.astimezone(UTC).isoformat(),
        "build": json.dumps(current_build()),
        "elements": json.dumps({key: elements_of(record) for key, record in ROWS.items()}),
        "series": secrets.token_hex(8),
        "part": "1",
        **_AT_THE_START,
    }
    return texts | {"crc32": _checksum(texts)}


class Begin(NamedTuple):
    """Where a part begins: its first tick, when that was due [ns], the state before it, the parameters in it."""

    tick: int
    due_ns: int
    state_row: Floats
    parameter_row: Floats


def part_description(metadata: dict[str, str], part: int, begin: Begin) -> dict[str, str]:
    """Return the metadata of a part of the same run that does not begin with the run."""
    first = {"first_tick": str(begin.tick), "first_ns": str(begin.due_ns)}
    rows = {"state_row": _encode(begin.state_row), "parameter_row": _encode(begin.parameter_row)}
    changes = {"part": str(part), **first, **rows}
    texts = {key: text for key, text in (metadata | changes).items() if key != "crc32"}
    return texts | {"crc32": _checksum(texts)}


def parameters_of(metadata: dict[str, str]) -> Floats:
    """Return the packed parameters of a description."""
    return _decode(metadata["parameter_row"]).copy()


def parse(metadata: dict[str, str]) -> RunDescription:
    """Read back what :func:`describe` has written, the rows in today's order.

    Raises
    ------
    ForeignElement
        When this version cannot take the rows.
    KeyError, ValueError
        When something is missing, unreadable or changed.
    """
    texts = {key: text for key, text in metadata.items() if key != "crc32"}
    if metadata["crc32"] != _checksum(texts):
        raise ValueError("it fails its checksum")
    if metadata["format"] == "1":  # which knew neither names nor parts
        elements, metadata = FORMAT_1, {"series": texts["start_utc"], "part": "1", **_AT_THE_START, **metadata}
    else:
        elements = json.loads(metadata["elements"])
    parameter_row, state_row = (
        adopted_row(_decode(metadata[key]), elements[key], ROWS[key]) for key in ("parameter_row", "state_row")
    )
    return RunDescription(
        name=metadata["name"],
        step_ns=int(metadata["step_ns"]),
        parameter_row=parameter_row,
        tables=_decode(metadata["tables"]),
        state_row=state_row,
        sources=json.loads(metadata["sources"]),
        start_utc=datetime.fromisoformat(metadata["start_utc"]),
        build=json.loads(metadata["build"]),
        elements=elements,
        series=metadata["series"],
        part=int(metadata["part"]),
        first_tick=int(metadata["first_tick"]),
        first_ns=int(metadata["first_ns"]),
        pace=float(metadata.get("pace", "1")),
    )


def _checksum(texts: dict[str, str]) -> str:
    """CRC-32 over keys and texts, so that a description which was damaged does not pass for the recorded one."""
    return f"{zlib.crc32(json.dumps(texts, sort_keys=True).encode()):08x}"


def _encode(values: Floats) -> str:
    """Shape and little-endian float64 bytes, as text."""
    exact = np.ascontiguousarray(values, dtype="<f8")
    return json.dumps({"shape": exact.shape, "float64": base64.b64encode(exact.tobytes()).decode()})


def _decode(text: str) -> Floats:
    stored = json.loads(text)
    values = np.frombuffer(base64.b64decode(stored["float64"]), dtype="<f8")
    return values.reshape(stored["shape"]).astype(np.float64)


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _cpu() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    except OSError:
        lines = []
    named = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return named[0] if named else platform.processor() or platform.machine()
