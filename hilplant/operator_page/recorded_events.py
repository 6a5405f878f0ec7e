"""What happened in a recorded run, in the words of a live one: commands with their outcome, modes, faults, counts."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.operator_page.happenings import QUIET, command_words, status_words
from hilplant.runtime.commands import APPLIED, OUTCOMES
from hilplant.signals import STATUS
from hilplant.units import SECOND_NS

#: Events that are shown, the last ones; counts are looked at so often [s], as in a live run.
MOST_EVENTS, LOOK_S = 1000, 0.1

_Event = dict[str, Any]


def events_of(commands: Sequence[_Event], times_s: Floats, status: Mapping[str, Floats]) -> list[_Event]:
    """Return the events of a recording in the order of their times; `status` has what the loop told at each time."""
    found = sorted([*_commands(commands), *_changes(times_s, status)], key=lambda event: event["time_s"])
    return [{"number": number, **event} for number, event in enumerate(found, 1)][-MOST_EVENTS:]


def faults_at(commands: Sequence[_Event], time_s: float) -> list[_Event]:
    """Return the faults that are there at a time, in the order in which they came."""
    there: dict[tuple[str, int, str], _Event] = {}
    for each in commands:
        if each["time_ns"] > time_s * SECOND_NS or each["kind"] not in ("comes", "goes"):
            continue
        who = each["text"], each["client"], each["owner"]
        if each["kind"] == "goes":
            there.pop(who, None)
        else:
            words = f"by {each['owner']}, since {each['time_ns'] / SECOND_NS:.3f} s"
            there[who] = {"fault": each["text"], "words": words}
    return list(there.values())


def _commands(commands: Sequence[_Event]) -> Iterator[_Event]:
    for each in commands:
        kind, applied = each["kind"], each["outcome"] == OUTCOMES[APPLIED]
        if kind in ("alive", "fault", "clear") and applied:
            continue
        valued = kind in ("set", "override", "parameter")
        what = f"{each['name']} = {each['value']:g}" if valued else each["name"] or each["text"]
        named = command_words(kind, f"{each['owner']} {kind} {what}", each["outcome"], each["tick"])
        yield _event(each["time_ns"] / SECOND_NS, *named)


def _changes(times_s: Floats, status: Mapping[str, Floats]) -> Iterator[_Event]:
    looks = np.unique(np.searchsorted(times_s, np.arange(times_s[0], times_s[-1], LOOK_S)))
    for signal in STATUS:
        if signal.name in QUIET or signal.name not in status:
            continue
        values = status[signal.name][looks]
        known = np.isfinite(values[:-1]) & np.isfinite(values[1:])
        for place in np.flatnonzero(known & (values[:-1] != values[1:])):
            named = status_words(signal, values[place], values[place + 1])
            yield _event(float(times_s[looks[place + 1]]), *named)


def _event(time_s: float, kind: str, words: str) -> _Event:
    return {"time_s": time_s, "kind": kind, "words": words}
