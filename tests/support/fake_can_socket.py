"""A CAN socket that answers to order, and a kernel that hands such sockets out."""

import errno
import socket
import struct
from collections import deque
from typing import Any


class FakeSocket:
    """A CAN socket whose next answers are queued: bytes arrive, errors are raised."""

    def __init__(self) -> None:
        self.incoming: deque[bytes | int] = deque()
        self.sent: list[bytes] = []
        self.send_error = self.bind_error = self.pending_error = 0
        self.options: list[tuple[int, int, int]] = []
        self.dropped = 0
        self.stamp_ns: int | None = None

    def setsockopt(self, level: int, name: int, value: int) -> None:
        self.options.append((level, name, value))

    def bind(self, address: tuple[str]) -> None:
        if self.bind_error:
            raise OSError(self.bind_error, "bind")

    def getsockopt(self, level: int, name: int, size: int = 0) -> int | bytes:
        return struct.pack("=9I", *range(8), self.dropped) if size else self.pending_error

    def recv_into(self, buffer: bytearray) -> int:
        answer = self.incoming.popleft() if self.incoming else errno.EAGAIN
        if isinstance(answer, int):
            raise OSError(answer, "recv")
        buffer[: len(answer)] = answer
        return len(answer)

    def recvmsg_into(self, buffers: list[bytearray], size: int) -> tuple[int, list[tuple[int, int, bytes]], int, Any]:
        count = self.recv_into(buffers[0])
        stamps = [] if self.stamp_ns is None else [struct.pack("@ll", *divmod(self.stamp_ns, 10**9))]
        return count, [(socket.SOL_SOCKET, 35, stamp) for stamp in stamps], 0, None

    def send(self, data: bytes) -> int:
        if self.send_error:
            raise OSError(self.send_error, "send")
        self.sent.append(data)
        return len(data)

    def close(self) -> None:
        self.incoming.clear()


class Kernel:
    """Hands out sockets; `make` builds the next one."""

    def __init__(self) -> None:
        self.sockets: list[FakeSocket] = []
        self.bind_error = self.pending_error = 0

    def __call__(self, *_: int) -> FakeSocket:
        made = FakeSocket()
        made.bind_error, made.pending_error = self.bind_error, self.pending_error
        self.sockets.append(made)
        return made


def raw(identifier: int, data: bytes, flags: int = 0, size: int = 16) -> bytes:
    return identifier.to_bytes(4, "little") + bytes([len(data), flags, 0, 0]) + data.ljust(size - 8, b"\xee")
