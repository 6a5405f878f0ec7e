"""CAN frames of a log -> channels, through a bus database or through the mapping of a bench."""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.failure import Failure
from hilplant.measurements.measurement import Channel

#: Gives the values in a payload by the names of their channels; raises ValueError for a payload it cannot read.
Reads = Callable[[bytes], Iterable[tuple[str, float]]]
Key = tuple[int, bool]  # identifier, extended


def read_can_log(path: Path, database: Path | None, bench: str | None) -> dict[str, Channel]:
    """Read the signals of every known frame of a log; each channel has the times of its own frames.

    Raises
    ------
    Failure
        Without a database and without a bench, or when no frame of the log is in them.

    """
    from hilplant.recording.frame_logs import logged_messages

    if database is None and bench is None:
        raise Failure(f"{path}: frames need a database or a bench with a mapping: --frames FILE.dbc or --frames BENCH")
    readers, units = _by_database(database) if database is not None else _by_bench(str(bench))
    times: dict[str, list[float]] = defaultdict(list)
    values: dict[str, list[float]] = defaultdict(list)
    wrong = 0
    for message in logged_messages(path):
        read = readers.get((message.arbitration_id, message.is_extended_id))
        if read is None or message.is_error_frame or message.is_remote_frame:
            continue
        try:
            found = list(read(bytes(message.data)))
        except ValueError:
            wrong += 1
            continue
        for name, value in found:
            times[name].append(message.timestamp)
            values[name].append(value)
    if wrong:
        raise Failure(f"{path}: {wrong} frames are shorter than the database says; is it the right database?")
    if not times:
        raise Failure(f"{path}: none of its frames is in {database or bench}; is it the right one?")
    start_s = min(stamps[0] for stamps in times.values())
    return {
        name: Channel(np.array(times[name]) - start_s, np.array(values[name]), units.get(name, ""), held=True)
        for name in times
    }


def _by_database(path: Path) -> tuple[dict[Key, Reads], dict[str, str]]:
    from hilplant.bus.database import load_database

    readers: dict[Key, Reads] = {}
    units: dict[str, str] = {}
    for message in load_database(path).messages:
        readers[message.frame_id, message.is_extended_frame] = _database_reader(message)
        units.update({f"{message.name}.{signal.name}": signal.unit or "" for signal in message.signals})
    return readers, units


def _database_reader(message: Any) -> Reads:
    def read(data: bytes) -> Iterable[tuple[str, float]]:
        try:
            decoded: Mapping[str, Any] = message.decode(data, decode_choices=False)
        except Exception as error:  # cantools and bitstruct have errors of their own
            raise ValueError(str(error)) from error
        return [(f"{message.name}.{name}", float(value)) for name, value in decoded.items()]

    return read


def _by_bench(name: str) -> tuple[dict[Key, Reads], dict[str, str]]:
    """Read what the plant sends and is sent; an output comes before an input of the same name."""
    from hilplant.bench import load_bench
    from hilplant.signals import ECU_HEARD, INPUTS

    bench = load_bench(name)
    readers: dict[Key, Reads] = {}
    for messages, signals in ((bench.ecu_side().receive, ECU_HEARD), (bench.receive, INPUTS)):
        for message in messages:
            names = tuple(signals[index].name for index in message.targets)
            readers.setdefault((message.identifier, message.extended), _bench_reader(message, names))
    return readers, {signal.name: signal.unit for signal in (*ECU_HEARD, *INPUTS)}


def _bench_reader(message: Any, names: tuple[str, ...]) -> Reads:
    def read(data: bytes) -> Iterable[tuple[str, float]]:
        if len(data) != message.length:
            raise ValueError(f"{message.name} has {len(data)} bytes")
        return [(name, value) for name, value in zip(names, message.decode(data), strict=True) if value is not None]

    return read
