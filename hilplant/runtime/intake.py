"""What a tick begins with: the commands of the mailbox, and leases that have run out."""

import math
from collections.abc import Callable, Sequence

from hilplant.models.records import PARAMETER_INDEX
from hilplant.runtime import commands as c
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.held_faults import HeldFaults
from hilplant.runtime.mailbox import Mailbox
from hilplant.runtime.ownership import Ownership
from hilplant.signals import INPUTS, WANTED

#: Gives the commands that are due beside those of the mailbox, such as a scenario's: called with the time [ns].
Source = Callable[[int], Sequence[ChannelCommand]]


class Intake:
    """Applies commands to the inputs and parameters of a loop, and answers each by an event.

    `controlled` says whether a controller inside the loop takes a wanted speed; `source` gives commands beside the
    mailbox.
    """

    def __init__(
        self,
        mailbox: Mailbox | None,
        ownership: Ownership,
        faults: HeldFaults,
        tell: Callable[[ChannelCommand], None],
    ) -> None:
        """`tell` gets each answer."""
        self.controlled = False
        self.source: Source | None = None
        self._why = ""
        self.faults = faults
        self._mailbox, self._ownership, self._tell = mailbox, ownership, tell
        self._apply = (
            self._set, self._hold, self._release, self._parameter, self._refer, _note, _note, self._alive, _note,
            self._insert, self._clear,
        )  # fmt: skip

    def begin(self, tick: int, now_ns: int) -> None:
        """Do what the tick begins with."""
        if self._mailbox is not None and self._mailbox.waiting:
            for command in self._mailbox.take():
                self._do(command, tick, now_ns)
        if self.source is not None:
            for command in self.source(now_ns):
                self._do(command, tick, now_ns)
        if now_ns >= self._ownership.next_end_ns:
            for gone in self._ownership.expired(now_ns):
                self._tell(gone._replace(tick=tick, time_ns=now_ns, outcome=c.LEASE_OVER))
        self.faults.begin(tick, now_ns)

    def next_due_ns(self) -> float:
        """Return when there is something to do beside the mailbox and the source; -inf while every tick needs it."""
        return min(self._ownership.next_end_ns, self.faults.next_due_ns())

    def _do(self, command: ChannelCommand, tick: int, now_ns: int) -> None:
        """Apply one command and answer it; a sign of life is not answered, nor each value of a scenario's ramp."""
        if not (0 <= command.kind < len(self._apply) and command.owner in (c.SCENARIO, c.HAND)):
            command = command._replace(kind=c.MARK, owner=c.HAND, outcome=c.NO_ELEMENT)  # nothing that could be named
            self._tell(command._replace(tick=tick, time_ns=now_ns))
            return
        silent = command.kind == c.ALIVE or self._ownership.goes_on(command)
        outcome = self._apply[command.kind](command, now_ns)
        if outcome == c.REFUSED:
            command = command._replace(text=c.shortened(self._why))
        if not silent or outcome != c.APPLIED:
            self._tell(command._replace(tick=tick, time_ns=now_ns, outcome=outcome))

    def _set(self, command: ChannelCommand, now_ns: int) -> int:
        return _wrong_value(command) or self._ownership.put(command.element, command.value)

    def _hold(self, command: ChannelCommand, now_ns: int) -> int:
        return _wrong_value(command) or self._ownership.hold(command, now_ns)

    def _release(self, command: ChannelCommand, now_ns: int) -> int:
        return self._ownership.release(command)

    def _parameter(self, command: ChannelCommand, now_ns: int) -> int:
        if not 0 <= command.element < len(PARAMETER_INDEX):
            return c.NO_ELEMENT
        if not math.isfinite(command.value):
            return c.OUT_OF_RANGE
        self.faults.parameter(command.element, command.value)
        return c.APPLIED

    def _refer(self, command: ChannelCommand, now_ns: int) -> int:
        if not self.controlled:
            return c.NO_CONTROLLER
        return self._set(command._replace(element=WANTED), now_ns)

    def _alive(self, command: ChannelCommand, now_ns: int) -> int:
        self._ownership.alive(command.client, now_ns)
        self.faults.alive(command.client, now_ns)
        return c.APPLIED

    def _insert(self, command: ChannelCommand, now_ns: int) -> int:
        self._why = self.faults.insert(command, now_ns)
        return c.REFUSED if self._why else c.APPLIED

    def _clear(self, command: ChannelCommand, now_ns: int) -> int:
        return self.faults.clear(command)


def _note(command: ChannelCommand, now_ns: int) -> int:
    """Do nothing: the event is all there is to it."""
    return c.APPLIED


def _wrong_value(command: ChannelCommand) -> int:
    """Return why an input cannot take the value, 0 if it can."""
    if not 0 <= command.element < len(INPUTS):
        return c.NO_ELEMENT
    signal, value = INPUTS[command.element], command.value
    whole = signal.kind == "real" or value == math.floor(value) if math.isfinite(value) else False
    return c.APPLIED if whole and signal.minimum <= value <= signal.maximum else c.OUT_OF_RANGE
