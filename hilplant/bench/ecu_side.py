"""The bus as the stand-in ECU sees it: the plant's mapping, read the other way."""

from collections.abc import Sequence
from dataclasses import dataclass

from hilplant.bench.description import EcuSettings
from hilplant.bench.mapping import MappedMessage
from hilplant.bench.timing import CYCLES_UNTIL_LOST
from hilplant.bus.codec import ReceivedMessage, SentMessage, Timing, received_message, sent_message
from hilplant.signals import INPUTS, PUBLISHED
from hilplant.units import MILLISECOND_NS


@dataclass(frozen=True, slots=True)
class EcuSide:
    """Messages that the ECU receives, into ``signals.PUBLISHED``, and sends, out of ``signals.INPUTS``."""

    receive: tuple[ReceivedMessage, ...]
    send: tuple[SentMessage, ...]


def build_ecu_side(
    commands: Sequence[MappedMessage], reports: Sequence[MappedMessage], settings: EcuSettings
) -> EcuSide:
    """Build what the ECU sends from the plant's `commands`, and what it receives from the plant's `reports`.

    Raises
    ------
    MappingError
        When a mapping only works in the plant's direction.

    """
    return EcuSide(tuple(map(_received, reports)), tuple(_sent(mapped, settings) for mapped in commands))


def _received(mapped: MappedMessage) -> ReceivedMessage:
    timeout_ns = CYCLES_UNTIL_LOST * round((mapped.message.cycle_time or 0) * MILLISECOND_NS)
    return received_message(mapped.message, mapped.mappings, PUBLISHED, timeout_ns, mapped.protection)


def _sent(mapped: MappedMessage, settings: EcuSettings) -> SentMessage:
    """Send at each change and at the database's cycle time; where it states none, in every ECU period."""
    watched = tuple(mapping.plant_signal for mapping in mapped.mappings)
    period_ms = mapped.message.cycle_time or settings.period_ms
    timing = Timing(round(period_ms * MILLISECOND_NS), 0, watched)
    return sent_message(mapped.message, mapped.mappings, INPUTS, timing, mapped.protection)
