"""Messages of the database that a test sends, each repeated at its cycle time as an ECU would."""

from collections.abc import Mapping
from typing import Any

from hilplant.bus.frame import Frame
from hilplant.bus.protection import Protection, Protector
from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure
from hilplant.units import MILLISECOND_NS


class CyclicMessage:
    """A message with the values that it carries; those never given are the database's initial ones."""

    def __init__(self, message: Any, protection: Protection | None) -> None:
        self._message = message
        self._protector = Protector(protection) if protection is not None else None
        self._values: dict[str, Any] = {signal.name: _initial(signal) for signal in message.signals}
        self.period_ns = round(float(message.cycle_time or 0.0) * MILLISECOND_NS)
        self.due_ns = 0

    def change(self, values: Mapping[str, Any]) -> None:
        """Take new values: numbers in the signal's unit, labels of its value table, or true and false."""
        for name, value in values.items():
            if name not in self._values:
                text = f"{self._message.name} has no signal '{name}'{suggestion(name, self._values)}"
                raise Failure(text)
            self._values[name] = int(value) if isinstance(value, bool) else value

    def frame(self) -> Frame:
        """Return the frame with the next counter and checksum."""
        try:
            data = self._message.encode(self._values, strict=True)
        except Exception as error:  # cantools raises its own kinds, struct's, and KeyError
            raise Failure(f"{self._message.name} cannot carry this: {error}") from error
        if self._protector is not None:
            protected = bytearray(data)
            self._protector.protect(protected)
            data = bytes(protected)
        return Frame(self._message.frame_id, data, self._message.is_extended_frame, self._message.is_fd)


def _initial(signal: Any) -> Any:
    """Return the database's initial value; else 0, or the nearest to it that the signal may have."""
    if signal.initial is not None:
        return signal.initial
    lowest, highest = signal.minimum, signal.maximum
    return max(lowest if lowest is not None else 0, min(0, highest if highest is not None else 0))
