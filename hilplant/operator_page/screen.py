"""The operator's screen as the server sees it: the browsers that look at a run, and what they ask for."""

import asyncio
import contextlib
from collections.abc import Awaitable, Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hilplant.bench import Bench
from hilplant.channel.run_files import RunFile
from hilplant.failure import Failure
from hilplant.operator_page.frames import LiveFrames
from hilplant.operator_page.happenings import Happenings
from hilplant.operator_page.lead import LeadHolder
from hilplant.operator_page.live import LiveRows, Selection
from hilplant.operator_page.logger import Logger
from hilplant.operator_page.requests import Answer, Requests
from hilplant.operator_page.scenario_play import ScenarioPlay
from hilplant.operator_page.stalk import StalkOfLines, StalkOnBus
from hilplant.operator_page.waveform import Waveform
from hilplant.signals import ECU_STATUS
from hilplant.web.access import Access
from hilplant.web.visitor import Visitor

_LOOK_S = 0.1


@dataclass(frozen=True, slots=True)
class RunParts:
    """What belongs to one run: bench; stalk, None where nothing can be reached; frames; the folder of its logs."""

    bench: Bench
    stalk: StalkOfLines | StalkOnBus | None
    frames: LiveFrames
    logs: Path


@dataclass
class Viewer:
    """One browser: its socket, its rows and what it has chosen."""

    number: int
    visitor: Visitor
    rows: LiveRows
    selection: Selection
    rate_hz: float = 0.0
    awake: asyncio.Event = field(default_factory=asyncio.Event)


class Screen:
    """All browsers of one run."""

    def __init__(self, run: RunFile, access: Access, parts: RunParts) -> None:
        """Show a run."""
        self._run, self._access, self.parts = run, access, parts
        self._requests = Requests(self)
        self._seats: dict[int, Viewer] = {}
        self._numbers = 0
        self.happenings = Happenings(run.ring)
        self.lead = LeadHolder(run, self.tell_state)
        self.waveform = Waveform(self._wave, self._wave_ended)
        self.logger = Logger(run.ring, self.log_changed)
        self.recording = ""
        self.scenario = ScenarioPlay(run.ring, parts.bench, self._scenario_changed)
        self._ecu: dict[str, float | None] = {}
        self._tasks: set[asyncio.Task[None]] = set()

    # One browser

    async def serve(self, visitor: Visitor) -> None:
        """Serve a browser until it goes."""
        self._numbers += 1
        number = self._numbers
        seat = Viewer(number, visitor, LiveRows(self._run.ring), Selection((), 1, 0))
        self._seats[number] = seat
        streaming = asyncio.create_task(self._stream(seat))
        try:
            await visitor.tell({"told": "hello", "page": number, "events": list(self.happenings.kept)})
            with contextlib.suppress(Failure):
                await self.lead.ask(number) if self.lead.holder is None else self.tell_state()
            async for message in visitor.messages():
                await self._answer(seat, message)
        finally:
            streaming.cancel()
            del self._seats[number]
            await self.leave(number)
            seat.rows.close()

    async def leave(self, number: int) -> None:
        """Take the lead from a page; its waveform ends."""
        if self.lead.holder == number:
            self._stop_plays()
        await self.lead.give_up(number)

    def _stop_plays(self) -> None:
        self.waveform.stop()
        self.scenario.stop()

    async def _answer(self, seat: Viewer, message: dict[str, Any]) -> None:
        wanted, number = message.get("do"), message.get("id")
        request: Callable[[Viewer, dict[str, Any]], Awaitable[Answer]] | None = (
            getattr(self._requests, f"do_{wanted}", None) if isinstance(wanted, str) else None
        )
        if request is None:
            self._access.refuse("malformed")
            await seat.visitor.tell({"id": number, "error": f"'{str(wanted)[:40]}' is not known"})
            return
        try:
            answer = await request(seat, message)
        except (Failure, ValueError, TypeError, KeyError, OverflowError) as error:
            self._access.refuse("refused")
            reason = f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error)
            answer = {"error": reason or type(error).__name__}
        if number is not None:
            await seat.visitor.tell({"id": number, **answer})

    async def _stream(self, seat: Viewer) -> None:
        """Send the newest rows at the browser's rate; nothing while it is hidden."""
        clock = asyncio.get_running_loop().time
        due_s = clock()
        with contextlib.suppress(ConnectionError):
            while True:
                if not seat.rate_hz:
                    await seat.awake.wait()
                    seat.rows.skip()
                    due_s = clock()
                await seat.visitor.give(seat.rows.newest(seat.selection))
                due_s = max(due_s + 1.0 / seat.rate_hz if seat.rate_hz else 0.0, clock())
                await asyncio.sleep(due_s - clock())

    def log_changed(self, words: str) -> None:
        """Tell all browsers that a log has begun, or is over."""
        self.happenings.add(self.now_s, "log", words)
        self.tell_state()

    async def _wave(self, name: str, value: float) -> None:
        if self.lead.holder is None:
            raise Failure("nobody has the lead any more")
        await self.lead.command(self.lead.holder, "override", {name: value})

    def _scenario_changed(self, words: str) -> None:
        self.happenings.add(self.now_s, "scenario", words)
        self.tell_state()

    def _wave_ended(self, why: str) -> None:
        self.happenings.add(self.now_s, "waveform", f"waveform {why}")
        self.tell_state()

    # All browsers

    @property
    def now_s(self) -> float:
        """The run's time of the newest row [s]."""
        return self.happenings.time_s

    async def work(self) -> None:
        """Tell events, and take the lead from a page that is silent, until the run has ended."""
        looks = newest = 0
        while True:
            self.happenings.look()
            new = [each for each in self.happenings.kept if each["number"] > newest]
            if new:
                newest = new[-1]["number"]
                self._tell_all({"told": "events", "events": new})
            if self.lead.silent:
                self.happenings.add(self.now_s, "lead", "the page in the lead was silent: what it held is released")
                self._stop_plays()
                await self.lead.lose()
            self.parts.frames.look()
            looks += 1
            if looks % 3 == 0:
                self._note_ecu()
            if looks % 3 == 0 and any(seat.rate_hz for seat in self._seats.values()):
                rows = self.parts.frames.rows(self.now_s)
                self._tell_all({"told": "faults", "faults": self.happenings.faults})
                told: dict[str, Any] = {"told": "frames", "rows": rows, "ecu": self.parts.frames.ecu()}
                told |= {"log": self.logger.told, "scenario": self.scenario.told}
                told["late_p99_us"] = self.happenings.late_p99_us()
                self._tell_all(told, awake=True)
            await asyncio.sleep(_LOOK_S)

    def _note_ecu(self) -> None:
        """Keep as an event what the ECU tells of itself, when that changes."""
        told = self.parts.frames.ecu()
        for signal in ECU_STATUS[:2]:
            value = told.get(signal.name)
            before, self._ecu[signal.name] = self._ecu.get(signal.name), value
            if None not in (before, value) and before != value:
                words = " -> ".join(signal.choices[int(each)] for each in (before, value) if each is not None)
                self.happenings.add(self.now_s, "ecu", f"{signal.name.replace('_', ' ')} {words}")

    def state(self) -> dict[str, Any]:
        """Return what all browsers show alike."""
        return {
            "told": "state",
            "lead": self.lead.holder,
            "asking": list(self.lead.asking),
            "pages": len(self._seats),
            "waveform": self.waveform.told,
            "scenario": self.scenario.told,
            "log": self.logger.told | ({"state": "recording", "file": self.recording} if self.recording else {}),
            "logs": str(self.parts.logs),
            "stalk": self.parts.stalk is not None,
            "refused": dict(self._access.refused),
        }

    def tell_state(self) -> None:
        """Tell all browsers what they show alike."""
        self._tell_all(self.state())

    def _tell_all(self, message: dict[str, Any], awake: bool = False) -> None:
        for seat in self._seats.values():
            if awake and not seat.rate_hz:
                continue
            task = asyncio.create_task(self._tell(seat, message))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)

    async def _tell(self, seat: Viewer, message: dict[str, Any]) -> None:
        with contextlib.suppress(ConnectionError):
            await seat.visitor.tell(message)
