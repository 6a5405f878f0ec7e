"""Who commands an input: the bus, a scenario or a hand; the stronger one's value stands, until it lets go of it."""

from collections.abc import MutableSequence
from typing import NamedTuple

from hilplant.arrays import Floats
from hilplant.runtime import commands as c

_NEVER_NS = 1 << 62


class _Held(NamedTuple):
    """What somebody holds an input at, and until when unless he is heard of."""

    value: float
    client: int
    end_ns: int
    lease_ns: int


class Ownership:
    """The values that stand over those of the bus.

    `bus` are the values that frames have brought; `row` gets the owner of each input, an index of ``OWNERS``. A set
    value lies among those of the bus, and is a hand's until a frame writes there: until the very number that was put
    there is another one.
    """

    def __init__(self, bus: MutableSequence[float], row: Floats) -> None:
        self._bus, self._row = bus, row
        self._set: dict[int, float] = {}
        self._held: tuple[dict[int, _Held], ...] = ({}, {}, {})  # by owner; the bus holds nothing
        #: Whether anything is held or set: if not, a tick has nothing to do here.
        self.active = False
        #: When the next lease runs out.
        self.next_end_ns = _NEVER_NS

    def put(self, index: int, value: float) -> int:
        """Set an input until the next frame that carries it; returns the outcome."""
        if index in self._held[c.HAND]:
            return c.HELD_BY_OTHER
        if index in self._held[c.SCENARIO]:
            return c.HELD_BY_SCENARIO
        own = float(f"{value!r}")  # an object of its own, that nobody else can have put there
        self._bus[index] = self._set[index] = own
        self.active = True
        return c.APPLIED

    def hold(self, command: c.ChannelCommand, now_ns: int) -> int:
        """Hold an input at a value; returns the outcome."""
        held = self._held[command.owner]
        before = held.get(command.element)
        if before is not None and before.client != command.client:
            return c.HELD_BY_OTHER
        end_ns = now_ns + command.lease_ns if command.lease_ns else _NEVER_NS
        held[command.element] = _Held(command.value, command.client, end_ns, command.lease_ns)
        self.next_end_ns = min(self.next_end_ns, end_ns)
        self.active = True
        return c.APPLIED

    def goes_on(self, command: c.ChannelCommand) -> bool:
        """Say whether it is the next value of an input that a scenario holds already."""
        return command.owner == c.SCENARIO and command.kind == c.OVERRIDE and command.element in self._held[c.SCENARIO]

    def release(self, command: c.ChannelCommand) -> int:
        """Let go of an input; returns the outcome."""
        held = self._held[command.owner].get(command.element)
        if held is None:
            return c.NOT_HELD
        if held.client != command.client:
            return c.HELD_BY_OTHER
        self._let_go(command.owner, command.element)
        return c.APPLIED

    def alive(self, client: int, now_ns: int) -> None:
        """Begin the leases of a client anew."""
        held = self._held[c.HAND]
        for index, each in held.items():
            if each.client == client and each.lease_ns:
                held[index] = each._replace(end_ns=now_ns + each.lease_ns)

    def expired(self, now_ns: int) -> list[c.ChannelCommand]:
        """Let go of what nobody has renewed; returns who held what."""
        gone = []
        for owner, held in enumerate(self._held):
            over = [(index, each) for index, each in held.items() if now_ns >= each.end_ns]
            for index, each in over:
                self._let_go(owner, index)
                gone.append(
                    c.ChannelCommand(client=each.client, kind=c.RELEASE, owner=owner, element=index, value=each.value)
                )
        ends = [each.end_ns for held in self._held for each in held.values()]
        self.next_end_ns = min(ends, default=_NEVER_NS)
        return gone

    def impose(self, inputs: Floats) -> None:
        """Write the values that stand over those of the bus, and say who commands what."""
        self._row[:] = c.BUS
        for index, value in list(self._set.items()):
            if self._bus[index] is value:
                self._row[index] = c.HAND
            else:
                del self._set[index]
        for owner in (c.SCENARIO, c.HAND):
            for index, each in self._held[owner].items():
                inputs[index] = each.value
                self._row[index] = owner
        self.active = bool(self._set or any(self._held))

    def _let_go(self, owner: int, index: int) -> None:
        del self._held[owner][index]
