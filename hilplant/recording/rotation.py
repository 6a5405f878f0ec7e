"""A recording in parts: when one ends and the next begins, what they are called, and how many are kept."""

import contextlib
import fcntl
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from hilplant.failure import Failure
from hilplant.units import SECOND_NS

_AMOUNT = re.compile(r"(\d+(?:\.\d+)?)\s*([a-zA-Z]+)")
_BYTES = {"kb": 1e3, "mb": 1e6, "gb": 1e9, "tb": 1e12}
_SECONDS = {"s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
_PART = re.compile(r"-(\d{4,})$")
#: A part smaller than this would hold little but the texts of the bench.
_SMALLEST_BYTES = 1_000_000


@dataclass(frozen=True, slots=True)
class Rotation:
    """The limits of a part, 0 where there is none: its bytes, the time [ns] it spans, how many parts are kept.

    `earlier` are parts of runs before this one, the oldest first, which count among those that are kept.
    """

    part_bytes: int = 0
    part_ns: int = 0
    keep: int = 0
    earlier: tuple[str, ...] = ()

    @property
    def in_parts(self) -> bool:
        """Whether there are parts at all."""
        return bool(self.part_bytes or self.part_ns)

    @classmethod
    def parse(cls, text: str | None, keep: int | None = None) -> "Rotation":
        """Read `100MB`, `1h` or both with a comma between.

        Raises
        ------
        Failure
            Saying what would be right.
        """
        found = {"part_bytes": 0, "part_ns": 0}
        for word in (text or "").split(",") if text is not None else ():
            amount = _AMOUNT.fullmatch(word.strip())
            unit = amount[2].lower() if amount else ""
            if amount is None or unit not in _BYTES | _SECONDS:
                known = ", ".join(["kB", "MB", "GB", "TB", *_SECONDS])
                raise Failure(
                    f"rotate: '{word.strip()}' is neither a size nor a time, such as 100MB or 1h; units: {known}"
                )
            if unit in _BYTES:
                found["part_bytes"] = round(float(amount[1]) * _BYTES[unit])
            else:
                found["part_ns"] = round(float(amount[1]) * _SECONDS[unit] * SECOND_NS)
        made = cls(found["part_bytes"], found["part_ns"], keep or 0)
        if text is not None and 0 < made.part_bytes < _SMALLEST_BYTES:
            raise Failure(f"rotate: a part has at least {_SMALLEST_BYTES // 1_000_000} MB")
        if text is not None and (made.part_ns < SECOND_NS and not made.part_bytes):
            raise Failure("rotate: a part has at least 1 s")
        if made.keep and not made.in_parts:
            raise Failure("keep: how many parts to keep says nothing without --rotate")
        return made

    @classmethod
    def from_json(cls, values: Mapping[str, Any]) -> "Rotation":
        """Build from what :func:`dataclasses.asdict` gave."""
        return cls(**{**values, "earlier": tuple(values["earlier"])})


def part_path(path: Path, number: int) -> Path:
    """Return the path of part `number`, counted from 1, of the recording `path`."""
    return path.with_name(f"{path.stem}-{number:04d}{path.suffix}")


def parts_of(path: Path) -> list[Path]:
    """Return the parts there are of the recording `path`, in their order."""
    numbered = []
    for found in path.parent.glob(f"{_literal(path.stem)}-*{_literal(path.suffix)}"):
        number = _PART.search(found.stem)
        if number is not None and found.stem[: number.start()] == path.stem and found.suffix == path.suffix:
            numbered.append((int(number[1]), found))
    return [found for _, found in sorted(numbered)]


def remove_part(path: Path) -> None:
    """Remove a part, unless it is gone, may not be removed, or somebody records to it."""
    with contextlib.suppress(OSError), path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        path.unlink()


def _literal(text: str) -> str:
    return re.sub(r"([*?\[])", r"[\1]", text)
