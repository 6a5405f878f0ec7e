"""The bus as the stand-in ECU sees it: the plant's mapping, read the other way."""

from collections.abc import Sequence
from dataclasses import dataclass

from hilplant.bench.ecu_messages import EcuMessages
from hilplant.bench.mapping import MappedMessage
from hilplant.bench.timing import CYCLES_UNTIL_LOST
from hilplant.bus.codec import MappingError, ReceivedMessage, SentMessage, Timing, received_message, sent_message
from hilplant.checked_yaml.spot import Spot
from hilplant.signals import ECU_RX, ECU_TX, INPUTS, WANTED
from hilplant.units import MILLISECOND_NS

#: Any period serves where nothing but the mapping is examined.
ECU_PERIOD_MS = 5.0


@dataclass(frozen=True, slots=True)
class EcuSide:
    """Messages that the ECU receives, into ``signals.ECU_RX``, and sends, out of ``signals.ECU_TX``.

    `receive` come from the plant and `send` go to it; `stalk` and `status` are between the ECU and its driver;
    `reference` are those commands that carry a wanted speed, which a velocity controller hears as the plant does.
    """

    receive: tuple[ReceivedMessage, ...]
    send: tuple[SentMessage, ...]
    stalk: tuple[ReceivedMessage, ...]
    status: tuple[SentMessage, ...]
    reference: tuple[ReceivedMessage, ...] = ()


def build_ecu_side(
    commands: Sequence[MappedMessage],
    reports: Sequence[tuple[MappedMessage, int]],
    period_ms: float,
    own: EcuMessages,
) -> EcuSide:
    """Build what the ECU sends from the plant's `commands`, and what it receives from the plant's `reports`.

    Beside each report is the period [ns] at which the plant sends it; after ten of them it counts as lost.
    `period_ms` is how often the ECU decides, `own` are its messages that have nothing to do with the plant. A command
    that only works in the plant's direction, such as a multiplexed one, is left out unless it has a relay.

    Raises
    ------
    MappingError
        When the command of a relay only works in the plant's direction: `note_one_way` has said so.

    """
    received = tuple(_received(mapped, period_ns) for mapped, period_ns in reports)
    sent = [_sent(mapped, period_ms) for mapped in commands if _commands_relay(mapped) or _can_be_sent(mapped)]
    return EcuSide(received, tuple(sent), own.stalk, own.status)


def heard_references(
    commands: Sequence[MappedMessage], as_plant: Sequence[ReceivedMessage]
) -> tuple[ReceivedMessage, ...]:
    """Build those `commands` that carry a wanted speed, with nothing else of them; timeouts are the plant's."""
    timeouts_ns = {message.name: message.timeout_ns for message in as_plant}
    found = []
    for mapped in commands:
        wanted = [mapping for mapping in mapped.mappings if mapping.plant_signal == INPUTS[WANTED].name]
        if wanted:
            timeout_ns = timeouts_ns[mapped.message.name]
            found.append(received_message(mapped.message, wanted, ECU_RX, timeout_ns, mapped.protection))
    return tuple(found)


def note_one_way(spot: Spot, commands: Sequence[MappedMessage]) -> None:
    """Note as warnings at the bus's spot which commands only work in the plant's direction."""
    for mapped in commands:
        try:
            _sent(mapped, ECU_PERIOD_MS)
        except MappingError as error:
            spot.warn("receive", mapped.message.name, text=f"the simulated ECU cannot send it: {error}")


def _commands_relay(mapped: MappedMessage) -> bool:
    return any(mapping.plant_signal in ("relay_on", "relay_fast") for mapping in mapped.mappings)


def _can_be_sent(mapped: MappedMessage) -> bool:
    try:
        sent_message(mapped.message, mapped.mappings, ECU_TX, Timing(0))
    except MappingError:
        return False
    return True


def _received(mapped: MappedMessage, period_ns: int) -> ReceivedMessage:
    timeout_ns = CYCLES_UNTIL_LOST * period_ns
    return received_message(mapped.message, mapped.mappings, ECU_RX, timeout_ns, mapped.protection)


def _sent(mapped: MappedMessage, ecu_period_ms: float) -> SentMessage:
    """Send at each change and at the database's cycle time; where it states none, in every ECU period."""
    watched = tuple(mapping.plant_signal for mapping in mapped.mappings)
    period_ms = mapped.message.cycle_time or ecu_period_ms
    timing = Timing(round(period_ms * MILLISECOND_NS), 0, watched)
    return sent_message(mapped.message, mapped.mappings, ECU_TX, timing, mapped.protection)
