"""python-can behind the transport: its virtual interface for real, its failures by stand-ins."""

import logging
import os
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import can
import pytest

from hilplant.bus.frame import Frame
from hilplant.bus.transport import PythonCan, SendResult, Transport, TransportError, open_transport

WIPER = Path(__file__).parents[2] / "dbc" / "wiper.dbc"
CHANNEL = "test_bus_transport"
ARGUMENTS = {"interface": "virtual", "channel": CHANNEL}
GROUP = {"interface": "udp_multicast", "channel": "239.74.163.7", "port": 43127, "fd": True}


@pytest.fixture(params=[ARGUMENTS, GROUP], ids=["virtual", "multicast"])
def pair(request: pytest.FixtureRequest) -> Iterator[tuple[Transport, Transport]]:
    """Two ends of one bus, in memory and on a multicast group."""
    one, other = open_transport(request.param), open_transport(request.param)
    yield one, other
    one.close()
    other.close()


class BrokenBus:
    """Fails in every call with what it is told to."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def recv(self, timeout: float) -> None:
        raise self.error

    def send(self, message: can.Message, timeout: float) -> None:
        raise self.error

    def shutdown(self) -> None:
        raise self.error


@pytest.mark.parametrize(
    "frame",
    [
        Frame(0x120, b"\x01\x00"),
        Frame(0x123, b""),
        Frame(0x1ABCDEF0, bytes(8), extended=True),
        Frame(0x7FF, bytes(64), fd=True),
        Frame(0x7FF, bytes(12), fd=True, bitrate_switch=True),
        Frame(0x10, b"", remote=True),
    ],
)
def test_every_kind_of_frame_arrives_as_it_was_sent(pair: tuple[Transport, Transport], frame: Frame) -> None:
    sender, receiver = pair
    assert sender.send(frame) is SendResult.SENT
    assert receiver.receive(10) == [frame]
    assert sender.receive(10) == []  # nobody hears itself


def test_a_frame_of_another_that_is_like_one_sent_here_arrives(pair: tuple[Transport, Transport]) -> None:
    one, other = pair
    alike = Frame(0x120, b"\x01")
    for sender in (one, other, one):
        sender.send(alike)
    assert (one.receive(10), other.receive(10)) == ([alike], [alike, alike])


def test_no_more_frames_are_taken_than_asked_for(pair: tuple[Transport, Transport]) -> None:
    sender, receiver = pair
    sent = [Frame(number, bytes([number])) for number in range(5)]
    for frame in sent:
        sender.send(frame)
    assert receiver.receive(3) == sent[:3]
    assert receiver.receive(3) == sent[3:]
    assert receiver.receive(3) == []


@pytest.mark.parametrize(("age_s", "known"), [(0.0, True), (5.0, True), (-5.0, False), (1.7e9, False)])
def test_the_drivers_stamp_tells_how_long_a_frame_has_waited_if_it_is_a_time_of_day(
    age_s: float, known: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    transport = PythonCan(ARGUMENTS)
    stamped = [can.Message(arbitration_id=1, data=b"x", is_extended_id=False, timestamp=time.time() - age_s)]
    monkeypatch.setattr(transport._bus, "recv", lambda timeout: stamped.pop() if stamped else None)
    ((frame, waited_ns),) = transport.receive_late(5)
    assert frame == Frame(1, b"x")
    assert (waited_ns is not None) is known
    if waited_ns is not None:
        assert 0 <= waited_ns / 1e9 - age_s < 1.0
    transport.close()


@pytest.mark.parametrize("pair", [ARGUMENTS], indirect=True)
def test_error_frames_are_marked(pair: tuple[Transport, Transport]) -> None:
    _, receiver = pair
    with can.Bus(interface="virtual", channel=CHANNEL) as raw:
        raw.send(can.Message(arbitration_id=4, data=bytes(8), is_error_frame=True))
    (frame,) = receiver.receive(1)
    assert frame.error


@pytest.mark.parametrize(
    ("error", "result"),
    [
        (can.CanOperationError("queue full"), SendResult.FULL),
        (can.CanTimeoutError("late"), SendResult.FULL),
        (ValueError("no FD here"), SendResult.REFUSED),
    ],
)
def test_a_driver_that_does_not_take_a_frame_stays_up(
    error: Exception, result: SendResult, monkeypatch: pytest.MonkeyPatch, pair: tuple[PythonCan, PythonCan]
) -> None:
    sender, _ = pair
    with monkeypatch.context() as patch:
        patch.setattr(sender, "_bus", BrokenBus(error))
        assert (sender.send(Frame(1, b"")), sender.up) == (result, True)


@pytest.mark.parametrize("error", [can.CanOperationError("gone"), OSError("unplugged"), RuntimeError("driver")])
def test_a_device_that_is_gone_is_down_until_it_can_be_opened_again(
    error: Exception, monkeypatch: pytest.MonkeyPatch
) -> None:
    transport = PythonCan(ARGUMENTS)
    monkeypatch.setattr(transport, "_bus", BrokenBus(error))
    assert transport.receive(5) == []
    assert not transport.up
    assert transport.send(Frame(1, b"")) is SendResult.DOWN
    with monkeypatch.context() as patch:
        patch.setattr(can, "Bus", lambda **_: BrokenBus(error).recv(0))
        assert not transport.reopen()
        assert transport.receive(5) == []
        ended()
        assert not transport.up
    assert not transport.reopen()
    ended()
    assert transport.up
    transport.close()
    assert not transport.up


def test_a_driver_that_takes_its_time_to_open_keeps_nobody_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    transport = PythonCan(ARGUMENTS)
    driver, tries, may_open = can.Bus, [], threading.Event()

    def slow(**arguments: Any) -> can.BusABC:
        tries.append(os.sched_getscheduler(0))
        may_open.wait(60.0)
        return driver(**arguments)

    monkeypatch.setattr(can, "Bus", slow)
    monkeypatch.setattr(transport, "_bus", BrokenBus(OSError("unplugged")))
    assert transport.receive(5) == []
    for _ in range(3):
        assert not transport.reopen()
        assert (transport.receive(5), transport.send(Frame(1, b"")), transport.up) == ([], SendResult.DOWN, False)
    may_open.set()
    ended()
    assert transport.up
    assert transport.reopen()
    assert tries == [os.SCHED_OTHER], "one try at a time, at an ordinary priority"
    assert transport.send(Frame(1, b"")) is SendResult.SENT
    transport.close()


def ended() -> None:
    """Wait until no interface is being opened."""
    for thread in threading.enumerate():
        if thread.name == "reopen":
            thread.join(60.0)


def test_what_python_can_logs_stands_in_the_one_line(
    monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    def unavailable(**_: object) -> None:
        logging.getLogger("can.bus").warning("VirtualBus was not properly shut down")  # some other bus
        logging.getLogger("can.kvaser").warning("canlib is\nunavailable")
        raise NameError("name 'canOpen' is not defined")

    monkeypatch.setattr(can, "Bus", unavailable)
    with pytest.raises(TransportError, match=r"opened: name 'canOpen' is not defined; canlib is unavailable$"):
        open_transport({"interface": "kvaser", "channel": 0})
    assert capfd.readouterr().err == ""
    assert logging.getLogger("can").handlers == []


def test_arguments_are_passed_on_as_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: dict[str, Any] = {}
    monkeypatch.setattr(can, "Bus", lambda **arguments: seen.update(arguments))
    arguments = {"interface": "slcan", "channel": "/dev/ttyACM0", "bitrate": 500_000, "ttyBaudrate": 115_200}
    open_transport(arguments)
    assert seen == {**arguments, "ignore_config": True}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "the bus names no interface; there are .*virtual"),
        ({"interface": "socketcant"}, "python-can has no interface 'socketcant'; there are .*socketcan"),
        ({"interface": "slcan", "channel": "/dev/nothing"}, r"slcan \(channel: /dev/nothing\) cannot be opened"),
    ],
)
def test_an_interface_that_cannot_be_opened_is_one_clear_line(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(TransportError, match=words) as caught:
        open_transport(arguments)
    assert "\n" not in str(caught.value)


def test_opening_a_bus_and_a_database_imports_nothing_heavy() -> None:
    program = (
        "import sys; from hilplant.bus import codec, database, transport; "
        f"database.load_database({str(WIPER)!r}); "
        "print(sorted({'asammdf', 'pandas', 'pyarrow', 'numpy', 'canmatrix'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
