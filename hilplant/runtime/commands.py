"""What comes from beside the bus: the record of one command, and of the answer that says what became of it.

A command and its answer have one layout. The answer is an event: it is read in the ring, and kept in the recording.
"""

from typing import NamedTuple

import numpy as np

#: set: until the next frame; override: until released; parameter: an element of the parameter row; reference: of the
#: controller inside the loop; alive: the client still lives; start: the scenario's time 0; fault: inserts the one that
#: `text` describes; clear: ends a client's faults of the name `text`, all without one; comes, goes: only told, when a
#: fault is there from a tick on, and no longer.
KINDS = (
    "set", "override", "release", "parameter", "reference", "mark", "recording", "alive", "start",
    "fault", "clear", "comes", "goes",
)  # fmt: skip
(SET, OVERRIDE, RELEASE, PARAMETER, REFERENCE, MARK, RECORDING, ALIVE, START, FAULT, CLEAR, COMES, GOES) = range(
    len(KINDS)
)

#: Who commands an input, from the weakest to the strongest; the safe state stands above all.
OWNERS = ("bus", "scenario", "hand", "safe")
BUS, SCENARIO, HAND, SAFE_STATE = range(len(OWNERS))

OUTCOMES = (
    "applied", "out of range", "held by another client", "held by the scenario", "not held", "no controller",
    "no such element", "lease over", "refused",
)  # fmt: skip
(APPLIED, OUT_OF_RANGE, HELD_BY_OTHER, HELD_BY_SCENARIO, NOT_HELD, NO_CONTROLLER, NO_ELEMENT, LEASE_OVER, REFUSED) = (
    range(len(OUTCOMES))
)

TEXT_BYTES = 240

#: `more`: the next belongs to the same tick; `element`: index of the input or the parameter; `lease_ns`: 0 for
#: no end; `text`: of a mark or a fault, and why a fault is refused.
COMMAND_DTYPE = np.dtype(
    [
        ("tick", "<i8"),
        ("time_ns", "<i8"),
        ("client", "<u4"),
        ("number", "<u4"),
        ("kind", "u1"),
        ("owner", "u1"),
        ("outcome", "u1"),
        ("more", "u1"),
        ("element", "<i4"),
        ("value", "<f8"),
        ("lease_ns", "<i8"),
        ("text", f"S{TEXT_BYTES}"),
    ]
)


class ChannelCommand(NamedTuple):
    """One element of ``COMMAND_DTYPE``, by name; an answer where `tick` and `outcome` are filled."""

    tick: int = 0
    time_ns: int = 0
    client: int = 0
    number: int = 0
    kind: int = SET
    owner: int = HAND
    outcome: int = APPLIED
    more: int = 0
    element: int = 0
    value: float = 0.0
    lease_ns: int = 0
    text: bytes = b""


def shortened(text: str) -> bytes:
    """Return a text as UTF-8 that fits into a command, cut between two letters."""
    return text.encode(errors="replace")[:TEXT_BYTES].decode(errors="ignore").encode()
