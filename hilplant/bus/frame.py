"""A CAN frame as every part of the project passes it around."""

from typing import NamedTuple


class Frame(NamedTuple):
    """One frame: identifier, payload, and the flags that decide how it is read."""

    identifier: int
    data: bytes
    extended: bool = False
    fd: bool = False
    bitrate_switch: bool = False
    remote: bool = False
    error: bool = False
