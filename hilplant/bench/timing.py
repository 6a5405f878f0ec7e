"""When messages come and go: from the bench where it says so, else from the cycle times of the database."""

from collections.abc import Sequence
from typing import Any

from hilplant.bench.bus_description import ReceivedEntry, SentEntry
from hilplant.bus.codec import Timing
from hilplant.checked_yaml.problems import suggestion
from hilplant.checked_yaml.spot import Spot
from hilplant.declaration import Signal
from hilplant.units import MILLISECOND_NS

#: A message that is supervised may stay away for so many cycle times, when nothing else is said.
CYCLES_UNTIL_LOST = 10


def timeout_ns(spot: Spot, message: Any, entry: ReceivedEntry, usual_ms: float | None = None) -> int:
    """Return after how long without it a message counts as lost; 0 for a message that nobody supervises.

    `usual_ms` is the bench's, for what has neither a timeout nor a cycle time.
    """
    cycle_ms = message.cycle_time or 0
    by_itself_ms = CYCLES_UNTIL_LOST * cycle_ms if cycle_ms else usual_ms or 0.0
    timeout_ms = by_itself_ms if entry.timeout_ms is None else entry.timeout_ms
    if entry.timeout_ms is None and not cycle_ms and usual_ms is None:
        text = f"timeout_ms is missing: the database gives {message.name} no cycle time; 0 is unsupervised"
        spot.note(text=f"{text}; bus.timeout_ms is for all")
    if 0.0 < timeout_ms <= cycle_ms:
        text = f"timeout_ms must be longer than the message's cycle time of {cycle_ms} ms, not {timeout_ms:g}"
        spot.note("timeout_ms", text=text)
    if entry.protection is not None and not timeout_ms:
        text = "a protected message needs a timeout_ms: after a loss, its counter is taken as it comes only then"
        spot.note("timeout_ms", text=text)
    return round(timeout_ms * MILLISECOND_NS)


def sending(spot: Spot, message: Any, entry: SentEntry, step_ns: int, signals: Sequence[Signal]) -> Timing:
    """Return when a message of some of these signals is sent."""
    period_ms = float(message.cycle_time or 0) if entry.period_ms is None else entry.period_ms
    period_ns = round(period_ms * MILLISECOND_NS)
    if not period_ns and not entry.on_change:
        text = f"period_ms or on_change is missing: the database gives {message.name} no cycle time"
        spot.note(text=text)
    if period_ns % step_ns:
        text = f"period_ms must be a multiple of the step of {step_ns / MILLISECOND_NS:g} ms, not {period_ms:g}"
        spot.note("period_ms", text=text)
    if period_ns and entry.offset_ms >= period_ms:
        text = f"offset_ms must be below the period of {period_ms:g} ms, not {entry.offset_ms:g}"
        spot.note("offset_ms", text=text)
    watched = _watched(spot, entry, [signal.name for signal in signals])
    return Timing(period_ns, round(entry.offset_ms * MILLISECOND_NS), watched)


def _watched(spot: Spot, entry: SentEntry, known: Sequence[str]) -> tuple[str, ...]:
    for name in entry.on_change:
        if name not in known:
            text = f"the plant has no signal '{name}' here{suggestion(name, known)}"
            spot.note("on_change", text=text)
    return tuple(name for name in entry.on_change if name in known)
