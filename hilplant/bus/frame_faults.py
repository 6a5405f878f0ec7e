"""What can happen to frames between a node and the bus: lost, late, doubled, with wrong data, or none at all."""

from hilplant.bus.frame import Frame
from hilplant.bus.frame_fault import FrameFault, Passing


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
