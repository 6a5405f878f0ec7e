"""What a browser asks for on the socket: `do_...` for each `"do"` of a message; what is refused raises."""

import asyncio
from typing import TYPE_CHECKING, Any

from hilplant.failure import Failure
from hilplant.operator_page.live import Selection
from hilplant.operator_page.logger import LogOrder, file_in
from hilplant.operator_page.trigger import Trigger

if TYPE_CHECKING:
    from hilplant.operator_page.screen import Screen, Viewer

_MOST_HZ = 60.0
Answer = dict[str, Any]


class Requests:
    """The requests of all browsers of one screen."""

    def __init__(self, screen: "Screen") -> None:
        """Answer for a screen."""
        self._screen = screen

    async def do_view(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Choose signals, thinning and rate; 0 Hz while the page is hidden."""
        names, every, rate = list(message["signals"]), int(message["every"]), float(message["rate"])
        if not 1 <= every <= 60_000 or not 0.0 <= rate <= _MOST_HZ:
            raise ValueError("every is 1 to 60000 ticks, rate 0 to 60 Hz")
        seat.selection = Selection(names, every, seat.selection.number + 1)
        seat.rate_hz = rate
        (seat.awake.set if rate else seat.awake.clear)()
        return {"selection": seat.selection.number}

    async def do_stretch(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Send a stretch of the past."""
        span = (float(message["from_s"]), float(message["to_s"]))
        names, points, number = list(message["signals"]), int(message["points"]), int(message["id"])
        data = await asyncio.to_thread(seat.rows.stretch, names, span, points, number)
        await seat.visitor.give(data)
        return {}

    async def do_alive(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Note a sign of life."""
        await self._screen.lead.alive(seat.number)
        return {}

    async def do_lead(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Take the lead, ask for it, or give it up."""
        if message["want"]:
            await self._screen.lead.ask(seat.number)
        else:
            await self._screen.leave(seat.number)
        return {}

    async def do_set(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Set inputs until a frame says otherwise."""
        return {"tick": await self._screen.lead.command(seat.number, "set", dict(message["values"]))}

    async def do_override(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Hold inputs until they are released."""
        return {"tick": await self._screen.lead.command(seat.number, "override", dict(message["values"]))}

    async def do_release(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Let go of inputs; a waveform on one of them ends."""
        names = [str(name) for name in message["names"]]
        if self._screen.waveform.told.get("input") in names:
            self._screen.waveform.stop()
            self._screen.tell_state()
        return {"tick": await self._screen.lead.command(seat.number, "release", *names)}

    async def do_parameter(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Change parameters of the plant."""
        return {"tick": await self._screen.lead.command(seat.number, "parameter", dict(message["values"]))}

    async def do_mark(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Put a mark into the recording."""
        return {"tick": await self._screen.lead.command(seat.number, "mark", str(message["text"])[:80])}

    async def do_waveform(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Start a waveform, or end it."""
        self._must_lead(seat)
        if message.get("written"):
            self._screen.waveform.start(str(message["input"]), dict(message["written"]))
        else:
            self._screen.waveform.stop()
        self._screen.tell_state()
        return {}

    async def do_stalk(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Move the stalk."""
        self._must_lead(seat)
        if self._screen.parts.stalk is None:
            raise Failure("no stalk: the interface virtual reaches no ECU; hilplant demo --page has one")
        self._screen.parts.stalk.move(str(message["move"]))
        self._screen.happenings.add(self._screen.now_s, "stalk", f"stalk {message['move']}")
        return {}

    async def do_scenario(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Start a shipped scenario, or stop it."""
        self._must_lead(seat)
        channel = self._screen.lead.channel
        if message.get("name") and channel is not None:
            self._screen.scenario.start(str(message["name"]), channel, self._screen.parts.stalk)
        else:
            self._screen.scenario.stop()
        return {}

    async def do_fault(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Insert a fault."""
        keys = {str(key): value for key, value in dict(message["keys"]).items()}
        return {"tick": await self._screen.lead.command(seat.number, "fault", str(message["fault"]), **keys)}

    async def do_clear(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """End faults that pages have inserted."""
        return {"tick": await self._screen.lead.command(seat.number, "clear", *map(str, message["names"]))}

    async def do_status(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Return the run's status, as the channel tells it."""
        return dict(await self._screen.lead.command(seat.number, "status"))

    async def do_log(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """Begin a recording or a table in the folder of logs."""
        self._must_lead(seat)
        path = file_in(self._screen.parts.logs, str(message["file"]))
        if path.suffix == ".hilrec":
            tick = await self._screen.lead.command(seat.number, "record", path)
            self._screen.recording = path.name
            self._screen.log_changed(f"recording {path.name} begins")
            return {"tick": tick, "path": str(path)}
        trigger = Trigger(**dict(message.get("trigger") or {}))
        seconds = message.get("seconds")
        length = None if seconds is None else float(seconds)
        order = LogOrder(path, list(message["signals"]), trigger, float(message.get("before_s", 0.0)), length)
        self._screen.logger.start(order)
        self._screen.tell_state()
        return {"path": str(path)}

    async def do_log_stop(self, seat: "Viewer", message: dict[str, Any]) -> Answer:
        """End it."""
        self._must_lead(seat)
        if self._screen.recording:
            name, self._screen.recording = self._screen.recording, ""
            words = f"recording {name} is NOT complete"
            try:
                await self._screen.lead.command(seat.number, "stop_recording")
                words = f"recording {name} is whole"
            finally:
                self._screen.log_changed(words)
        else:
            await self._screen.logger.stop()
        return {}

    def _must_lead(self, seat: "Viewer") -> None:
        if seat.number != self._screen.lead.holder:
            raise Failure("another page has the lead: ask for it")
