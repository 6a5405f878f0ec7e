"""Raw SocketCAN: one non-blocking system call for each frame, and the kernel's errors turned into answers."""

import contextlib
import errno
import os
import socket
import struct
from pathlib import Path
from typing import Any

from hilplant.bus.arrival import waited_ns
from hilplant.bus.frame import Frame
from hilplant.bus.interface import SendResult, TransportError
from hilplant.units import SECOND_NS

_HEADER = struct.Struct("=IBBBB")  # identifier with flags, length, FD flags, two reserved bytes
_CLASSIC = struct.Struct("=IB3x8s")
_FD = struct.Struct("=IBB2x64s")
_EXTENDED, _REMOTE, _ERROR = 0x8000_0000, 0x4000_0000, 0x2000_0000
_EXTENDED_MASK, _STANDARD_MASK = 0x1FFF_FFFF, 0x7FF
_ERROR_FILTER = 2  # CAN_RAW_ERR_FILTER of linux/can/raw.h, which the socket module does not always name
_ALL_ERRORS = 0x1FFF_FFFF
_BITRATE_SWITCH = 0x01
_SO_MEMINFO, _MEMINFO = 55, struct.Struct("=9I")  # the last of the nine counts what the kernel dropped
_SO_RCVBUFFORCE = 33
_SO_TIMESTAMPNS, _TIMESPEC = 35, struct.Struct("@ll")  # seconds and nanoseconds of the time of day
_ANCILLARY_BYTES = 64
_RECEIVE_BUFFER = 1 << 22  # bytes; some 5000 frames, as each takes up far more than its content
_FULL = frozenset({errno.ENOBUFS, errno.EAGAIN})
_REFUSED = frozenset({errno.EINVAL, errno.EMSGSIZE})
_INTERFACES = Path("/sys/class/net")
_LISTED = Path("/proc/self/net/dev")  # of this process's network namespace, which /sys need not show
_CAN_DEVICE = "280"  # ARPHRD_CAN
_SETTINGS = ("interface", "channel", "fd")


class SocketCan:
    """A CAN interface of the Linux kernel; see `Transport`."""

    def __init__(self, channel: str) -> None:
        self._channel = channel
        self._buffer = bytearray(_FD.size)
        self._view = memoryview(self._buffer)
        self._socket = _connect(channel)
        self._up = True
        self._missed_before = 0

    @property
    def missed(self) -> int:
        """How many frames the kernel dropped because they were not read in time; a system call."""
        try:
            *_, dropped = _MEMINFO.unpack(self._socket.getsockopt(socket.SOL_SOCKET, _SO_MEMINFO, _MEMINFO.size))
            return self._missed_before + int(dropped)
        except (OSError, struct.error):  # closed, or a kernel before 4.12
            return self._missed_before

    @property
    def up(self) -> bool:
        """Whether frames can pass."""
        return self._up

    def receive(self, limit: int) -> list[Frame]:
        """Return the frames that have arrived, at most `limit`."""
        frames: list[Frame] = []
        while self._up and len(frames) < limit:
            try:
                size = self._socket.recv_into(self._buffer)
            except BlockingIOError:
                break
            except OSError:  # ENETDOWN once when the link goes down, ENODEV when the interface is removed
                self._up = False
                break
            frames.append(self._frame(size))
        return frames

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        """Return the frames that have arrived, with the kernel's word on when; see `Transport`."""
        frames: list[tuple[Frame, int | None]] = []
        while self._up and len(frames) < limit:
            try:
                size, ancillary, _, _ = self._socket.recvmsg_into([self._buffer], _ANCILLARY_BYTES)
            except BlockingIOError:
                break
            except OSError:
                self._up = False
                break
            frames.append((self._frame(size), _waited_ns(ancillary)))
        return frames

    def send(self, frame: Frame) -> SendResult:
        """Hand a frame over to the kernel."""
        if not self._up:
            return SendResult.DOWN
        try:
            self._socket.send(_bytes(frame))
        except OSError as error:
            if error.errno in _FULL:
                return SendResult.FULL
            if error.errno in _REFUSED:
                return SendResult.REFUSED
            self._up = False
            return SendResult.DOWN
        return SendResult.SENT

    def reopen(self) -> bool:
        """Try once, with a new socket: one whose interface was removed never works again.

        Binding to an interface that is not there has the kernel look for a module of its name, which takes a privileged
        caller 0.1 s and more; so it is looked for first.
        """
        self.close()
        if not _there(self._channel):
            return False
        with contextlib.suppress(OSError, TransportError):
            self._socket = _connect(self._channel)
            self._up = True
        return self._up

    def close(self) -> None:
        """Close the socket."""
        self._missed_before = self.missed
        self._up = False
        self._socket.close()

    def _frame(self, size: int) -> Frame:
        identifier, length, flags, _, _ = _HEADER.unpack_from(self._buffer)
        data = bytes(self._view[_HEADER.size : _HEADER.size + length])
        if identifier & _ERROR:  # bus-off too: the socket stays good, and sending tells whether frames can pass
            return Frame(identifier & _EXTENDED_MASK, data, error=True)
        extended = bool(identifier & _EXTENDED)
        number = identifier & (_EXTENDED_MASK if extended else _STANDARD_MASK)
        if size == _FD.size:
            return Frame(number, data, extended, True, bool(flags & _BITRATE_SWITCH))
        if identifier & _REMOTE:
            return Frame(number, b"", extended, remote=True)
        return Frame(number, data, extended)


def wrong_settings(arguments: dict[str, Any]) -> str | None:
    """Return what is wrong with a bench's arguments, whatever interfaces this machine has; None if nothing is."""
    if unknown := [name for name in arguments if name not in _SETTINGS]:
        return (
            f"socketcan takes {', '.join(_SETTINGS)}, not {', '.join(unknown)}; the bit rate is set with "
            f"'ip link set {arguments.get('channel', 'can0')} type can bitrate ...'"
        )
    channel = arguments.get("channel")
    if not isinstance(channel, str) or not channel:
        return f"socketcan needs a channel, such as can0; {_available()}"
    if not isinstance(arguments.get("fd", False), bool):
        return "fd must be true or false"
    return None


def open_socketcan(arguments: dict[str, Any]) -> SocketCan:
    """Open an interface of the kernel from a bench's arguments: `channel`, and `fd` where FD frames must pass.

    Raises
    ------
    TransportError
        With what is there, or the command that fixes it.

    """
    if wrong := wrong_settings(arguments):
        raise TransportError(wrong)
    channel = arguments["channel"]
    try:
        opened = SocketCan(channel)
    except OSError as error:
        raise TransportError(_advice(channel, error)) from error
    if arguments.get("fd") and _mtu(channel) < _FD.size:
        opened.close()
        fix = f"ip link set {channel} down; ip link set {channel} mtu {_FD.size} up"
        raise TransportError(f"{channel} carries no FD frames; if it is able to, as root: {fix}")
    return opened


def _bytes(frame: Frame) -> bytes:
    identifier = frame.identifier | (_EXTENDED if frame.extended else 0)
    if frame.fd:
        flags = _BITRATE_SWITCH if frame.bitrate_switch else 0
        return _FD.pack(identifier, len(frame.data), flags, frame.data)
    return _CLASSIC.pack(identifier | (_REMOTE if frame.remote else 0), len(frame.data), frame.data)


def _connect(channel: str) -> socket.socket:
    """Open a socket; raises OSError, whose advice is left to the start: looking it up reads files."""
    try:
        opened = socket.socket(socket.AF_CAN, socket.SOCK_RAW | socket.SOCK_NONBLOCK, socket.CAN_RAW)
    except (OSError, AttributeError) as error:
        raise TransportError(
            f"this system offers no CAN sockets ({error}); as root: modprobe can-raw; "
            "or run the command in a system of its own that has them: hilplant vcan COMMAND"
        ) from error
    try:
        opened.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
        opened.setsockopt(socket.SOL_CAN_RAW, _ERROR_FILTER, _ALL_ERRORS)
        opened.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        _enlarge(opened)
        opened.bind((channel,))
        failed = opened.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR)
        if failed:  # an interface that is down lets itself be bound
            raise OSError(failed, os.strerror(failed))
    except OSError:
        opened.close()
        raise
    return opened


def _waited_ns(ancillary: list[tuple[int, int, bytes]]) -> int | None:
    """Return how long ago the kernel took a frame in, by its stamp [ns]."""
    for level, kind, data in ancillary:
        if (level, kind) == (socket.SOL_SOCKET, _SO_TIMESTAMPNS) and len(data) == _TIMESPEC.size:
            seconds, nanoseconds = _TIMESPEC.unpack(data)
            return waited_ns(seconds * SECOND_NS + nanoseconds)
    return None


def _enlarge(opened: socket.socket) -> None:
    """Ask for room for a burst; without the right to administer the network, net.core.rmem_max limits it."""
    try:
        opened.setsockopt(socket.SOL_SOCKET, _SO_RCVBUFFORCE, _RECEIVE_BUFFER)
    except PermissionError:
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _RECEIVE_BUFFER)


def _advice(channel: str, error: OSError) -> str:
    if error.errno == errno.ENETDOWN:
        return f"the interface {channel} is down; as root: ip link set {channel} up"
    if error.errno in (errno.ENODEV, errno.ENXIO):
        create = f"ip link add {channel} type vcan; ip link set {channel} up"
        return f"no CAN interface {channel}; {_available()}; for a virtual one, as root: {create}"
    return f"the interface {channel} cannot be opened: {error}; {_available()}"


def _available() -> str:
    """Say which CAN interfaces the kernel has."""
    found = []
    for kind in sorted(_INTERFACES.glob("*/type")):
        with contextlib.suppress(OSError):
            if kind.read_text(encoding="ascii").strip() == _CAN_DEVICE:
                found.append(kind.parent.name)
    return f"there is {', '.join(found)}" if found else "there is none"


def _there(channel: str) -> bool:
    """Whether the kernel has the interface; where it does not tell, suppose so."""
    try:
        return f"{channel}:" in _LISTED.read_text(encoding="ascii", errors="replace").split()
    except OSError:
        return True


def _mtu(channel: str) -> int:
    try:
        return int((_INTERFACES / channel / "mtu").read_text(encoding="ascii"))
    except OSError:  # no sysfs: let the first frame tell
        return _FD.size
