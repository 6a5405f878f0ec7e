"""A bench's loop with a mailbox, ticked by hand, as the channel's clients find it."""

from typing import Any

import numpy as np
from support.loop_rig import SLOW, STEP_NS, ListedTransport

from hilplant.bench import load_bench
from hilplant.faults.acting import ActingFaults
from hilplant.runtime import commands as c
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.follower import Follower
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import FIRST_OWNER, ROW_WIDTH
from hilplant.runtime.server import build_loop


class Run:
    """A bench's loop with a mailbox, ticked by hand."""

    def __init__(self, rows: int = 4096, bench: str = "default") -> None:
        self.bench, self.transport = load_bench(bench), ListedTransport()
        self.ring = Ring.create(ROW_WIDTH, rows=rows, frames=1024)
        acting = ActingFaults(self.bench, self.transport)
        self.loop = build_loop(self.bench, acting.transport, VirtualClock(), self.ring)
        self.loop.listen(self.ring.mailbox, self.ring.events.append, acting)
        self.follower = Follower(self.ring.name)
        self.now = 0

    def tick(self, ticks: int = 1, command_every: int = 0) -> np.ndarray:
        for _ in range(ticks):
            if command_every and self.now % command_every == 0:
                self.transport.arrived.append(SLOW)
            self.loop.tick(self.now * STEP_NS)
            self.now += 1
        return self.ring.latest()

    def post(self, kind: int, element: int = 0, value: float = 0.0, **more: Any) -> None:
        assert self.ring.mailbox.post(
            [ChannelCommand(client=more.pop("client", 1), kind=kind, element=element, value=value, **more)]
        )

    def events(self) -> list[tuple[int, str, str]]:
        found = self.follower.events().records
        return [(int(e["tick"]), c.KINDS[e["kind"]], c.OUTCOMES[e["outcome"]]) for e in found]

    def input(self, index: int) -> float:
        return float(self.ring.latest()[2 + index])

    def owner(self, index: int) -> str:
        return c.OWNERS[int(self.ring.latest()[FIRST_OWNER + index])]

    def close(self) -> None:
        self.follower.close()
        self.ring.close()
