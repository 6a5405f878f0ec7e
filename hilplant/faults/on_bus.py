"""Faults of the bus, bound to a bench: which frames, which bits, which protection; and whether each is there now."""

from collections.abc import Mapping, Sequence
from random import Random
from typing import TYPE_CHECKING, Any, Protocol

from hilplant.bus.bits import places
from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.bus.database import database_among
from hilplant.bus.faulty_transport import PlacedFault
from hilplant.bus.frame_fault import FrameTarget
from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure
from hilplant.faults.timing import Course, Inserted

if TYPE_CHECKING:
    from collections.abc import Iterator


class BusSide(Protocol):
    """What a bench says about its messages."""

    @property
    def receive(self) -> tuple[ReceivedMessage, ...]:
        """Messages that the plant hears."""

    @property
    def send(self) -> tuple[SentMessage, ...]:
        """Messages that the plant sends."""

    @property
    def sources(self) -> Mapping[str, str]:
        """Texts of the bench's files, the database among them."""


def placed_faults(courses: Sequence[Course], bench: BusSide) -> list[PlacedFault]:
    """Return the faults of the bus among these, for a transport; Failure for what the bench does not have."""
    return [placed for course in courses if course.inserted.fault.on_frames for placed in _placed(course, bench)]


def _placed(course: Course, bench: BusSide) -> "Iterator[PlacedFault]":
    inserted = course.inserted
    inserted.fault.check_about(inserted.about)
    received = {message.name: message for message in bench.receive}
    sent = {message.name: message for message in bench.send}
    name, outgoing = inserted.about.message, inserted.about.direction == "from plant"
    if name is not None:
        if name not in received and name not in sent:
            raise _wrong(
                inserted, f"the plant neither hears nor sends a message '{name}'{suggestion(name, received | sent)}"
            )
        if inserted.about.direction is not None and outgoing is not (name in sent):
            raise _wrong(inserted, f"the plant does not {'send' if outgoing else 'hear'} {name}")
        outgoing = name in sent
    ours: Mapping[str, Any] = sent if outgoing else received
    whole_node = inserted.fault.on_frames is not None and inserted.fault.on_frames.whole_node
    chosen = {} if whole_node else ours if name is None else {name: ours[name]}
    for each in chosen.values():
        target = FrameTarget(each.identifier, each.extended, each.protection, *_written(inserted, bench))
        yield _made(course, target, outgoing, each.name)
    if name is None:
        keys = frozenset((each.identifier, each.extended) for each in chosen.values())
        yield _made(course, FrameTarget(), outgoing, "", keys)


def _made(
    course: Course, target: FrameTarget, outgoing: bool, name: str, others: frozenset[tuple[int, bool]] = frozenset()
) -> PlacedFault:
    inserted = course.inserted
    kind = inserted.fault.on_frames
    if kind is None:
        raise AssertionError(f"{inserted.fault.name} is none of the bus")
    if "protection" in inserted.fault.about and target.protection is None:
        raise _wrong(inserted, f"{name} has no protection in this bench, so that it has no counter and no checksum")
    effect = kind(target, inserted.values, Random(f"{inserted.seed} {name}"))
    return PlacedFault(effect, outgoing, lambda: course.level > 0.0, others)


def _written(inserted: Inserted, bench: BusSide) -> tuple[tuple[int, ...], int | None]:
    """Return the bits that a fault writes and what it writes there."""
    about = inserted.about
    if about.signal is None or about.message is None:
        return (), None
    database = database_among(bench.sources)
    if database is None:
        raise _wrong(inserted, "the bench has no database")
    message = database.get_message_by_name(about.message)
    signals = {signal.name: signal for signal in message.signals}
    if about.signal not in signals:
        raise _wrong(inserted, f"{about.message} has no signal '{about.signal}'{suggestion(about.signal, signals)}")
    signal = signals[about.signal]
    bits = tuple(places(signal))
    if about.value is None:
        return bits, None
    try:
        data = message.encode(
            {other.name: other.initial or 0 for other in message.signals} | {about.signal: about.value}, strict=False
        )
    except Exception as error:  # cantools raises its own kinds, struct's, and KeyError
        raise _wrong(inserted, f"{about.signal} cannot be {about.value:g}: {error}") from error
    whole = int.from_bytes(data, "little")
    return bits, sum((whole >> place & 1) << bit for bit, place in enumerate(bits))


def _wrong(inserted: Inserted, text: str) -> Failure:
    return Failure(": ".join(part for part in (inserted.place, f"fault '{inserted.fault.name}'", text) if part))
