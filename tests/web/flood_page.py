"""Ten thousand messages of nonsense at the page of a plant that runs: what is refused and counted, and how the loop is.

::

    PYTHONPATH=tests:. python -m web.flood_page
"""

import contextlib
import http.client
import json
import re
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from web.plant_with_page import plant_with_page
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from hilplant.channel.run_files import run_named
from hilplant.runtime.follower import Follower

#: Of each kind; together ten thousand.
MESSAGES, STRANGERS, HUGE = 7500, 500, 500
_NONSENSE = [
    "",
    "[1]",
    "{",
    "null",
    '{"do": 7}',
    '{"do": "set"}',
    '{"do": "log", "file": "../x.csv"}',
    "[" * 60000,
    b"\xff\xfe",
    b"\0" * 4096,
]


def _ask(host: str, path: str, **headers: str) -> int:
    connection = http.client.HTTPConnection(host, timeout=20)
    connection.request("GET", path, headers=headers)
    status = connection.getresponse().status
    connection.close()
    return status


@contextlib.contextmanager
def _socket(host: str, token: str, origin: str | None = None) -> Iterator[ClientConnection]:
    with connect(f"ws://{host}/socket", origin=origin, max_size=None) as socket:  # type: ignore[arg-type]
        socket.send(json.dumps({"token": token}))
        yield socket


def _drain(socket: ClientConnection) -> None:
    with contextlib.suppress(ConnectionClosed):
        for _ in socket:
            pass


def _garbage(host: str, token: str) -> None:
    """Send nonsense, some of it as quickly as can be, some slower than the page's own limit."""
    with _socket(host, token) as socket:
        threading.Thread(target=_drain, args=(socket,), daemon=True).start()
        pause = threading.Event()
        for index in range(MESSAGES):
            socket.send(_NONSENSE[index % len(_NONSENSE)])
            if index < 600:
                pause.wait(0.011)


def _huge(host: str, token: str) -> int:
    """Send what is too large, until the page has ended each connection; return how many it ended."""
    ended = 0
    for _ in range(HUGE):
        with _socket(host, token) as socket:
            socket.send("x" * 70_000)
            try:
                while True:
                    socket.recv(20)
            except ConnectionClosed:
                ended += 1
    return ended


def _strangers(host: str, token: str) -> dict[str, int]:
    """Come with a wrong token, from elsewhere, for another path, under another name; return how many got in."""
    inside = dict.fromkeys(("wrong token", "foreign origin", "outside", "wrong host"), 0)
    for _ in range(STRANGERS):
        with _socket(host, "wrong") as socket, contextlib.suppress(ConnectionClosed):
            inside["wrong token"] += bool(socket.recv(20))
        with contextlib.suppress(InvalidStatus), _socket(host, token, "http://evil.example"):
            inside["foreign origin"] += 1
        inside["outside"] += _ask(host, "/%2e%2e/%2e%2e/etc/passwd") == 200
        inside["wrong host"] += (
            _ask(host, "/api/description", Host="evil.example", Authorization=f"Bearer {token}") == 200
        )
    return inside


def _counts(host: str) -> dict[str, float]:
    connection = http.client.HTTPConnection(host, timeout=20)
    connection.request("GET", "/metrics")
    text = connection.getresponse().read().decode()
    return {name: float(value) for name, value in re.findall(r'^\S*refused\S*\{[^"]*"([^"]+)"\} (\S+)$', text, re.M)}


def _loop(ring: str, seconds: float) -> str:
    follower = Follower(ring)
    late = np.percentile(follower.late_us(round(seconds * 1000)), (50, 99))
    text = f"tick {int(follower.latest()[0])}, late p50 {late[0]:.0f} us, p99 {late[1]:.0f} us"
    follower.close()
    return text


def main() -> None:
    """Flood, and print."""
    with tempfile.TemporaryDirectory() as folder, plant_with_page(Path(folder) / "logs") as plant:
        host, token = plant.url.removeprefix("http://").split("/#token=")
        ring = run_named(str(plant.loop_pid())).ring
        time.sleep(10.0)
        print("before:", _loop(ring, 10.0), flush=True)
        begun = time.monotonic()
        _garbage(host, token)
        inside = _strangers(host, token)
        ended = _huge(host, token)
        seconds = time.monotonic() - begun
        print(f"sent in {seconds:.0f} s: {MESSAGES} messages, 4 x {STRANGERS} strangers, {HUGE} too large")
        print("got in:", inside, "; ended for size:", ended)
        print("refused:", _counts(host))
        print("during:", _loop(ring, min(seconds, 30.0)))
        with _socket(host, token) as socket:
            print("a page is told:", json.loads(socket.recv(20))["told"])
        made = sorted(each.name for each in Path(folder).rglob("*"))
        print("files:", made or "none")
        assert plant.process.poll() is None
        assert not any(inside.values()) and ended == HUGE


if __name__ == "__main__":
    main()
