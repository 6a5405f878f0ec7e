"""The ECU's own messages in a bench: the stalk that it hears, and what it tells of itself."""

from collections.abc import Iterator
from dataclasses import dataclass

from hilplant.bench.bus import Bus, receive_entry, send_entry
from hilplant.bench.database import Database
from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.checked_yaml.place import Place
from hilplant.signals import ECU_HEARD, ECU_SAID, ECU_STATUS, STALK

_NO_STEP_NS = 1  # the ECU sends when it decides, so every period will do


@dataclass(frozen=True, slots=True)
class EcuMessages:
    """Messages with indices into ``signals.ECU_HEARD`` and ``signals.ECU_SAID``."""

    stalk: tuple[ReceivedMessage, ...] = ()
    status: tuple[SentMessage, ...] = ()


def assemble_ecu_messages(ecu: Place, bus: Bus) -> EcuMessages:
    """Build what is sound of the ECU's own messages; everything else is noted."""
    if bus.database is None:
        return EcuMessages()
    heard, said = len(ECU_HEARD) - len(STALK), len(ECU_SAID) - len(ECU_STATUS)
    stalk, status = [], []
    for place in _groups(ecu.inner("receive"), bus.database):
        if received := receive_entry(place, bus.database, ECU_HEARD, heard):
            stalk.append(received[1])
    for place in _groups(ecu.inner("send"), bus.database):
        if sent := send_entry(place, bus.database, ECU_SAID, _NO_STEP_NS, said):
            status.append(sent[1])
    _refuse_the_plants(ecu, bus, [*stalk, *status])
    return EcuMessages(tuple(stalk), tuple(status))


def _groups(messages: Place, database: Database) -> Iterator[Place]:
    """Return the groups under the names of messages, without those inherited for a database that is not used here."""
    data = messages.data()
    for name, group in data.items() if isinstance(data, dict) else ():
        place = messages.inner(name)
        inherited = place.document.place(place.location)[0] != place.document.file
        if isinstance(group, dict) and not (inherited and not database.has(name)):
            yield place


def _refuse_the_plants(ecu: Place, bus: Bus, own: list[ReceivedMessage | SentMessage]) -> None:
    """Refuse identifiers that the plant's mapping has, or that occur twice."""
    plants: list[ReceivedMessage | SentMessage] = [*bus.receive, *bus.send]
    taken = {(message.identifier, message.extended): message.name for message in plants}
    for message in own:
        key = (message.identifier, message.extended)
        if key in taken:
            text = f"{message.name} has the identifier 0x{message.identifier:x} of {taken[key]}; map one of them"
            ecu.note(text=text)
        taken.setdefault(key, message.name)
