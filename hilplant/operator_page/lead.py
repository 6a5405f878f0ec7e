"""Who drives: one browser has the lead and a channel into the run; the others watch, and can ask for it."""

import asyncio
from collections.abc import Callable
from typing import Any

from hilplant.channel.client import RunChannel
from hilplant.channel.run_files import RunFile
from hilplant.failure import Failure

#: A page in the lead that has been silent for so long loses it, and with it all that it holds [s].
SILENCE_S = 3.0


class LeadHolder:
    """The lead, the page that has it, and those that ask for it; pages are numbers."""

    def __init__(self, run: RunFile, changed: Callable[[], None]) -> None:
        """`changed` is called when the lead has changed hands."""
        self._run, self._changed = run, changed
        self.holder: int | None = None
        self.asking: list[int] = []
        self.channel: RunChannel | None = None
        self._seen_s = 0.0
        self._silent: int | None = None

    async def ask(self, page: int) -> None:
        """Give a page the lead if nobody has it; else note that it asks."""
        if self.holder is None:
            self.channel = await asyncio.to_thread(self._connect)
            self.holder, self._seen_s, self._silent = page, _now_s(), None
        elif page != self.holder and page not in self.asking:
            self.asking.append(page)
        self._changed()

    def _connect(self) -> RunChannel:
        if not self._run.socket:
            raise Failure("this run was started with --no-channel: the page can only watch")
        return RunChannel(self._run)

    async def give_up(self, page: int) -> None:
        """Let go of the lead, and of all that is held; the first that asks gets it."""
        if page in self.asking:
            self.asking.remove(page)
        if page == self._silent:
            self._silent = None
        if page == self.holder:
            channel, self.channel, self.holder = self.channel, None, None
            if channel is not None:
                await asyncio.to_thread(channel.close)
            if self.asking:
                await self.ask(self.asking.pop(0))
        self._changed()

    async def alive(self, page: int) -> None:
        """Note a sign of life; a page that was silent has the lead again, if nobody else has it by now."""
        if page == self.holder:
            self._seen_s = _now_s()
        elif page == self._silent and self.holder is None:
            await self.ask(page)

    async def lose(self) -> None:
        """Take the lead from a page that is silent."""
        page = self.holder
        if page is not None:
            await self.give_up(page)
            self._silent = page

    @property
    def silent(self) -> bool:
        """Whether the page in the lead has not been heard of for too long."""
        return self.holder is not None and _now_s() - self._seen_s > SILENCE_S

    async def command(self, page: int, wanted: str, *arguments: Any, **more: Any) -> Any:
        """Call a method of the channel for the page in the lead.

        Raises
        ------
        Failure
            When it is not in the lead, or the run refuses.
        """
        if page != self.holder or self.channel is None:
            raise Failure("another page has the lead: ask for it" if self.holder else "take the lead first")
        return await asyncio.to_thread(getattr(self.channel, wanted), *arguments, **more)


def _now_s() -> float:
    return asyncio.get_running_loop().time()
