"""What reads a frame: the messages of a bus database, or those of a bench, by identifier or by J1939 group."""

from collections import Counter
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from hilplant.bus.j1939 import BROADCAST, parameter_group
from hilplant.failure import Failure
from hilplant.measurements.frames import FrameSource, LoggedFrame

#: Gives the values in a payload by the names of their signals; raises ValueError for a payload it cannot read.
Reads = Callable[[bytes], Iterable[tuple[str, float]]]
Key = tuple[int, bool]  # identifier, extended


class Reader(NamedTuple):
    """A message: what it is called, how it is read, and the units of its signals; `prefix` stands before each name."""

    message: str
    read: Reads
    units: dict[str, str]
    prefix: str = ""

    def named(self, name: str) -> str:
        """Return the name of a signal as a channel."""
        return f"{self.prefix}.{name}" if self.prefix else name


class Readers:
    """Readers by identifier; a J1939 message also by its parameter group, from any sender."""

    def __init__(self) -> None:
        self.exact: dict[Key, list[Reader]] = {}
        self.groups: dict[int, list[Reader]] = {}
        self.found: dict[Key, Reader | None] = {}

    def add(self, key: Key, reader: Reader, j1939: bool = False) -> None:
        """Add a reader of frames with this identifier."""
        self.exact.setdefault(key, []).append(reader)
        if j1939 and key[1]:
            self.groups.setdefault(parameter_group(key[0]), []).append(reader)

    def of(self, frame: LoggedFrame) -> Reader | None:
        """Return what reads a frame, None where nothing does.

        Raises
        ------
        Failure
            When two messages have its identifier.

        """
        key = frame.identifier, frame.extended
        if key not in self.found:
            self.found[key] = self._find(key)
        return self.found[key]

    def _find(self, key: Key) -> Reader | None:
        identifier, extended = key
        readers = self.exact.get(key, [])
        group = self.groups.get(parameter_group(identifier), []) if extended and not readers else []
        if len(readers) > 1 or len(group) > 1:
            both = " and ".join(reader.message for reader in readers or group)
            raise Failure(f"identifier 0x{identifier:X} is that of {both}; leave one of them in the database")
        if group and not group[0].prefix:
            self._refuse_second_sender(identifier, group[0])
            return group[0]
        if group:
            sender = f"{identifier & 0xFF:02X}"
            if (identifier >> 16) & 0xFF < BROADCAST:
                sender += f"to{(identifier >> 8) & 0xFF:02X}"
            return group[0]._replace(prefix=f"{group[0].prefix}@{sender}")
        return readers[0] if readers else None

    def _refuse_second_sender(self, identifier: int, reader: Reader) -> None:
        """Refuse one signal of the plant from two senders: its values would be mixed."""
        for (other, _), found in self.found.items():
            if found is reader:
                both = f"0x{other:X} and 0x{identifier:X}"
                raise Failure(f"{reader.message} comes from two senders, {both}; take --frames FILE.dbc")


def readers_of(source: FrameSource) -> Readers:
    """Return the readers of a database or of a bench."""
    return _by_database(source) if source.database is not None else _by_bench(str(source.bench))


def _by_database(source: FrameSource) -> Readers:
    from hilplant.bus.database import load_database

    readers = Readers()
    messages = load_database(str(source.database)).messages
    times = Counter(message.name for message in messages)
    for message in messages:
        name = message.name if times[message.name] == 1 else f"{message.name}#{message.frame_id:X}"
        units = {signal.name: signal.unit or "" for signal in message.signals}
        key = message.frame_id, message.is_extended_frame
        readers.add(key, Reader(name, _database_reads(message), units, name), message.protocol == "j1939")
    return readers


def _database_reads(message: Any) -> Reads:
    def read(data: bytes) -> Iterable[tuple[str, float]]:
        try:
            decoded = message.decode(data, decode_choices=False, decode_containers=message.is_container)
        except Exception as error:  # cantools and bitstruct have errors of their own
            raise ValueError(" ".join(str(error).split()) or type(error).__name__) from error
        if not message.is_container:
            return [(name, float(value)) for name, value in decoded.items()]
        inner = [(part, values) for part, values in decoded if isinstance(values, dict)]
        return [(f"{part.name}.{name}", float(value)) for part, values in inner for name, value in values.items()]

    return read


def _by_bench(name: str) -> Readers:
    """Read what the plant sends and is sent; an output comes before an input of the same name."""
    from hilplant.bench import load_bench
    from hilplant.signals import ECU_RX, INPUTS

    bench = load_bench(name)
    readers = Readers()
    for messages, signals in ((bench.ecu_side().receive, ECU_RX), (bench.receive, INPUTS)):
        units = {signal.name: signal.unit for signal in signals}
        for message in messages:
            key = message.identifier, message.extended
            names = tuple(signals[index].name for index in message.targets)
            if key not in readers.exact:
                readers.add(key, Reader(message.name, _bench_reads(message, names), units), message.j1939)
    return readers


def _bench_reads(message: Any, names: tuple[str, ...]) -> Reads:
    def read(data: bytes) -> Iterable[tuple[str, float]]:
        if len(data) != message.length:
            raise ValueError(f"has {len(data)} bytes, not {message.length}")
        return [(name, value) for name, value in zip(names, message.decode(data), strict=True) if value is not None]

    return read
