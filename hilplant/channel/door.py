"""The process beside the loop that holds the socket: it can die, and the loop goes on.

Started by :mod:`hilplant.channel.beside_loop`, which hands over what it needs as one line on standard input and keeps
that pipe open: its end means that the run has ended. Says ``ready`` or one line of error on standard output.
"""

import asyncio
import contextlib
import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from hilplant.channel.events import PresentFaults, name_of, reason
from hilplant.channel.requests import LEASE_S, LINE_BYTES, commands_of, parse
from hilplant.channel.run_files import PROTOCOL, column_of, columns
from hilplant.failure import Failure
from hilplant.runtime import commands as c
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.follower import Follower
from hilplant.runtime.ring import Ring
from hilplant.runtime.scheduling import stand_back

_LOOK_S, _IDLE_S = 0.001, 0.02
#: A loop that has not answered by then is not running [s].
_ANSWER_S = 2.0
_ROWS_EVERY_S = 0.02


class Door:
    """All clients of a run: their requests go into the mailbox, the loop's answers come from the events."""

    def __init__(self, order: dict[str, Any]) -> None:
        self.malformed = self.refused = 0
        self._order = order
        self._ring, self._follower = Ring.attach(order["ring"]), Follower(order["ring"])
        self._clients, self._numbers = 0, 0
        self._asked = asyncio.Event()
        self._waiting: dict[tuple[int, int], list[ChannelCommand]] = {}
        self._writers: dict[int, asyncio.StreamWriter] = {}
        self._recorder: Any = None
        self._subscriptions: set[asyncio.Task[None]] = set()
        self._faults = PresentFaults()

    @property
    def ended(self) -> bool:
        """Whether the loop has ended."""
        return self._follower.ended

    async def follow(self) -> None:
        """Hand out the loop's answers until the loop has ended."""
        while not self.ended:
            for event in self._follower.events().records:
                self._hand_out(ChannelCommand(*event.item()))
            if self._waiting:
                await asyncio.sleep(_LOOK_S)
            else:
                self._asked.clear()
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._asked.wait(), _IDLE_S)

    def _hand_out(self, event: ChannelCommand) -> None:
        answers = self._waiting.get((event.client, event.number))
        if answers is not None:
            answers.append(event)
        elif event.outcome == c.LEASE_OVER and event.client in self._writers:
            told = {"event": "released", "name": name_of(event), "tick": event.tick, "why": "lease over"}
            _send(self._writers[event.client], told)
        if event.kind in (c.COMES, c.GOES):
            told = self._faults.note(event)
            if event.owner == c.HAND and event.client in self._writers:
                _send(self._writers[event.client], told)

    async def greet(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        """Serve one client until it goes; whatever it sends, the others and the loop are not concerned."""
        self._clients += 1
        client = self._clients
        self._writers[client] = writer
        try:
            while line := await reader.readline():
                answer = await self._answered(client, line)
                if answer is not None:
                    _send(writer, answer)
                    await writer.drain()
        except ValueError:  # a line without an end
            self.malformed += 1
            _send(writer, {"ok": False, "error": f"a line has at most {LINE_BYTES} bytes"})
        except OSError:
            pass
        finally:
            del self._writers[client]
            writer.close()

    async def _answered(self, client: int, line: bytes) -> dict[str, Any] | None:
        identity: dict[str, Any] = {}
        try:
            request = parse(line)
        except ValueError as error:
            self.malformed += 1
            return {"ok": False, "error": str(error)}
        try:
            identity = {"id": request["id"]} if "id" in request else {}
            if request["do"] == "alive":
                self._ring.mailbox.post([ChannelCommand(client=client, kind=c.ALIVE)])
                return None
            own = getattr(self, f"_do_{request['do']}", None)
            if own is not None:
                answer = await own(client, request)
            elif request["do"] == "fault":  # the first one loads what checks it: meanwhile the others are served
                answer = await self._ask(client, await asyncio.to_thread(commands_of, request))
            else:
                answer = await self._ask(client, commands_of(request))
        except (ValueError, Failure) as error:
            self.refused += 1
            return {**identity, "ok": False, "error": str(error)}
        return {**identity, "ok": "error" not in answer, **answer}

    async def _ask(self, client: int, commands: Sequence[ChannelCommand]) -> dict[str, Any]:
        """Give commands to the loop, and return its answer."""
        self._numbers += 1
        key = (client, self._numbers)
        answers = self._waiting[key] = []
        self._asked.set()
        try:
            if not self._ring.mailbox.post([each._replace(client=client, number=key[1]) for each in commands]):
                return {"error": "too many commands at once: the mailbox is full"}
            end = asyncio.get_running_loop().time() + _ANSWER_S
            while len(answers) < len(commands):
                if self.ended or asyncio.get_running_loop().time() > end:
                    return {"error": "the loop does not answer"}
                await asyncio.sleep(_LOOK_S)
        finally:
            del self._waiting[key]
        refused = [reason(each) for each in answers if each.outcome]
        return {"tick": answers[0].tick} | ({"error": "; ".join(refused)} if refused else {})

    async def _do_hello(self, client: int, request: dict[str, Any]) -> dict[str, Any]:
        if request.get("protocol", PROTOCOL) != PROTOCOL:
            return {"error": f"this run speaks version {PROTOCOL} of the protocol"}
        order = self._order
        shown = {key: order[key] for key in ("bench", "interface", "step_ns", "ring", "pid")}
        return {"protocol": PROTOCOL, "client": client, "lease_s": LEASE_S, **shown}

    async def _do_signals(self, client: int, request: dict[str, Any]) -> dict[str, Any]:
        return {"signals": [{"name": name, "unit": unit} for name, unit in columns()]}

    async def _do_status(self, client: int, request: dict[str, Any]) -> dict[str, Any]:
        row = self._follower.latest()
        values = {name: value for (name, _), value in zip(columns(), row.tolist(), strict=True)}
        owners = {
            name.removeprefix("owner."): c.OWNERS[int(value)]
            for name, value in values.items()
            if name.startswith("owner.")
        }
        status = {name.removeprefix("status."): value for name, value in values.items() if name.startswith("status.")}
        return {
            "tick": int(values["tick"]),
            "status": status,
            "owners": owners,
            "faults": self._faults.listed,
            "clients": len(self._writers),
            "malformed": self.malformed,
            "refused": self.refused,
        }

    async def _do_record(self, client: int, request: dict[str, Any]) -> dict[str, Any]:
        path = request.get("path")
        if not isinstance(path, str) or not Path(path).is_absolute():
            raise ValueError("record: path is an absolute path")
        if self._order["metadata"] is None:
            raise ValueError("record: this installation cannot record: pip install hilplant[recording]")
        if self._ring.recording == 1:
            raise ValueError("record: the run is recorded already")
        from hilplant.recording.recorder import start_late

        cpu = self._order["loop_cpu"]
        self._recorder = await asyncio.to_thread(start_late, self._ring, Path(path), self._order["metadata"], cpu)
        return await self._ask(client, [ChannelCommand(kind=c.RECORDING, value=1.0, text=c.shortened(path))])

    async def _do_record_stop(self, client: int, request: dict[str, Any]) -> dict[str, Any]:
        if self._recorder is None:
            raise ValueError("record_stop: nothing is recorded through this channel")
        answer = await self._ask(client, [ChannelCommand(kind=c.RECORDING, value=0.0)])
        await self.finish_recording()
        return answer

    async def finish_recording(self) -> None:
        """End the recording, if there is one; Failure where it is not complete."""
        recorder, self._recorder = self._recorder, None
        if recorder is not None:
            await asyncio.to_thread(recorder.finish)

    async def _do_subscribe(self, client: int, request: dict[str, Any]) -> dict[str, Any]:
        names, every = request.get("signals"), request.get("every", 1)
        if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
            raise ValueError('subscribe: "signals" is a list of names')
        if not isinstance(every, int) or isinstance(every, bool) or every < 1:
            raise ValueError('subscribe: "every" is a number of ticks, 1 or more')
        places = [0, *(column_of(name) for name in names)]
        task = asyncio.create_task(self._stream(self._writers[client], places, every))
        self._subscriptions.add(task)
        task.add_done_callback(self._subscriptions.discard)
        return {"columns": ["tick", *names]}

    async def _stream(self, writer: asyncio.StreamWriter, places: list[int], every: int) -> None:
        """Send rows for as long as the client listens; one that is too slow loses rows, and is told how many."""
        with contextlib.closing(Follower(self._order["ring"])) as follower, contextlib.suppress(OSError):
            while not (follower.ended or writer.is_closing()):
                rows, _, lost = follower.rows()
                chosen = rows[rows[:, 0] % every == 0][:, places]
                if len(chosen) or lost:
                    _send(writer, {"rows": chosen.tolist(), "lost": lost})
                    await writer.drain()
                await asyncio.sleep(_ROWS_EVERY_S)


def _send(writer: asyncio.StreamWriter, answer: dict[str, Any]) -> None:
    writer.write(json.dumps(answer).encode() + b"\n")


async def keep(order: dict[str, Any]) -> None:
    """Serve clients until the run has ended."""
    door = Door(order)
    ended = asyncio.Event()
    asyncio.get_running_loop().add_reader(sys.stdin.fileno(), ended.set)
    before = os.umask(0o177)  # the socket is its user's alone from the first moment on
    try:
        server = await asyncio.start_unix_server(door.greet, order["socket"], limit=LINE_BYTES)
    finally:
        os.umask(before)
    os.write(sys.stdout.fileno(), b"ready\n")
    following = asyncio.create_task(door.follow())
    await asyncio.wait([following, asyncio.create_task(ended.wait())], return_when=asyncio.FIRST_COMPLETED)
    server.close()
    await door.finish_recording()


def main() -> int:
    """Keep the door of the run that standard input describes."""
    line = sys.stdin.readline()
    if not line:  # the run came to nothing before it had a door to open
        return 0
    order = json.loads(line)
    stand_back(order["loop_cpu"], nice=0)  # it does little, but a command waits for it
    try:
        asyncio.run(keep(order))
    except OSError as error:
        sys.stdout.write(f"{order['socket']}: no channel: {error.strerror or error}\n")
        return 1
    except Failure as failure:
        sys.stderr.write(f"{failure}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
