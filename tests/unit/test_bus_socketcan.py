"""The logic around SocketCAN with a socket that fails to order; the real one is tested on a vcan."""

import errno
import socket
from pathlib import Path
from typing import Any

import pytest
from support.fake_can_socket import FakeSocket, Kernel, raw

from hilplant.bus import arrival, socketcan
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult, Transport, TransportError, open_transport

ARGUMENTS = {"interface": "socketcan", "channel": "can7"}


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Kernel:
    """A kernel without a single CAN interface."""
    made = Kernel()
    monkeypatch.setattr(socket, "socket", made)
    monkeypatch.setattr(socketcan, "_INTERFACES", tmp_path)
    listed = tmp_path / "dev"
    listed.write_text(" face |bytes\n  can7:       0  0\n", encoding="ascii")
    monkeypatch.setattr(socketcan, "_LISTED", listed)
    return made


def opened(kernel: Kernel) -> tuple[Transport, FakeSocket]:
    return open_transport(ARGUMENTS), kernel.sockets[-1]


@pytest.mark.parametrize(
    ("received", "frame"),
    [
        (raw(0x120, b"\x01\x00"), Frame(0x120, b"\x01\x00")),
        (raw(0x8000_0123, bytes(8)), Frame(0x123, bytes(8), extended=True)),
        (raw(0x123, b"ab", 4, 72), Frame(0x123, b"ab", fd=True)),
        (raw(0x9ABC_DEF0, bytes(64), 5, 72), Frame(0x1ABCDEF0, bytes(64), True, True, True)),
        (raw(0x4000_0010, bytes(4)), Frame(0x10, b"", remote=True)),
        (raw(0x2000_0004, bytes(8)), Frame(0x4, bytes(8), error=True)),
    ],
)
def test_the_kernels_frames_are_read_as_what_they_are(kernel: Kernel, received: bytes, frame: Frame) -> None:
    transport, fake = opened(kernel)
    fake.incoming.append(received)
    assert transport.receive(5) == [frame]


@pytest.mark.parametrize(
    ("frame", "sent"),
    [
        (Frame(0x120, b"\x01"), "200100000100000001" + "00" * 7),
        (Frame(0x123, b"", extended=True), "2301008000000000" + "00" * 8),
        (Frame(0x10, b"", remote=True), "1000004000000000" + "00" * 8),
        (Frame(0x123, b"ab", fd=True, bitrate_switch=True), "23010000020100006162" + "00" * 62),
    ],
)
def test_frames_are_written_as_the_kernel_wants_them(kernel: Kernel, frame: Frame, sent: str) -> None:
    transport, fake = opened(kernel)
    assert transport.send(frame) is SendResult.SENT
    assert fake.sent[0].hex() == sent


def test_fd_and_error_frames_are_asked_for(kernel: Kernel) -> None:
    _, fake = opened(kernel)
    assert (socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1) in fake.options
    assert (socket.SOL_CAN_RAW, 2, 0x1FFF_FFFF) in fake.options


def test_no_more_frames_are_taken_than_asked_for(kernel: Kernel) -> None:
    transport, fake = opened(kernel)
    fake.incoming.extend([raw(number, b"") for number in range(5)])
    assert [frame.identifier for frame in transport.receive(3)] == [0, 1, 2]
    assert [frame.identifier for frame in transport.receive(3)] == [3, 4]


@pytest.mark.parametrize(
    ("number", "result", "up"),
    [
        (errno.ENOBUFS, SendResult.FULL, True),
        (errno.EAGAIN, SendResult.FULL, True),
        (errno.EINVAL, SendResult.REFUSED, True),
        (errno.EMSGSIZE, SendResult.REFUSED, True),
        (errno.ENETDOWN, SendResult.DOWN, False),
        (errno.ENXIO, SendResult.DOWN, False),
        (errno.ENODEV, SendResult.DOWN, False),
    ],
)
def test_errors_on_sending_are_results(kernel: Kernel, number: int, result: SendResult, up: bool) -> None:
    transport, fake = opened(kernel)
    fake.send_error = number
    assert (transport.send(Frame(1, b"")), transport.up) == (result, up)


@pytest.mark.parametrize("number", [errno.ENETDOWN, errno.ENODEV])
def test_a_lost_link_keeps_what_had_arrived_and_needs_a_new_socket(kernel: Kernel, number: int) -> None:
    transport, fake = opened(kernel)
    fake.incoming.extend([raw(1, b""), number, raw(2, b"")])
    assert transport.receive(5) == [Frame(1, b"")]
    assert not transport.up
    assert transport.receive(5) == []
    assert transport.send(Frame(1, b"")) is SendResult.DOWN
    kernel.pending_error = errno.ENETDOWN
    assert not transport.reopen()
    kernel.pending_error, kernel.bind_error = 0, errno.ENODEV
    assert not transport.reopen()
    kernel.bind_error = 0
    assert transport.reopen()
    assert transport.up
    assert transport.send(Frame(1, b"")) is SendResult.SENT
    assert len(kernel.sockets[-1].sent) == 1


def test_an_interface_that_is_not_there_is_not_bound_to(kernel: Kernel, tmp_path: Path) -> None:
    """For the kernel would look for a module of its name, which takes root 0.1 s and more."""
    transport, _ = opened(kernel)
    for listed, tried in (("  can70: 0\n vcan7: 0\n", False), ("lo: 0\n can7: 0\n", True)):
        (tmp_path / "dev").write_text(listed, encoding="ascii")
        before = len(kernel.sockets)
        assert transport.reopen() is tried
        assert (len(kernel.sockets) > before) is tried


def test_the_kernels_stamp_tells_how_long_a_frame_has_waited(kernel: Kernel, monkeypatch: pytest.MonkeyPatch) -> None:
    transport, fake = opened(kernel)
    assert (socket.SOL_SOCKET, 35, 1) in fake.options
    monkeypatch.setattr(arrival.time, "time_ns", lambda: 1_700_000_005_250_000_000)
    for stamp_ns, waited_ns in (
        (1_700_000_000_000_000_001, 5_249_999_999),
        (1_700_000_005_250_000_000, 0),
        (1_700_000_009_000_000_000, None),  # the clock was set back
        (None, None),
    ):
        fake.incoming.append(raw(1, b"x"))
        fake.stamp_ns = stamp_ns
        assert transport.receive_late(5) == [(Frame(1, b"x"), waited_ns)]


def test_a_bus_off_frame_is_an_error_frame_and_the_socket_stays_good(kernel: Kernel) -> None:
    transport, fake = opened(kernel)
    fake.incoming.append(raw(0x2000_0040, bytes(8)))
    assert transport.receive(5) == [Frame(0x40, bytes(8), error=True)]
    assert transport.up


def test_what_the_kernel_dropped_is_known_and_outlives_the_socket(kernel: Kernel) -> None:
    transport, fake = opened(kernel)
    fake.dropped = 7
    assert transport.missed == 7
    assert transport.reopen()
    kernel.sockets[-1].dropped = 2
    assert transport.missed == 9


def _no_can(*_: int) -> None:
    raise OSError(errno.EAFNOSUPPORT, "Address family not supported by protocol")


@pytest.mark.parametrize(
    ("arguments", "bind_error", "words"),
    [
        ({"channel": "can7"}, errno.ENODEV, "no CAN interface can7; there is none; .* ip link add can7 type vcan"),
        ({"channel": "can7"}, errno.ENETDOWN, "can7 is down; as root: ip link set can7 up"),
        ({"channel": "can7"}, errno.EPERM, "can7 cannot be opened: .*Errno 1"),
        ({}, 0, "socketcan needs a channel, such as can0"),
        ({"channel": "can7", "bitrate": 5}, 0, "not bitrate; the bit rate is set with 'ip link set can7 type can"),
    ],
)
def test_an_interface_that_cannot_be_opened_says_what_mends_it(
    kernel: Kernel, arguments: dict[str, Any], bind_error: int, words: str
) -> None:
    kernel.bind_error = bind_error
    with pytest.raises(TransportError, match=words) as caught:
        open_transport({"interface": "socketcan", **arguments})
    assert "\n" not in str(caught.value)


def test_the_interfaces_that_exist_are_named(kernel: Kernel, tmp_path: Path) -> None:
    for name, kind in (("can1", "280\n"), ("eth0", "1\n"), ("vcan0", "280\n")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "type").write_text(kind, encoding="ascii")
    kernel.bind_error = errno.ENODEV
    with pytest.raises(TransportError, match="no CAN interface can7; there is can1, vcan0;"):
        open_transport(ARGUMENTS)


def test_a_classic_interface_is_refused_where_fd_is_wanted(kernel: Kernel, tmp_path: Path) -> None:
    (tmp_path / "can7").mkdir()
    mtu = tmp_path / "can7" / "mtu"
    mtu.write_text("16\n", encoding="ascii")
    with pytest.raises(TransportError, match="can7 carries no FD frames"):
        open_transport({**ARGUMENTS, "fd": True})
    mtu.write_text("72\n", encoding="ascii")
    assert open_transport({**ARGUMENTS, "fd": True}).up


def test_a_kernel_without_can_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(socket, "socket", _no_can)
    with pytest.raises(TransportError, match=r"no CAN sockets .* modprobe can-raw; or run .* hilplant vcan COMMAND"):
        open_transport(ARGUMENTS)
