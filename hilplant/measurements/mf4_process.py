"""The process that reads MF4 with asammdf: `python -m ...mf4_process FILE channels|frames OUT.npz`."""

import contextlib
import re
import resource
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.bus.frame_layout import CLASSIC_BYTES, FD_LENGTHS

#: Memory that the process may have: this, and so many times the file [byte].
MEMORY, MEMORY_PER_BYTE = 4 << 30, 50
_FRAMES = "CAN_DataFrame"
#: The names of bus logging; any other name is that of a signal.
_BUS_LOGGING = re.compile(r"CAN_(Data|Remote|Error|Overload)Frame(\..*)?")
#: The bit of an identifier that says 29 bits, where a file has no IDE of its own.
_EXTENDED = 1 << 31


def main() -> None:
    """Write what was asked for; an error is one line and exit code 1."""
    path, what, out = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    sys.unraisablehook = lambda _: None  # asammdf's files that were never opened fail once more as they are deleted
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
        if _BUS_LOGGING.fullmatch(channel.name):
            frames = True
            continue
        signal = file.get(group=group, index=place, raw=True)
        texts = _texts(signal.conversion, file.version)
        values = _numbers(signal.samples, signal.conversion, texts)
        if values.dtype.kind not in "biuf" or values.ndim != 1 or not len(values):
            continue
        shown = [name for name, kind in (signal.display_names or {}).items() if kind == "message"]
        name = shown[0] if shown else signal.name
        same = sum(known == name or known.startswith(f"{name}#") for known in names)
        arrays[f"time{len(names)}"] = np.asarray(signal.timestamps, np.float64)
        arrays[f"values{len(names)}"] = values.astype(np.float64)
        names.append(f"{name}#{same + 1}" if same else name)
        units.append(signal.unit or "")
        held.append(texts == "words")
    return arrays | {"names": np.array(names, str), "units": np.array(units, str), "held": held, "frames": frames}


def _places(file: Any) -> list[tuple[int, int, Any]]:
    return [
        (number, place, channel)
        for number, group in enumerate(file.groups)
        for place, channel in enumerate(group.channels)
        if file.masters_db.get(number) != place
    ]


def _texts(conversion: Any, version: str) -> str:
    """Return what texts of a table are: "words" for raw numbers, "gaps" in numbers of another scale, "" for none."""
    tables = (7, 8) if version >= "4" else (11, 12)  # value to text, range of values to text
    if conversion is None or conversion.conversion_type not in tables:
        return ""
    others = (conversion.referenced_blocks or {}).values()
    return "gaps" if any(_scales(other, version) for other in others) else "words"


def _scales(other: Any, version: str) -> bool:
    """Say whether what stands in a table for some raw numbers makes other numbers of them."""
    if other is None or isinstance(other, bytes):
        return version < "4" and b"{X}" in (other or b"")  # a formula: the default of a table in MDF 3
    if texts := _texts(other, version):
        return texts == "gaps"
    raw = np.array([0.0, 1.0, 2.0, 1000.0])
    return not np.array_equal(other.convert(raw), raw)


def _numbers(raw: Any, conversion: Any, texts: str) -> Any:
    """Return the numbers of a channel; a text among scaled numbers is NaN: its raw number is none of that scale."""
    if conversion is None:
        return raw
    values = conversion.convert(raw, ignore_value2text_conversions=texts != "gaps")
    return np.full(len(raw), np.nan) if texts == "gaps" and values.dtype.kind not in "biuf" else values


def _frames(file: Any) -> dict[str, Any]:
    parts: dict[str, list[Any]] = {name: [] for name in ("time", "identifier", "extended", "length", "channel", "data")}
    groups = {
        number: names
        for number, group in enumerate(file.groups)
        if {f"{_FRAMES}.DataBytes", f"{_FRAMES}.ID"} <= (names := {channel.name for channel in group.channels})
    }
    buses = _buses(file, [number for number, names in groups.items() if f"{_FRAMES}.BusChannel" not in names])
    for number, names in groups.items():

        def column(name: str, names: set[str] = names, number: int = number) -> Any:
            full = f"{_FRAMES}.{name}"
            return file.get(full, group=number, raw=True).samples.astype(np.int64) if full in names else None

        identifiers = file.get(f"{_FRAMES}.ID", group=number, raw=True)
        ids = identifiers.samples.astype(np.int64)
        extended, channel = column("IDE"), column("BusChannel")
        data = np.atleast_2d(file.get(f"{_FRAMES}.DataBytes", group=number, raw=True).samples)
        wide = np.zeros((len(ids), 64), np.uint8)
        wide[:, : min(64, data.shape[1])] = data[:, :64]
        values = (
            identifiers.timestamps, ids & 0x1FFFFFFF, (ids & _EXTENDED) != 0 if extended is None else extended,
            np.clip(_lengths(column, len(ids), data.shape[1]), 0, 64),
            np.full(len(ids), buses[number]) if channel is None else channel.astype(str), wide,
        )  # fmt: skip
        for name, value in zip(parts, values, strict=True):
            parts[name].append(value)
    empty = {"data": np.zeros((0, 64), np.uint8)}
    arrays = {name: np.concatenate(each) if each else empty.get(name, np.zeros(0)) for name, each in parts.items()}
    order = np.argsort(arrays["time"], kind="stable")
    return {name: values[order] for name, values in arrays.items()}


def _lengths(column: Callable[[str], Any], count: int, width: int) -> Any:
    """Return the bytes of each frame: as the file says them, else by its DLC."""
    said, codes, fd = column("DataLength"), column("DLC"), column("EDL")
    if said is not None or codes is None:
        return np.full(count, width) if said is None else said
    if (wrong := codes[(codes < 0) | (codes > 15)]).size:
        raise ValueError(f"{_FRAMES}.DLC holds {wrong[0]}, which is none (0 to 15), and there is no DataLength")
    long = np.array(FD_LENGTHS)[codes]
    classic = np.minimum(codes, CLASSIC_BYTES)
    return np.minimum(long if fd is None else np.where(fd != 0, long, classic), width)


def _buses(file: Any, numbers: list[int]) -> dict[int, str]:
    """Return what the bus of each group is called where the frames do not say it: by the source that tells them apart.

    Groups of one source are of one bus; those of no source may be of several. "CAN 2" is channel 2.
    """
    sources = {number: _source(file.groups[number]) for number in numbers}
    known = sorted(set(sources.values()))
    telling = next((texts for texts in zip(*known, strict=True) if all(texts) and len(set(texts)) == len(known)), None)
    names = telling or [" ".join(filter(None, texts)) for texts in known]
    short = [re.sub(r"^CAN[ _-]?0*(?=\d+$)", "", name, flags=re.IGNORECASE) for name in names]
    called = dict(zip(known, short if len(set(short)) == len(known) else names, strict=True))
    return {number: called[source] or f"group{number}" for number, source in sources.items()}


def _source(group: Any) -> tuple[str, str, str]:
    """Return path and name of the source of a group of frames, and the name of its acquisition."""
    frames = next((channel for channel in group.channels if channel.name == _FRAMES), None)
    source = getattr(group.channel_group, "acq_source", None) or (frames and frames.source)
    acquisition = getattr(group.channel_group, "acq_name", "") or ""
    return (source.path or "", source.name or "", acquisition) if source else ("", "", acquisition)


if __name__ == "__main__":
    main()
