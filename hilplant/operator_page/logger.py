"""The data logger: chosen signals of a run into a table, from a trigger on, with what was before it."""

import asyncio
import contextlib
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.channel.run_files import column_of, columns
from hilplant.failure import Failure
from hilplant.operator_page.trigger import Trigger
from hilplant.recording.tables import Add, check_ending, open_table
from hilplant.runtime.follower import Follower
from hilplant.units import SECOND_NS

_LOOK_S = 0.05
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}")
#: The longest stretch before the trigger [s]: what the ring holds, less what is just being written.
LONGEST_BEFORE_S = 50.0
_UNITS = dict(columns())
Told = dict[str, Any]


def file_in(folder: Path, name: str) -> Path:
    """Return the path of a new file in the folder; a name alone, so that nothing is written elsewhere.

    Raises
    ------
    Failure
        When the name is more than a name, or is taken.
    """
    if not _NAME.fullmatch(name) or ".." in name:
        raise Failure(f"'{name[:60]}': a file's name has letters, digits, dots, - and _, and no folder")
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    if path.exists() or path.is_symlink():
        raise Failure(f"{name}: there is such a file already")
    return path


@dataclass(frozen=True, slots=True)
class LogOrder:
    """What is to be logged: signals by their full names, the trigger, seconds before it and from it on."""

    path: Path
    signals: Sequence[str]
    trigger: Trigger
    before_s: float = 0.0
    seconds: float | None = None


class Logger:
    """One log at a time."""

    def __init__(self, ring: str, changed: Callable[[str], None]) -> None:
        """`changed` is told in words when a log has begun, or is over."""
        self._ring, self._changed = ring, changed
        self._task: asyncio.Task[None] | None = None
        self._stop = asyncio.Event()
        self.told: Told = {"state": "off"}

    @property
    def busy(self) -> bool:
        """Whether a log waits for its trigger, or is written."""
        return self._task is not None and not self._task.done()

    def start(self, order: LogOrder) -> None:
        """Begin to wait for the trigger.

        Raises
        ------
        Failure
            When it cannot be logged like this.
        """
        if self.busy:
            raise Failure("a log is being written already")
        if not 0.0 <= order.before_s <= LONGEST_BEFORE_S:
            raise Failure(f"before the trigger there are up to {LONGEST_BEFORE_S:g} s")
        if order.seconds is not None and not 0.0 < order.seconds <= 86400.0:
            raise Failure("a log has up to 86400 s")
        check_ending(order.path)
        named = {_short(name): column_of(name) for name in order.signals}
        self._stop.clear()
        self.told = {"state": "armed", "file": order.path.name, "rows": 0, "lost": 0}
        self._task = asyncio.create_task(self._log(order, named))

    async def stop(self) -> None:
        """End the log; its file is whole when this returns."""
        self._stop.set()
        if self._task is not None:
            await self._task

    async def _log(self, order: LogOrder, named: dict[str, int]) -> None:
        follower = Follower(self._ring, history=True)
        try:
            first = await self._triggered(follower, order)
            if first is None:
                self._over("off", f"log {order.path.name}: stopped before its trigger")
                return
            self.told |= {"state": "logging"}
            self._changed(f"log {order.path.name} begins")
            units = {"time_s": "s"} | {name: _UNITS[columns()[place][0]] for name, place in named.items()}
            with open_table(order.path, units) as add:
                await self._write(follower, (add, named), first, order)
            lost = f"; {self.told['lost']} ticks LOST, the log has a gap" if self.told["lost"] else ""
            self._over("lossy" if lost else "whole", f"log {order.path.name}: {self.told['rows']} ticks{lost}")
        except (Failure, OSError) as error:
            self._over("failed", f"log {order.path.name}: {error}")
        finally:
            follower.close()

    def _over(self, state: str, words: str) -> None:
        self.told |= {"state": state, "words": words}
        self._changed(words)

    async def _triggered(self, follower: Follower, order: LogOrder) -> Floats | None:
        """Return the rows from `before_s` before the trigger on; None when it was stopped before."""
        kept: Floats = follower.rows().records
        while not self._stop.is_set() and not follower.ended:
            await self._pause()
            taken = follower.rows()
            at = order.trigger.first(taken.records)
            edge = len(kept) + (at or 0)
            kept = np.vstack([kept, taken.records]) if len(kept) else taken.records
            if at is not None:
                self.told["lost"] += taken.lost
                from_ns = kept[edge, 1] - order.before_s * SECOND_NS
                return kept[np.searchsorted(kept[:, 1], from_ns) :]
            kept = kept[np.searchsorted(kept[:, 1], kept[-1, 1] - order.before_s * SECOND_NS) :] if len(kept) else kept
        return None

    async def _write(self, follower: Follower, into: tuple[Add, dict[str, int]], rows: Floats, order: LogOrder) -> None:
        add, named = into
        end_ns = np.inf if order.seconds is None else rows[0, 1] + (order.before_s + order.seconds) * SECOND_NS
        while True:
            part = rows[rows[:, 1] < end_ns]
            if len(part):
                table = {"time_s": part[:, 1] / SECOND_NS} | {name: part[:, place] for name, place in named.items()}
                await asyncio.to_thread(add, table)
                self.told["rows"] += len(part)
            if len(part) < len(rows) or self._stop.is_set() or follower.ended:
                return
            await self._pause()
            taken = follower.rows()
            rows = taken.records
            self.told["lost"] += taken.lost

    async def _pause(self) -> None:
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._stop.wait(), _LOOK_S)


def _short(name: str) -> str:
    """Return the name of a column in a table, as `hilplant export` names it."""
    full = columns()[column_of(name)][0]
    return full.removeprefix("out.").replace("in.", "in_", 1).replace("status.", "status_", 1)
