"""The bus by message: how often each comes, how evenly, what it carries, and how old it is."""

from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from hilplant.bench import Bench
from hilplant.bus.database import database_among
from hilplant.runtime.follower import Follower
from hilplant.runtime.frame_slot import ERROR, EXTENDED, REMOTE, SENT
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: The last periods of a message of which mean and jitter are told.
MOST_PERIODS = 200
#: Identifier, whether it is extended, whether the plant sent it.
FrameKey = tuple[int, bool, bool]


@dataclass
class Heard:
    """What is known of one identifier in one direction."""

    count: int = 0
    time_ns: int = 0
    data: bytes = b""
    flags: int = 0
    periods_ns: deque[int] = field(default_factory=lambda: deque(maxlen=MOST_PERIODS))

    def take(self, time_ns: int, data: bytes, flags: int) -> None:
        """Take a frame."""
        if self.count:
            self.periods_ns.append(time_ns - self.time_ns)
        self.count, self.time_ns, self.data, self.flags = self.count + 1, time_ns, data, flags


class FrameTable:
    """All frames of a run by identifier and direction; the bench's database names and decodes them."""

    def __init__(self, bench: Bench) -> None:
        """Begin without a frame."""
        database = database_among(bench.sources)
        messages = database.messages if database is not None else []
        self._messages = {(message.frame_id, message.is_extended_frame): message for message in messages}
        self._timeouts = {(each.identifier, each.extended): each.timeout_ns for each in bench.receive}
        status = bench.description.ecu.send or {}
        links = [link for entry in status.values() for link in entry.signals.items()]
        self._status = {signal: each.signal for signal, entries in links for each in entries}
        self.heard: dict[FrameKey, Heard] = {}

    def rows(self, now_s: float) -> list[dict[str, Any]]:
        """Return a row for each message, in the order of direction and identifier."""
        return [self._row(key, self.heard[key], now_s) for key in sorted(self.heard, key=lambda key: (key[2], key))]

    def ecu(self) -> dict[str, float]:
        """Return what the ECU has told last of itself, by the names of ``signals.ECU_STATUS``."""
        told: dict[str, float] = {}
        for (identifier, extended, _), heard in self.heard.items():
            values = self._decoded(self._messages.get((identifier, extended)), heard.data, labels=False)
            told |= {self._status[name]: float(value) for name, value in values.items() if name in self._status}
        return told

    def _row(self, key: FrameKey, heard: Heard, now_s: float) -> dict[str, Any]:
        identifier, extended, sent = key
        message = self._messages.get((identifier, extended))
        periods = np.array(heard.periods_ns, np.float64) / MILLISECOND_NS
        return {
            "id": f"{identifier:0{8 if extended else 3}X}",
            "name": message.name if message is not None else "",
            "from": "plant" if sent else "bus",
            "count": heard.count,
            "period_ms": float(np.mean(periods)) if len(periods) else None,
            "jitter_ms": float(np.max(periods) - np.min(periods)) if len(periods) else None,
            "age_s": now_s - heard.time_ns / SECOND_NS,
            "timeout_s": self._timeouts.get((identifier, extended), 0) / SECOND_NS,
            "raw": heard.data.hex(" "),
            "kind": "error" if heard.flags & ERROR else "remote" if heard.flags & REMOTE else "",
            "values": {name: _shown(value) for name, value in self._decoded(message, heard.data).items()},
        }

    def _decoded(self, message: Any, data: bytes, labels: bool = True) -> dict[str, Any]:
        if message is None:
            return {}
        try:
            found: dict[str, Any] = message.decode(data, decode_choices=labels, allow_truncated=True)
        except Exception:  # cantools raises its own kinds, and those of what it is made of
            return {}
        return found


class LiveFrames(FrameTable):
    """The frames of a run that goes on."""

    def __init__(self, ring: str, bench: Bench) -> None:
        """Follow a run from now on."""
        super().__init__(bench)
        self._follower = Follower(ring)
        self.lost = 0

    def look(self) -> None:
        """Take in what is new."""
        taken = self._follower.frames()
        self.lost += taken.lost
        for frame in taken.records:
            _, time_ns, identifier, flags, length, _, data = frame.item()
            key = (identifier, bool(flags & EXTENDED), bool(flags & SENT))
            content = np.asarray(data, np.uint8)[:length].tobytes()
            self.heard.setdefault(key, Heard()).take(time_ns, content, flags)


def _shown(value: Any) -> Any:
    return value if isinstance(value, int | float) else str(value)
