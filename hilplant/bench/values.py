"""Values of signals as people write them: `true` for a flag, a name for a choice, a number in its range or its name."""

from collections.abc import Mapping
from typing import Any

from hilplant.checked_yaml.problems import suggestion
from hilplant.declaration import Signal
from hilplant.signals import INPUT_INDEX, INPUTS


def signal_value(signal: Signal, written: Any) -> float:
    """Return the plant's number for a written value.

    Raises
    ------
    ValueError
        Saying what would be right.

    """
    if signal.kind == "choice" and isinstance(written, str):
        return _choice(signal, written)
    if signal.names and isinstance(written, str):
        return _named(signal, written)
    if signal.kind == "flag" and isinstance(written, bool):
        return float(written)
    if isinstance(written, bool) or not isinstance(written, int | float) or signal.kind in ("flag", "choice"):
        raise ValueError(f"{signal.name} must be {_wanted(signal)}, not {_shown(written)}")
    if not signal.minimum <= written <= signal.maximum:
        raise ValueError(f"{signal.name} must be {_wanted(signal)}, not {written}")
    return float(written)


def signal_values(written: Mapping[str, Any]) -> tuple[tuple[int, float], ...]:
    """Return index and value of inputs of the plant from their names and checked values."""
    return tuple((input_index(name), signal_value(INPUTS[input_index(name)], value)) for name, value in written.items())


def input_index(name: str) -> int:
    """Return the place of an input of the plant among the others."""
    if name not in INPUT_INDEX:
        raise ValueError(f"the plant has no input '{name}'{suggestion(name, INPUT_INDEX)}")
    return INPUT_INDEX[name]


def _choice(signal: Signal, written: str) -> float:
    if written not in signal.choices:
        raise ValueError(f"{signal.name} has no choice '{written}'{suggestion(written, signal.choices)}")
    return float(signal.choices.index(written))


def _named(signal: Signal, written: str) -> float:
    values = dict(signal.names)
    if written not in values:
        near = suggestion(written, values)
        question = near if near.endswith("?") else ""
        raise ValueError(f"{signal.name} must be {_wanted(signal)}, not {_shown(written)}{question}")
    return values[written]


def _wanted(signal: Signal) -> str:
    if signal.kind == "flag":
        return "true or false"
    if signal.kind == "choice":
        return f"one of {', '.join(signal.choices)}"
    unit = f" {signal.unit}" if signal.unit else ""
    names = f" or one of {', '.join(name for name, _ in signal.names)}" if signal.names else ""
    return f"a number from {signal.minimum:g} to {signal.maximum:g}{unit}{names}"


def _shown(written: Any) -> str:
    if isinstance(written, bool):
        return "true" if written else "false"
    return "nothing" if written is None else repr(written)
