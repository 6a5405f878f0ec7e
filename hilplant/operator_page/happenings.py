"""What happens in a run, in words, for the page's event log: commands with their outcome, modes, faults of the bus."""

from collections import deque
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.channel.run_files import columns
from hilplant.declaration import Signal
from hilplant.models.records import PARAMETER_INDEX
from hilplant.runtime.commands import APPLIED, COMES, KINDS, OUTCOMES, OWNERS, ChannelCommand
from hilplant.runtime.follower import Follower
from hilplant.signals import INPUTS, MODES, STATUS
from hilplant.units import SECOND_NS

MOST = 500
_LATE_TICKS = 10_000
_PARAMETERS = list(PARAMETER_INDEX)
#: Counts whose change is no event.
QUIET = ("tick", "worst_latency_us")


class Happenings:
    """The last events, the newest last; each has a number, the time [s], a kind and words."""

    def __init__(self, ring: str) -> None:
        """Follow a run from now on."""
        self._follower = Follower(ring)
        self._places = {name: index for index, (name, _) in enumerate(columns())}
        self._before: Floats | None = None
        self.row = self._follower.latest()
        self._number = 0
        self.time_s = 0.0
        #: Faults that are there, in the order in which they came.
        self.faults: list[dict[str, Any]] = []
        self.kept: deque[dict[str, Any]] = deque(maxlen=MOST)

    def look(self) -> list[dict[str, Any]]:
        """Return what is new since the last look."""
        row = self.row = self._follower.latest()
        self.time_s = now_s = float(row[1]) / SECOND_NS
        new = [self._command(ChannelCommand(*event.item())) for event in self._follower.events().records]
        new += [self.add(now_s, kind, words) for kind, words in self._changes(row)]
        self._before = row
        return [each for each in new if each]

    def late_p99_us(self) -> int:
        """Return how late [us] 99 of 100 of the last ticks began, over ten seconds at a step of 1 ms."""
        late = self._follower.late_us(_LATE_TICKS)
        return int(np.percentile(late, 99)) if len(late) else 0

    def add(self, time_s: float, kind: str, words: str) -> dict[str, Any]:
        """Keep an event."""
        self._number += 1
        made = {"number": self._number, "time_s": time_s, "kind": kind, "words": words}
        self.kept.append(made)
        return made

    def _command(self, event: ChannelCommand) -> dict[str, Any]:
        kind = KINDS[event.kind] if event.kind < len(KINDS) else "command"
        if kind in ("alive", "fault", "clear") and event.outcome == APPLIED:
            return {}
        what = event.text.decode(errors="replace") if event.text else ""
        if kind in ("set", "override", "release"):
            name = INPUTS[event.element].name if 0 <= event.element < len(INPUTS) else "?"
            what = name if kind == "release" else f"{name} = {event.value:g}"
        elif kind == "parameter" and 0 <= event.element < len(_PARAMETERS):
            what = f"{_PARAMETERS[event.element]} = {event.value:g}"
        elif kind in ("comes", "goes"):
            what = self._fault(event)
        by = OWNERS[event.owner] if event.owner < len(OWNERS) else ""
        said = command_words(kind, f"{by} {kind} {what}", OUTCOMES[event.outcome], event.tick)
        return self.add(event.time_ns / SECOND_NS, *said)

    def _fault(self, event: ChannelCommand) -> str:
        """Keep in mind which faults are there; return the fault in words."""
        name = event.text.decode(errors="replace")
        who = {"fault": name, "client": event.client, "owner": OWNERS[event.owner]}
        if event.kind == COMES:
            words = f"by {who['owner']}, since {event.time_ns / SECOND_NS:.3f} s"
            self.faults.append(who | {"words": words})
        else:
            gone = next((each for each in self.faults if {**each, **who} == each), None)
            if gone is not None:
                self.faults.remove(gone)
        return name

    def _changes(self, row: Floats) -> list[tuple[str, str]]:
        if self._before is None:
            return []
        found = []
        for signal in STATUS:
            at = self._places[f"status.{signal.name}"]
            before, now = self._before[at], row[at]
            if before != now and signal.name not in QUIET:
                found.append(status_words(signal, before, now))
        return found


def command_words(kind: str, said: str, outcome: str, tick: int) -> tuple[str, str]:
    """Return the kind and the words of a command that came to this outcome."""
    refused = "" if outcome == OUTCOMES[APPLIED] else f": {outcome}"
    return "refused" if refused else kind, f"{said.strip()}{refused}, tick {tick}"


def status_words(signal: Signal, before: float, now: float) -> tuple[str, str]:
    """Return the kind and the words of a change in what the loop tells of itself."""
    if signal.name == "mode":
        return "mode", f"mode {MODES[int(before)]} -> {MODES[int(now)]}"
    if signal.kind == "choice":
        return "status", f"{signal.name} {signal.choices[int(before)]} -> {signal.choices[int(now)]}"
    return "count", f"{signal.name} {before:g} -> {now:g}: {signal.meaning}"
