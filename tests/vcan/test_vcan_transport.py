"""The SocketCAN transport on real kernel interfaces: frames of every kind, links that go down, up and away."""

import socket
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult, Transport, TransportError, open_transport

pytestmark = pytest.mark.vcan

OWN = "vcan7"


def ip_link(*words: str) -> None:
    subprocess.run(["ip", "link", *words], check=True)


def arrived(receiver: Transport, count: int = 1) -> list[Frame]:
    """Return the next frames; the kernel passes them on in its own time."""
    frames: list[Frame] = []
    deadline = time.monotonic() + 10.0
    while len(frames) < count and time.monotonic() < deadline:
        batch = receiver.receive(64)
        frames += batch
        if not batch:
            time.sleep(0.001)
    return frames


def open_link(channel: str = OWN) -> Transport:
    return open_transport({"interface": "socketcan", "channel": channel})


@pytest.fixture(scope="module")
def own_link() -> Iterator[None]:
    """Take the interface away in the end; a kernel needs its time for that."""
    yield
    subprocess.run(["ip", "link", "delete", OWN], check=False, capture_output=True)


@pytest.fixture
def link(own_link: None) -> str:
    """An interface of these tests' own, because it will be taken down and away."""
    if OWN not in [name for _, name in socket.if_nameindex()]:
        ip_link("add", OWN, "type", "vcan")
    ip_link("set", OWN, "down")
    ip_link("set", OWN, "mtu", "72", "up")
    return OWN


@pytest.fixture
def pair(link: str) -> Iterator[tuple[Transport, Transport]]:
    """Two sockets on one interface."""
    one, other = open_link(link), open_link(link)
    yield one, other
    one.close()
    other.close()


@pytest.mark.parametrize(
    "frame",
    [
        Frame(0x120, b"\x01\x00"),
        Frame(0x123, b""),
        Frame(0x1ABCDEF0, bytes(8), extended=True),
        Frame(0x7FF, bytes(range(64)), fd=True),
        Frame(0x7FF, bytes(12), fd=True, bitrate_switch=True),
        Frame(0x10, b"", remote=True),
    ],
)
def test_every_kind_of_frame_arrives_as_it_was_sent(pair: tuple[Transport, Transport], frame: Frame) -> None:
    sender, receiver = pair
    assert sender.send(frame) is SendResult.SENT
    assert arrived(receiver) == [frame]
    assert sender.receive(10) == []  # nobody hears itself


def test_can_utils_and_the_transport_understand_each_other(link: str) -> None:
    transport = open_link(link)
    with subprocess.Popen(["candump", "-L", "-n", "1", "-T", "5000", link], stdout=subprocess.PIPE, text=True) as dump:
        while _listeners(link) < 2:
            time.sleep(0.001)
        assert transport.send(Frame(0x201, b"\x01")) is SendResult.SENT
        seen, _ = dump.communicate(timeout=10)
    subprocess.run(["cansend", link, "120#0300"], check=True)
    assert arrived(transport) == [Frame(0x120, b"\x03\x00")]
    assert seen.split()[-1] == "201#01"
    transport.close()


def _listeners(link: str) -> int:
    """Return how many sockets listen to every frame of an interface."""
    lines = Path("/proc/net/can/rcvlist_all").read_text(encoding="ascii").splitlines()
    return sum(line.split()[:1] == [link] for line in lines)


def test_error_frames_arrive_and_are_marked(pair: tuple[Transport, Transport], link: str) -> None:
    _, receiver = pair
    subprocess.run(["cansend", link, "20000004#0001000000000000"], check=True)
    (frame,) = arrived(receiver)
    assert (frame.error, frame.identifier) == (True, 0x4)
    assert receiver.up


def test_bus_off_is_an_error_frame_and_the_next_frame_arrives(pair: tuple[Transport, Transport], link: str) -> None:
    sender, receiver = pair
    subprocess.run(["cansend", link, "20000040#0000000000000000"], check=True)
    assert arrived(receiver)[0].error
    sender.send(Frame(1, b"1"))
    assert arrived(receiver) == [Frame(1, b"1")]


def test_a_link_that_goes_down_and_up_ten_times_works_again_each_time(pair: tuple[Transport, Transport]) -> None:
    sender, receiver = pair
    for turn in range(10):
        ip_link("set", OWN, "down")
        assert receiver.receive(10) == []
        assert sender.send(Frame(1, b"")) is SendResult.DOWN
        assert not receiver.up
        assert not sender.up
        assert not receiver.reopen()
        ip_link("set", OWN, "up")
        assert receiver.reopen()
        assert sender.reopen()
        frame = Frame(turn, bytes([turn]))
        assert sender.send(frame) is SendResult.SENT
        assert arrived(receiver) == [frame]


def test_an_interface_that_is_taken_away_and_comes_back_works_again(pair: tuple[Transport, Transport]) -> None:
    sender, receiver = pair
    ip_link("delete", OWN)
    assert receiver.receive(10) == []
    assert not receiver.up
    assert sender.send(Frame(1, b"")) is SendResult.DOWN
    assert not receiver.reopen()
    ip_link("add", OWN, "type", "vcan")
    assert not receiver.reopen()
    ip_link("set", OWN, "up")
    assert receiver.reopen()
    assert sender.reopen()
    assert sender.send(Frame(2, b"2")) is SendResult.SENT
    assert arrived(receiver) == [Frame(2, b"2")]


def test_an_fd_frame_on_a_classic_interface_is_refused_and_the_next_frame_passes(link: str) -> None:
    ip_link("set", link, "down")
    ip_link("set", link, "mtu", "16", "up")
    transport = open_link(link)
    assert transport.send(Frame(1, bytes(12), fd=True)) is SendResult.REFUSED
    assert transport.send(Frame(1, bytes(8))) is SendResult.SENT
    transport.close()
    with pytest.raises(TransportError, match="vcan7 carries no FD frames"):
        open_transport({"interface": "socketcan", "channel": link, "fd": True})


def test_a_burst_waits_in_the_kernel_in_its_order(pair: tuple[Transport, Transport]) -> None:
    sender, receiver = pair
    sent = [Frame(number, number.to_bytes(2, "big")) for number in range(200)]
    assert {sender.send(frame) for frame in sent} == {SendResult.SENT}
    assert arrived(receiver, len(sent)) == sent


def test_interfaces_that_cannot_be_opened_say_what_mends_it(link: str) -> None:
    with pytest.raises(TransportError, match=r"no CAN interface can99; there is .*vcan7.*; .*ip link add can99 type"):
        open_link("can99")
    ip_link("set", link, "down")
    with pytest.raises(TransportError, match="vcan7 is down; as root: ip link set vcan7 up"):
        open_link(link)
