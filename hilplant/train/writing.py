"""Trained files as text: YAML that a reader can follow, sealed, the same bytes for the same numbers."""

import hashlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.atomic_write import write_text
from hilplant.checked_yaml.checksummed import seal


def sealed_text(content: Mapping[str, Any]) -> str:
    """Return a trained file's text; its first key must be `format`."""
    return seal("".join(_lines(key, value, "") for key, value in content.items()))


def write_file(path: Path, content: Mapping[str, Any]) -> None:
    """Write a trained file; see :func:`sealed_text`."""
    write_text(path, sealed_text(content))


def data_hash(*arrays: Floats) -> str:
    """Return the hash of training data, to nine digits of the largest number of each array."""
    digest = hashlib.sha256()
    for array in arrays:
        largest = float(np.abs(array).max()) or 1.0
        digest.update(np.round(array / largest, 9).astype(np.float32).tobytes())
    return digest.hexdigest()


def _lines(key: str, value: Any, indent: str) -> str:
    if isinstance(value, Mapping):
        return f"{indent}{key}:\n" + "".join(_lines(inner, part, indent + "  ") for inner, part in value.items())
    if isinstance(value, list) and value and isinstance(value[0], list):
        return f"{indent}{key}:\n" + "".join(f"{indent}  - {_flow(row)}\n" for row in value)
    return f"{indent}{key}: {_flow(value)}\n"


def _flow(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_flow(item) for item in value)}]"
    return repr(float(value)) if isinstance(value, float) else str(value)
