"""What can happen to frames between a node and the bus; each is one fault of one message, or of all that a node sends.

A fault sees every frame that it is about, also while it is not there: it may need what came last. It answers with the
frames that pass, each with the delay after which it does. Time comes in as an argument, chance from a seed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from random import Random

from hilplant.bus.frame import Frame
from hilplant.bus.protection import Forger, Protection

#: A frame, and how long after now it passes [ns].
Passing = list[tuple[Frame, int]]
Quantities = Mapping[str, float]


@dataclass(frozen=True, slots=True)
class FrameTarget:
    """What a fault is about: a message (`identifier` None: every frame), its protection, a signal's bits to be written.

    `places` are the bits of the signal, the least significant first, and `raw` what is written there; None: all ones.
    """

    identifier: int | None = None
    extended: bool = False
    protection: Protection | None = None
    places: tuple[int, ...] = ()
    raw: int | None = None

    def takes(self, frame: Frame) -> bool:
        """Say whether a frame is meant."""
        return self.identifier is None or (frame.identifier, frame.extended) == (self.identifier, self.extended)


class FrameFault:
    """A fault that changes nothing: what all of them share."""

    #: Whether the node is off the bus: it neither sends nor hears.
    cuts_off = False
    #: Whether one effect serves all messages of a node; else each message has one, with its own protection.
    whole_node = False

    def __init__(self, target: FrameTarget, quantities: Quantities, random: Random) -> None:
        self.target, self._quantities, self._random = target, quantities, random
        self._forger = Forger(target.protection) if target.protection is not None else None
        self._last: Frame | None = None
        self._present = False

    @property
    def spent(self) -> bool:
        """Whether nothing is left to be done once it is over."""
        return True

    def passing(self, frame: Frame, now_ns: int, present: bool) -> Passing:
        """Return what becomes of a frame that it is about."""
        begins, self._present = present and not self._present, present
        if begins:
            self._begin(frame)
        passing = self._change(frame, now_ns) if present else self._spare(frame)
        self._last = frame
        return passing

    def own(self, now_ns: int, present: bool) -> list[Frame]:
        """Return frames that it sends of its own accord."""
        return []

    def _begin(self, frame: Frame) -> None:
        """Prepare for the first frame that it is there for."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(frame, 0)]

    def _spare(self, frame: Frame) -> Passing:
        return [(frame, 0)]

    def _delay_ns(self) -> int:
        return round(self._quantities["time_s"] * 1e9)

    def _with_counter(self, frame: Frame, counter: Callable[[Forger, int], int]) -> Frame:
        """Return a frame with another counter, signed anew; as it is where it is not protected, or too short."""
        protection = self.target.protection
        if self._forger is None or protection is None or len(frame.data) != protection.length:
            return frame
        number = counter(self._forger, self._forger.counter(frame.data))
        return frame._replace(data=self._forger.signed(frame.data, number))

    def _with_data(self, frame: Frame, data: bytes) -> Frame:
        """Return a frame with other data and its own counter, signed anew where it is protected."""
        own = None if self._forger is None else self._forger.counter(frame.data)
        changed = frame._replace(data=data)
        return changed if own is None else self._with_counter(changed, lambda _forger, _counter: own)


class Dropped(FrameFault):
    """Lose a share of the frames."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [] if self._random.random() < self._quantities["share"] else [(frame, 0)]


class Delayed(FrameFault):
    """Hold each frame back for a time."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(frame, self._delay_ns())]


class Jittered(FrameFault):
    """Hold each frame back for a random time, in their order."""

    _earliest_ns = 0

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        self._earliest_ns = max(self._earliest_ns, now_ns + round(self._random.random() * self._delay_ns()))
        return [(frame, self._earliest_ns - now_ns)]


class Duplicated(FrameFault):
    """Let each frame come twice."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(frame, 0), (frame, self._delay_ns())]


class Reordered(FrameFault):
    """Let two frames change places, again and again."""

    _held: Frame | None = None

    @property
    def spent(self) -> bool:
        """Whether it holds no frame back."""
        return self._held is None

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        held, self._held = self._held, None
        if held is None:
            self._held = frame
            return []
        return [(frame, 0), (held, 0)]

    def _spare(self, frame: Frame) -> Passing:
        held, self._held = self._held, None
        return [(frame, 0)] if held is None else [(frame, 0), (held, 0)]


class Shortened(FrameFault):
    """Take bytes off the end."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(frame._replace(data=frame.data[: max(0, len(frame.data) - int(self._quantities["bytes"]))]), 0)]


class CounterStuck(FrameFault):
    """Let the counter stay where it was."""

    def _begin(self, frame: Frame) -> None:
        self._stays = (self._last or frame).data

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(self._with_counter(frame, lambda forger, _counter: forger.counter(self._stays)), 0)]


class CounterJumps(FrameFault):
    """Add a step to the counter."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        step = int(self._quantities["steps"])
        return [(self._with_counter(frame, lambda _forger, counter: counter + step), 0)]


class WrongChecksum(FrameFault):
    """Turn a bit of the checksum over."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(frame if self._forger is None else frame._replace(data=self._forger.corrupted(frame.data)), 0)]


class WrongValue(FrameFault):
    """Write a value into a signal, with the right checksum over it."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        target, whole = self.target, int.from_bytes(frame.data, "little")
        raw = -1 if target.raw is None else target.raw
        for bit, place in enumerate(target.places):
            whole = whole & ~(1 << place) | (raw >> bit & 1) << place
        if max(target.places) >= 8 * len(frame.data):
            return [(frame, 0)]
        return [(self._with_data(frame, whole.to_bytes(len(frame.data), "little")), 0)]


class Stale(FrameFault):
    """Repeat the data of the fault's begin, with a counter that goes on."""

    def _begin(self, frame: Frame) -> None:
        self._old = frame.data

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return [(self._with_data(frame, self._old), 0)]


class Paced(FrameFault):
    """Let the newest frame pass once in a period, whenever the node sends; the counter counts what passes."""

    _due_ns = 0
    _count = 0

    def _begin(self, frame: Frame) -> None:
        self._count = 0 if self._forger is None else self._forger.counter((self._last or frame).data)

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return []

    def own(self, now_ns: int, present: bool) -> list[Frame]:
        """Return the newest frame when it is due."""
        if not present or not self._present or self._last is None or now_ns < self._due_ns:
            return []
        self._due_ns = now_ns + self._delay_ns()
        self._count += 1
        return [self._with_counter(self._last, lambda _forger, _counter: self._count)]


class Babbling(FrameFault):
    """Send frames of one identifier in each tick."""

    whole_node = True

    def own(self, now_ns: int, present: bool) -> list[Frame]:
        """Return the frames of a tick."""
        if not present:
            return []
        count, identifier = int(self._quantities["frames"]), int(self._quantities["identifier"])
        return [Frame(identifier, bytes(8))] * count


class Silent(FrameFault):
    """Let nothing pass."""

    def _change(self, frame: Frame, now_ns: int) -> Passing:
        return []


class Restarted(Silent):
    """Let nothing pass; afterwards the counter begins at 0."""

    _silenced = False
    _offset: int | None = None

    @property
    def spent(self) -> bool:
        """Whether it has never been there: the counter stays another one for good."""
        return not self._silenced

    def _begin(self, frame: Frame) -> None:
        self._silenced, self._offset = True, None

    def _spare(self, frame: Frame) -> Passing:
        if not self._silenced:
            return [(frame, 0)]
        if self._offset is None and self._forger is not None:
            self._offset = self._forger.counter(frame.data)
        return [(self._with_counter(frame, lambda _forger, counter: counter - (self._offset or 0)), 0)]


class BusOff(Silent):
    """Take the node off the bus."""

    cuts_off = True
    whole_node = True
