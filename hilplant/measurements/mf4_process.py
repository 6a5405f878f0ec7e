"""The process that reads MF4 with asammdf: `python -m ...mf4_process FILE channels|frames OUT.npz`."""

import contextlib
import resource
import sys
from pathlib import Path
from typing import Any

import numpy as np

#: Memory that the process may have: this, and so many times the file [byte].
MEMORY, MEMORY_PER_BYTE = 4 << 30, 50
_FRAMES = "CAN_DataFrame"
#: The bit of an identifier that says 29 bits, where a file has no IDE of its own.
_EXTENDED = 1 << 31


def main() -> None:
    """Write what was asked for; an error is one line and exit code 1."""
    path, what, out = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    limit = MEMORY + MEMORY_PER_BYTE * path.stat().st_size
    with contextlib.suppress(ValueError, OSError):
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    try:
        from asammdf import MDF

        with MDF(path) as file:
            np.savez(out, **(_frames(file) if what == "frames" else _channels(file)))
    except BaseException as error:
        sys.stderr.write("\n" + (" ".join(str(error).split()) or type(error).__name__))
        raise SystemExit(1) from None


def _channels(file: Any) -> dict[str, Any]:
    names: list[str] = []
    arrays: dict[str, Any] = {}
    units, held, frames = [], [], False
    for group, place, channel in _places(file):
        frames = frames or channel.name.startswith("CAN_")
        signal = file.get(group=group, index=place, raw=True)
        conversion = signal.conversion
        values = signal.samples
        if conversion is not None:
            values = conversion.convert(values, ignore_value2text_conversions=True)
        if values.dtype.kind not in "biuf" or values.ndim != 1 or not len(values) or channel.name.startswith("CAN_"):
            continue
        shown = [name for name, kind in (signal.display_names or {}).items() if kind == "message"]
        name = shown[0] if shown else signal.name
        same = sum(known == name or known.startswith(f"{name}#") for known in names)
        arrays[f"time{len(names)}"] = np.asarray(signal.timestamps, np.float64)
        arrays[f"values{len(names)}"] = values.astype(np.float64)
        names.append(f"{name}#{same + 1}" if same else name)
        units.append(signal.unit or "")
        held.append(_has_texts(conversion))
    return arrays | {"names": np.array(names, str), "units": np.array(units, str), "held": held, "frames": frames}


def _places(file: Any) -> list[tuple[int, int, Any]]:
    return [
        (number, place, channel)
        for number, group in enumerate(file.groups)
        for place, channel in enumerate(group.channels)
        if file.masters_db.get(number) != place
    ]


def _has_texts(conversion: Any) -> bool:
    return conversion is not None and conversion.conversion_type in (7, 8)  # value to text, value range to text


def _frames(file: Any) -> dict[str, Any]:
    parts: dict[str, list[Any]] = {name: [] for name in ("time", "identifier", "extended", "length", "channel", "data")}
    for number, group in enumerate(file.groups):
        names = {channel.name for channel in group.channels}
        if f"{_FRAMES}.DataBytes" not in names or f"{_FRAMES}.ID" not in names:
            continue
        identifiers = file.get(f"{_FRAMES}.ID", group=number, raw=True)
        data = np.atleast_2d(file.get(f"{_FRAMES}.DataBytes", group=number, raw=True).samples)
        count = len(identifiers.samples)
        wide = np.zeros((count, 64), np.uint8)
        wide[:, : min(64, data.shape[1])] = data[:, :64]
        ids = identifiers.samples.astype(np.int64)

        def column(name: str, other: Any, names: set[str] = names, number: int = number) -> Any:
            full = f"{_FRAMES}.{name}"
            return file.get(full, group=number, raw=True).samples.astype(np.int64) if full in names else other

        lengths = column("DataLength", column("DLC", np.full(count, data.shape[1])))
        values = (
            identifiers.timestamps, ids & 0x1FFFFFFF, column("IDE", (ids & _EXTENDED) != 0), np.clip(lengths, 0, 64),
            column("BusChannel", np.zeros(count, np.int64)), wide,
        )  # fmt: skip
        for name, value in zip(parts, values, strict=True):
            parts[name].append(value)
    empty = {"data": np.zeros((0, 64), np.uint8)}
    arrays = {name: np.concatenate(each) if each else empty.get(name, np.zeros(0)) for name, each in parts.items()}
    order = np.argsort(arrays["time"], kind="stable")
    return {name: values[order] for name, values in arrays.items()}


if __name__ == "__main__":
    main()
