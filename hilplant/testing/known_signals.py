"""What expectations may name: the plant's signals, and the messages and signals of a bench's database."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from hilplant.bench import Bench
from hilplant.bus.database import database_among
from hilplant.bus.protection import Protection
from hilplant.declaration import Signal
from hilplant.signals import INPUTS, OUTPUTS, STATUS
from hilplant.verdicts.known import Known, KnownMessage, KnownSignal


@dataclass(frozen=True)
class DatabaseSignals:
    """The messages of a bench's database by name, the signals by each name that they have, and who is protected."""

    messages: Mapping[str, Any]
    signals: Mapping[str, tuple[Any, Any]]
    protections: Mapping[str, Protection]

    def known(self, step_s: float, seconds: float, marks: Mapping[str, float]) -> Known:
        """Return all that can be named in a run of this length; a plant's signal goes before the database's."""
        signals = {name: _database_signal(signal) for name, (_, signal) in self.signals.items()}
        signals |= {signal.name: _plant_signal(signal) for signal in (*STATUS, *INPUTS, *OUTPUTS)}
        messages = {
            name: KnownMessage(float(message.cycle_time or 0.0), name in self.protections)
            for name, message in self.messages.items()
        }
        return Known(step_s, seconds, signals, messages, marks)


def database_signals(sources: Mapping[str, str], protections: Mapping[str, Protection]) -> DatabaseSignals:
    """Return what the database among a bench's files has; a signal is also known as `Message.Signal`."""
    database = database_among(sources)
    messages = {message.name: message for message in database.messages} if database is not None else {}
    pairs = [(message, signal) for message in messages.values() for signal in message.signals]
    count = Counter(signal.name for _, signal in pairs)
    named = {f"{message.name}.{signal.name}": (message, signal) for message, signal in pairs}
    named |= {signal.name: (message, signal) for message, signal in pairs if count[signal.name] == 1}
    return DatabaseSignals(messages, named, protections)


def protections_of(bench: Bench) -> dict[str, Protection]:
    """Return the protections of a bench's messages by their names."""
    return {message.name: message.protection for message in _messages(bench) if message.protection is not None}


def _messages(bench: Bench) -> Iterable[Any]:
    return (*bench.receive, *bench.send, *bench.ecu_messages.stalk, *bench.ecu_messages.status)


def _plant_signal(signal: Signal) -> KnownSignal:
    labels = {label: float(number) for number, label in enumerate(signal.choices)} | dict(signal.names)
    if signal.kind == "flag":
        labels = {"off": 0.0, "on": 1.0}
    return KnownSignal(signal.unit, signal.kind != "real", labels)


def _database_signal(signal: Any) -> KnownSignal:
    labels = {str(label): float(number) for number, label in (signal.choices or {}).items()}
    labels = {label: number * float(signal.scale) + float(signal.offset) for label, number in labels.items()}
    whole = not signal.is_float and float(signal.scale).is_integer() and float(signal.offset).is_integer()
    return KnownSignal(signal.unit or "", whole, labels)
