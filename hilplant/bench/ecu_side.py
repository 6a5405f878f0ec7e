"""The bus as the stand-in ECU sees it: the plant's mapping, read the other way."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from hilplant.bench.description import EcuSettings
from hilplant.bench.mapping import MappedMessage
from hilplant.bench.timing import CYCLES_UNTIL_LOST
from hilplant.bus.codec import MappingError, ReceivedMessage, SentMessage, Timing, received_message, sent_message
from hilplant.signals import INPUTS, PUBLISHED
from hilplant.units import MILLISECOND_NS


@dataclass(frozen=True, slots=True)
class EcuSide:
    """Messages that the ECU receives, into ``signals.PUBLISHED``, and sends, out of ``signals.INPUTS``."""

    receive: tuple[ReceivedMessage, ...]
    send: tuple[SentMessage, ...]


def build_ecu_side(
    commands: Sequence[MappedMessage],
    reports: Sequence[MappedMessage],
    periods_ns: Mapping[str, int],
    settings: EcuSettings,
) -> EcuSide:
    """Build what the ECU sends from the plant's `commands`, and what it receives from the plant's `reports`.

    `periods_ns` are those of the messages that the plant sends, by name; after ten of them one counts as lost.
    A command that only works in the plant's direction, such as a multiplexed one, is left out unless it has a relay.

    Raises
    ------
    MappingError
        When the command of a relay only works in the plant's direction.

    """
    heard = [mapped for mapped in reports if mapped.message.name in periods_ns]
    received = tuple(_received(mapped, periods_ns[mapped.message.name]) for mapped in heard)
    sent = [_sent(mapped, settings) for mapped in commands if _commands_relay(mapped) or _can_be_sent(mapped)]
    return EcuSide(received, tuple(sent))


def _commands_relay(mapped: MappedMessage) -> bool:
    return any(mapping.plant_signal in ("relay_on", "relay_fast") for mapping in mapped.mappings)


def _can_be_sent(mapped: MappedMessage) -> bool:
    try:
        sent_message(mapped.message, mapped.mappings, INPUTS, Timing(0))
    except MappingError:
        return False
    return True


def _received(mapped: MappedMessage, period_ns: int) -> ReceivedMessage:
    timeout_ns = CYCLES_UNTIL_LOST * period_ns
    return received_message(mapped.message, mapped.mappings, PUBLISHED, timeout_ns, mapped.protection)


def _sent(mapped: MappedMessage, settings: EcuSettings) -> SentMessage:
    """Send at each change and at the database's cycle time; where it states none, in every ECU period."""
    watched = tuple(mapping.plant_signal for mapping in mapped.mappings)
    period_ms = mapped.message.cycle_time or settings.period_ms
    timing = Timing(round(period_ms * MILLISECOND_NS), 0, watched)
    return sent_message(mapped.message, mapped.mappings, INPUTS, timing, mapped.protection)
