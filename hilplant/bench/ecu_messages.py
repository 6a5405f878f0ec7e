"""The ECU's own messages in a bench: the stalk that it hears, and what it tells of itself."""

from dataclasses import dataclass

from hilplant.bench.bus import Bus, MessageBuilder
from hilplant.bench.ecu_description import EcuSettings
from hilplant.bench.mapping import MappedMessage
from hilplant.bus.codec import MappingError, ReceivedMessage, SentMessage, Timing, sent_message
from hilplant.checked_yaml.spot import Spot
from hilplant.signals import ECU_RX, ECU_STATUS, ECU_TX, STALK
from hilplant.units import MILLISECOND_NS

#: How often the stalk is told where its database states no cycle time.
_STALK_PERIOD_MS = 100.0


@dataclass(frozen=True, slots=True)
class EcuMessages:
    """Messages with indices into ``signals.ECU_RX`` and ``signals.ECU_TX``.

    `driver` are those of the `stalk` as its own side sends them, without those that can be received only.
    """

    stalk: tuple[ReceivedMessage, ...] = ()
    status: tuple[SentMessage, ...] = ()
    driver: tuple[SentMessage, ...] = ()


def build_ecu_messages(spot: Spot, ecu: EcuSettings, bus: Bus) -> EcuMessages:
    """Build what is sound of the ECU's own messages; everything else is noted."""
    if bus.database is None:
        return EcuMessages()
    heard = MessageBuilder(bus.database, ECU_RX, len(ECU_RX) - len(STALK))
    said = MessageBuilder(bus.database, ECU_TX, len(ECU_TX) - len(ECU_STATUS))
    received = [heard.received(spot.inner("receive", name), entry) for name, entry in (ecu.receive or {}).items()]
    sent = [said.sent(spot.inner("send", name), entry) for name, entry in (ecu.send or {}).items()]
    stalk, status = [pair[1] for pair in received if pair], [pair[1] for pair in sent if pair]
    _refuse_the_plants(spot, bus, [*stalk, *status])
    driver = [message for pair in received if pair and (message := _of_the_driver(pair[0]))]
    return EcuMessages(tuple(stalk), tuple(status), tuple(driver))


def _of_the_driver(mapped: MappedMessage) -> SentMessage | None:
    watched = tuple(mapping.plant_signal for mapping in mapped.mappings)
    timing = Timing(round((mapped.message.cycle_time or _STALK_PERIOD_MS) * MILLISECOND_NS), 0, watched)
    try:
        return sent_message(mapped.message, mapped.mappings, ECU_RX, timing, mapped.protection)
    except MappingError:
        return None


def _refuse_the_plants(ecu: Spot, bus: Bus, own: list[ReceivedMessage | SentMessage]) -> None:
    """Refuse identifiers that the plant's mapping has, or that occur twice."""
    plants: list[ReceivedMessage | SentMessage] = [*bus.receive, *bus.send]
    taken = {(message.identifier, message.extended): message.name for message in plants}
    for message in own:
        key = (message.identifier, message.extended)
        if key in taken:
            text = f"{message.name} has the identifier 0x{message.identifier:x} of {taken[key]}; map one of them"
            ecu.note(text=text)
        taken.setdefault(key, message.name)
