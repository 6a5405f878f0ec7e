"""Requests as clients write them, one JSON object each -> commands for the loop."""

import json
import math
from collections.abc import Callable
from typing import Any

from hilplant.bench.values import input_index, signal_value
from hilplant.checked_yaml.problems import suggestion
from hilplant.control.reference import FASTEST_RAD_S
from hilplant.failure import Failure
from hilplant.models.records import PARAMETER_INDEX
from hilplant.runtime import commands as c
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.mailbox import MOST_A_TICK
from hilplant.signals import INPUTS
from hilplant.units import SECOND_NS

#: After this time without a sign of life, what a client holds is released [s].
LEASE_S = 1.0
SHORTEST_LEASE_S, LONGEST_LEASE_S = 0.1, 60.0
#: Longest line that is read.
LINE_BYTES = 65536


def parse(line: bytes) -> dict[str, Any]:
    """Read one line.

    Raises
    ------
    ValueError
        When it is not a JSON object with a text under `do`.
    """
    try:
        request = json.loads(line)
    except (ValueError, RecursionError) as error:
        raise ValueError("a request is one line with a JSON object") from error
    if not isinstance(request, dict) or not isinstance(request.get("do"), str):
        raise ValueError('a request is a JSON object that says under "do" what is wanted')
    return request


def commands_of(request: dict[str, Any]) -> list[ChannelCommand]:
    """Return the commands of a request that the loop answers.

    Raises
    ------
    ValueError
        Saying what would be right.
    """
    wanted = request["do"]
    if wanted not in _COMMANDS:
        raise ValueError(f"'{wanted}' is not known{suggestion(wanted, [*_COMMANDS, *OTHERS])}")
    made = _COMMANDS[wanted](request)
    if not 0 < len(made) <= MOST_A_TICK:
        raise ValueError(f"{wanted}: 1 to {MOST_A_TICK} elements belong into one tick, not {len(made)}")
    return made


def _inputs(request: dict[str, Any], **more: Any) -> list[ChannelCommand]:
    values = _group(request)
    return [
        ChannelCommand(element=input_index(name), value=signal_value(INPUTS[input_index(name)], value), **more)
        for name, value in values.items()
    ]


def _set(request: dict[str, Any]) -> list[ChannelCommand]:
    return _inputs(request, kind=c.SET)


def _override(request: dict[str, Any]) -> list[ChannelCommand]:
    return _inputs(request, kind=c.OVERRIDE, lease_ns=_lease_ns(request))


def _lease_ns(request: dict[str, Any]) -> int:
    lease_s: Any = request.get("lease_s", LEASE_S)
    if not _is_number(lease_s) or not SHORTEST_LEASE_S <= lease_s <= LONGEST_LEASE_S:
        raise ValueError(f"lease_s is a time from {SHORTEST_LEASE_S:g} to {LONGEST_LEASE_S:g} s, not {lease_s!r}")
    return round(float(lease_s) * SECOND_NS)


def _release(request: dict[str, Any]) -> list[ChannelCommand]:
    names = request.get("names")
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise ValueError('release: "names" is a list of inputs')
    return [ChannelCommand(kind=c.RELEASE, element=input_index(name)) for name in names]


def _parameter(request: dict[str, Any]) -> list[ChannelCommand]:
    made = []
    for name, value in _group(request).items():
        if name not in PARAMETER_INDEX:
            raise ValueError(f"there is no parameter '{name}'{suggestion(name, PARAMETER_INDEX)}")
        if not _is_number(value):
            raise ValueError(f"{name} must be a number, not {value!r}")
        made.append(ChannelCommand(kind=c.PARAMETER, element=PARAMETER_INDEX[name], value=float(value)))
    return made


def _reference(request: dict[str, Any]) -> list[ChannelCommand]:
    value: Any = request.get("value")
    if not _is_number(value) or not 0.0 <= value <= FASTEST_RAD_S:
        raise ValueError(f"reference: value is a speed from 0 to {FASTEST_RAD_S:g} rad/s, not {value!r}")
    return [ChannelCommand(kind=c.REFERENCE, value=float(value))]


def _mark(request: dict[str, Any]) -> list[ChannelCommand]:
    text = request.get("text")
    if not isinstance(text, str) or not text:
        raise ValueError('mark: "text" says what is marked')
    return [ChannelCommand(kind=c.MARK, text=c.shortened(text))]


_FAULT_KEYS = ("id", "do", "lease_s")


def _fault(request: dict[str, Any]) -> list[ChannelCommand]:
    from hilplant.faults.written import entry_from  # with what checks YAML, a second of most runs that need none of it

    written = {key: value for key, value in request.items() if key not in _FAULT_KEYS}
    text = json.dumps(written, separators=(",", ":"), ensure_ascii=False).encode(errors="replace")
    try:
        entry_from(text)
    except Failure as failure:
        raise ValueError(str(failure)) from failure
    if len(text) > c.TEXT_BYTES:
        raise ValueError(f"fault: as JSON it has {len(text)} bytes, at most {c.TEXT_BYTES} fit into a command")
    return [ChannelCommand(kind=c.FAULT, text=text, lease_ns=_lease_ns(request))]


def _clear(request: dict[str, Any]) -> list[ChannelCommand]:
    names = request.get("names", [])
    if not isinstance(names, list) or not all(isinstance(name, str) and name for name in names):
        raise ValueError('clear: "names" is a list of faults; all of this client where it is left out')
    return [ChannelCommand(kind=c.CLEAR, text=c.shortened(name)) for name in names or [""]]


def _group(request: dict[str, Any]) -> dict[str, Any]:
    values = request.get("values")
    if not isinstance(values, dict):
        raise ValueError(f'{request["do"]}: "values" is an object with a value by each name')
    return values


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


_COMMANDS: dict[str, Callable[[dict[str, Any]], list[ChannelCommand]]] = {
    "set": _set,
    "override": _override,
    "release": _release,
    "parameter": _parameter,
    "reference": _reference,
    "mark": _mark,
    "fault": _fault,
    "clear": _clear,
}
#: What the door answers itself.
OTHERS = ("hello", "signals", "status", "record", "record_stop", "subscribe", "alive")
