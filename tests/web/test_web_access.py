"""Whoever has not the token, comes from elsewhere, or sends nonsense is refused and counted; the files are served."""

import asyncio
import http.client
import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import pytest
from starlette.requests import Request
from starlette.responses import JSONResponse
from starlette.routing import Route
from web.served import served
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from hilplant.failure import Failure
from hilplant.web.access import Access, AccessLimits, Rate, is_local_name
from hilplant.web.application import Page
from hilplant.web.serving import Address
from hilplant.web.threads import in_thread
from hilplant.web.visitor import Visitor


async def _echo(request: Request) -> JSONResponse:
    return JSONResponse({"got": len(await request.body())})


async def _serve(visitor: Visitor) -> None:
    async for message in visitor.messages():
        await visitor.tell(message)


@pytest.fixture
def access() -> Access:
    return Access(AccessLimits(sockets=2))


@pytest.fixture
def host(access: Access, tmp_path: Path) -> Iterator[str]:
    folder = tmp_path / "page"
    folder.mkdir()
    (folder / "index.html").write_text("<!doctype html><title>here</title>")
    (tmp_path / "secret.txt").write_text("secret")
    with served(Page(folder, [Route("/echo", _echo, methods=["GET", "POST"])], serve=_serve), access) as url:
        yield url.removeprefix("http://").rstrip("/")


def ask(to: str, path: str, body: bytes | None = None, **headers: str) -> tuple[int, http.client.HTTPMessage, bytes]:
    connection = http.client.HTTPConnection(to, timeout=10)
    connection.putrequest("GET" if body is None else "POST", path, skip_host="host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    if body is not None:
        connection.putheader("content-length", str(len(body)))
    connection.endheaders(body)
    answer = connection.getresponse()
    return answer.status, answer.headers, answer.read()


@contextmanager
def open_socket(host: str, token: str, origin: str | None = None) -> Iterator[ClientConnection]:
    with connect(f"ws://{host}/socket", origin=origin) as socket:  # type: ignore[arg-type]
        socket.send(json.dumps({"token": token}))
        yield socket


def until(what: Callable[[], bool]) -> None:
    pause = threading.Event()
    for _ in range(500):
        if what():
            return
        pause.wait(0.02)
    raise AssertionError("not within ten seconds")


def test_files_come_with_a_policy_that_lets_nothing_in_from_elsewhere(host: str) -> None:
    for path in ("/", "/shared/page.css", "/vendor/uPlot.iife.min.js"):
        status, headers, _ = ask(host, path)
        assert status == 200
        assert headers["content-security-policy"].startswith("default-src 'self';")
        assert headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    "path", ["/../secret.txt", "/%2e%2e/secret.txt", "/shared/../../../secret.txt", "//etc/passwd"]
)
def test_nothing_outside_the_folder_is_served(host: str, path: str) -> None:
    status, _, body = ask(host, path)
    assert status in (400, 404) and b"secret" not in body


def test_the_api_wants_the_token_and_its_own_origin(host: str, access: Access) -> None:
    bearer = f"Bearer {access.token}"
    assert ask(host, "/api/echo", authorization=bearer)[0] == 200
    assert ask(host, "/api/echo")[0] == 401
    assert ask(host, "/api/echo", authorization="Bearer wrong")[0] == 401
    assert ask(host, "/api/echo", authorization=bearer, origin=f"http://{host}")[0] == 200
    assert ask(host, "/api/echo", authorization=bearer, origin="http://evil.example")[0] == 403
    assert ask(host, "/api/echo", authorization=bearer, host="evil.example")[0] == 421
    assert access.refused == {"wrong token": 2, "foreign origin": 1, "wrong host": 1}


def test_the_end_of_the_server_waits_for_no_answer(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    begun, answers = threading.Event(), []

    def long(_: object) -> None:
        begun.set()
        threading.Event().wait(60.0)

    async def slow(_: Request) -> JSONResponse:
        return JSONResponse(await in_thread(long, None))

    access = Access()
    with served(Page(tmp_path, [Route("/slow", slow)]), access) as url:
        host, bearer = url.removeprefix("http://").rstrip("/"), f"Bearer {access.token}"
        asking = threading.Thread(target=lambda: answers.append(ask(host, "/api/slow", authorization=bearer)))
        asking.start()
        assert begun.wait(10)
        ended_s = time.monotonic()
    asking.join(10)
    assert time.monotonic() - ended_s < 10.0
    assert [(status, body) for status, _, body in answers] == [(503, b"the server has ended\n")]
    assert [record.exc_info for record in caplog.records] == [None]  # a line, no traceback


def test_what_a_thread_raises_is_raised_where_it_was_asked_for() -> None:
    async def both() -> tuple[int, str]:
        with pytest.raises(Failure, match="wrong") as raised:
            await in_thread(_wrong, "wrong")
        return await in_thread(lambda number: 2 * number, 21), str(raised.value)

    with ThreadPoolExecutor(1) as apart:  # a browser of this session has a loop in the thread of the tests
        assert apart.submit(asyncio.run, both()).result() == (42, "wrong")


def _wrong(text: str) -> None:
    raise Failure(text)


def test_a_body_that_is_too_large_is_refused(host: str, access: Access) -> None:
    bearer = f"Bearer {access.token}"
    assert ask(host, "/api/echo", b"x" * 1000, authorization=bearer)[2] == b'{"got":1000}'
    assert ask(host, "/api/echo", b"x" * ((1 << 20) + 1), authorization=bearer)[0] == 413


def test_a_socket_needs_token_origin_and_room(host: str, access: Access) -> None:
    with open_socket(host, "wrong") as socket, pytest.raises(ConnectionClosed) as closed:
        socket.recv(5)
    assert closed.value.rcvd is not None and closed.value.rcvd.code == 4401
    with pytest.raises(InvalidStatus), open_socket(host, access.token, "http://evil.example"):
        pass
    with open_socket(host, access.token, f"http://{host}") as first, open_socket(host, access.token) as second:
        for socket in (first, second):
            socket.send('{"a": 1}')
            assert json.loads(socket.recv(5)) == {"a": 1}
        with pytest.raises(InvalidStatus), open_socket(host, access.token):
            pass
    assert access.refused == {"wrong token": 1, "foreign origin": 1, "too many pages": 1}


def test_ten_thousand_messages_of_nonsense_are_counted_and_harm_nobody(host: str, access: Access) -> None:
    nonsense = ["", "[1]", "{", "null", "[" * 60000, '"do"', b"\xff\xfe"]
    with open_socket(host, access.token) as good, open_socket(host, access.token) as bad:
        for index in range(10_000):
            bad.send(nonsense[index % len(nonsense)])
        good.send('{"a": 1}')
        assert json.loads(good.recv(30)) == {"a": 1}
        until(lambda: access.refused.total() == 10_000)
        bad.send("x" * 70_000)
        with pytest.raises(ConnectionClosed):
            bad.recv(30)
    until(lambda: access.refused["too large"] == 1)
    assert set(access.refused) == {"malformed", "too quick", "too large"}
    assert access.refused["malformed"] >= 200


def test_what_is_too_large_or_says_nothing_is_counted_as_that(host: str, access: Access) -> None:
    with open_socket(host, access.token) as socket:
        socket.send("x" * 70_000)  # it may overtake the token
        with pytest.raises(ConnectionClosed):
            socket.recv(5)
    until(lambda: access.refused == {"too large": 1})
    with connect(f"ws://{host}/socket"):
        pass
    until(lambda: access.refused == {"too large": 1, "no token": 1})


def test_what_is_too_large_is_counted_where_sending_fails_first(tmp_path: Path) -> None:
    access = Access()

    async def serve(visitor: Visitor) -> None:
        await visitor.tell({})
        await asyncio.sleep(0.3)  # meanwhile the message comes, and the connection is over
        await visitor.tell({})

    with served(Page(tmp_path, serve=serve), access) as url, open_socket(url[7:-1], access.token) as socket:
        socket.recv(5)
        socket.send("x" * 70_000)
        until(lambda: access.refused == {"too large": 1})


def test_a_rate_allows_its_burst_and_then_so_many_a_second() -> None:
    rate = Rate(10.0, 5.0)
    assert [rate.allows(100.0) for _ in range(6)] == [True] * 5 + [False]
    assert [rate.allows(100.25), rate.allows(100.25), rate.allows(100.25)] == [True, True, False]


@pytest.mark.parametrize(
    ("host", "local"),
    [("127.0.0.1:80", True), ("[::1]:80", True), ("localhost:1", True), ("", False), ("a.example:80", False)],
)
def test_names_that_somebody_else_gives_away_are_not_this_machine(host: str, local: bool) -> None:
    assert is_local_name(host) is local


def test_an_address_is_read_or_refused_in_one_line() -> None:
    assert Address.parse("") == Address("127.0.0.1", 8765, False)
    assert Address.parse("9000") == Address("127.0.0.1", 9000, True)
    assert Address.parse("[::1]:9000") == Address("::1", 9000, True)
    for wrong in ("here", "host:", "1:70000"):
        with pytest.raises(Failure, match="is no address for a page"):
            Address.parse(wrong)


def test_a_row_is_sent_at_once() -> None:
    """Nagle's algorithm is off: beside a delayed acknowledgement it keeps every second row back for 40 ms."""

    async def delayed() -> list[int]:
        found: list[int] = []

        def came(_: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            found.append(writer.get_extra_info("socket").getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))
            writer.close()

        listening = Address("127.0.0.1", 0).listen()
        async with await asyncio.start_server(came, sock=listening):
            reader, writer = await asyncio.open_connection(*listening.getsockname())
            await reader.read()
            writer.close()
        return found

    assert asyncio.run(delayed()) == [1]
