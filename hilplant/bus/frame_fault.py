"""What faults of frames between a node and the bus share; each is about one message, or about all that a node sends.

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
