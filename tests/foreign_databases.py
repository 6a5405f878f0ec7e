"""Every signal of a folder's bus databases through our codec and cantools', both ways; the counts must agree.

`python tests/foreign_databases.py FOLDER` walks DBC, ARXML, KCD and SYM files, such as `tests/files` of the sources of
cantools, and exits with 1 when a value or a byte differs.
"""

import math
import random
import sys
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from cantools.database import DecodeError

from hilplant.bench.bus_description import FrameEntry
from hilplant.bench.mapping import framed
from hilplant.bus.bits import raw_range
from hilplant.bus.codec import MappingError, SignalMapping, Timing, received_message, sent_message
from hilplant.bus.database import DatabaseError, load_sound
from hilplant.checked_yaml.spot import Spot
from hilplant.declaration import Signal

ENDINGS = {".dbc", ".arxml", ".kcd", ".sym"}
FRAMES, TRIES = 20, 2000


def compare(folder: Path, say: Callable[[str], None] = print) -> Counter[str]:
    """Return how many files, messages and signals were compared, refused, and differ."""
    counts: Counter[str] = Counter()
    for path in sorted(path for path in folder.rglob("*") if path.suffix.lower() in ENDINGS):
        try:
            database, left_out = load_sound(path)
        except DatabaseError as error:
            counts["files refused"] += 1
            say(str(error)[:200])
            continue
        counts["files"] += 1
        counts["entries left out"] += len(left_out)
        for message in database.messages:
            counts["messages"] += 1
            names = Counter(signal.name for signal in message.signals)
            for signal in message.signals:
                if names[signal.name] > 1:
                    counts["signals refused: two of a name"] += 1
                    continue
                counts[_signal(path, message, signal, say)] += 1
    return counts


def _signal(path: Path, message: Any, signal: Any, say: Callable[[str], None]) -> str:
    """Compare one signal on random frames; return what became of it."""
    plant = (Signal("x", "", -math.inf, math.inf, "any number"),)
    mapping = [SignalMapping(signal.name, "x")]
    try:
        padded = framed(Spot(), message, FrameEntry())
        received = received_message(padded, mapping, plant)
    except MappingError as error:
        return f"signals refused: {_kind(str(error))}"
    rng = random.Random(f"{message.name}.{signal.name}")
    where = f"{path.name} {message.name}.{signal.name}"
    frames = _frames(message, rng)
    if not frames:
        return "signals refused by cantools in every frame"
    for payload in frames:
        ours, cantools = received.decode(payload.ljust(padded.length, b"\0"))[0], _decoded(message, signal, payload)
        if not _same(ours, cantools):
            say(f"{where}: {ours} from {payload.hex()}, cantools {cantools}")
            return "signals that differ in decoding"
    try:
        sent = sent_message(padded, mapping, plant, Timing(0))
    except MappingError:
        return "signals decoded alike, received only"
    lowest, highest = raw_range(signal)
    for _ in range(FRAMES):
        raw = (
            rng.uniform(max(lowest, -1e3), min(highest, 1e3))
            if signal.is_float
            else rng.randint(int(lowest), int(highest))
        )
        value = float(signal.conversion.raw_to_scaled(raw, decode_choices=False))
        frame, limited = sent.encode([value])
        back = received.decode(frame)[0]
        if limited or not _same(back, value, exact=not signal.is_float):
            say(f"{where}: {value} comes back as {back}, {limited} limited")
            return "signals that differ in encoding"
    return "signals alike in both directions"


def _decoded(message: Any, signal: Any, payload: bytes) -> float | None:
    """Return cantools' value; None where the signal's page is not in the frame."""
    value = message.decode_simple(payload, decode_choices=False).get(signal.name)
    return None if value is None else float(value)


def _frames(message: Any, rng: random.Random) -> list[bytes]:
    """Return random frames; cantools refuses those whose multiplexer has a value without a page, we do not."""
    found: list[bytes] = []
    for _ in range(TRIES):
        payload = rng.randbytes(message.length)
        with suppress(DecodeError):
            message.decode_simple(payload, decode_choices=False)
            found.append(payload)
        if len(found) == FRAMES:
            break
    return found


def _same(one: float | None, other: float | None, exact: bool = True) -> bool:
    if one is None or other is None:
        return one is other
    if math.isnan(one) or math.isnan(other):
        return math.isnan(one) and math.isnan(other)
    return one == other or (not exact and math.isclose(one, other, rel_tol=1e-3, abs_tol=1e-3))


def _kind(text: str) -> str:
    return text.split(": ", 1)[1][:60]


if __name__ == "__main__":
    found = compare(Path(sys.argv[1]))
    for what, count in sorted(found.items()):
        print(f"{count:7d} {what}")
    raise SystemExit(any("differ" in what for what in found))
