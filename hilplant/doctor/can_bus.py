"""Examination: CAN in the kernel, interfaces, programs and drivers."""

import ctypes.util
import json
import shutil
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hilplant.doctor.finding import MachineFinding

#: Below this many frames a state frame is easily lost on a busy bus.
WANTED_QUEUE_LENGTH = 100
#: python-can's name of an adapter, and the vendor's library it loads.
DRIVERS = {"pcan": "pcanbasic", "kvaser": "canlib", "vector": "vxlapi64"}


def kernel_family(_root: Path) -> Iterator[MachineFinding]:
    """Open a CAN socket."""
    try:
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except AttributeError:
        yield MachineFinding("SocketCAN", "warn", f"{sys.platform} has none; use another python-can interface")
    except OSError as error:
        what = f"this kernel has no CAN ({error.strerror}); hilplant vcan runs a command in a kernel that has it"
        yield MachineFinding("SocketCAN", "bad", what, "sudo modprobe can-raw")
    else:
        yield MachineFinding("SocketCAN", "ok", "the kernel speaks CAN")


def interfaces(_root: Path) -> Iterator[MachineFinding]:
    """List the CAN interfaces with state, bit rate and queue."""
    links = _links()
    for link in links:
        yield from _interface(link)
    if not links and shutil.which("ip"):
        fix = "sudo modprobe vcan; sudo ip link add vcan0 type vcan; sudo ip link set vcan0 up"
        yield MachineFinding("CAN interface", "warn", "none", fix)


def _links() -> list[dict[str, Any]]:
    if shutil.which("ip") is None:
        return []
    words = ["ip", "-json", "-details", "link", "show"]
    answer = subprocess.run(words, capture_output=True, text=True, timeout=10, check=False).stdout
    return [link for link in json.loads(answer or "[]") if link.get("link_type") == "can"]


def _interface(link: dict[str, Any]) -> Iterator[MachineFinding]:
    name, details = link["ifname"], link.get("linkinfo", {}).get("info_data", {})
    virtual = link.get("linkinfo", {}).get("info_kind") == "vcan"
    up = "UP" in link.get("flags", [])
    bit_rate = details.get("bittiming", {}).get("bitrate", 0)
    controller = details.get("state", "")
    parts = [
        "up" if up else "down",
        *([f"{bit_rate} bit/s"] if bit_rate else []),
        *([controller] if controller else []),
    ]
    options = "" if virtual else " type can bitrate 500000 restart-ms 100"
    fix = "" if up else f"sudo ip link set {name} up{options}"
    healthy = up and controller in ("", "ERROR-ACTIVE")
    yield MachineFinding(name, "ok" if healthy else "warn", ", ".join(parts), fix)
    queue = link.get("txqlen", 0)
    if up and not virtual and queue < WANTED_QUEUE_LENGTH:
        fix = f"sudo ip link set {name} txqueuelen {WANTED_QUEUE_LENGTH * 10}"
        yield MachineFinding(f"{name} queue", "warn", f"holds only {queue} frames: bursts are dropped", fix)


def programs(_root: Path) -> Iterator[MachineFinding]:
    """Look for can-utils and ip."""
    for program, package in (("candump", "can-utils"), ("ip", "iproute2")):
        if shutil.which(program) is None:
            yield MachineFinding(package, "warn", f"{program} is missing", f"sudo apt install {package}")
        else:
            yield MachineFinding(package, "ok", "present")


def adapter_drivers(_root: Path) -> Iterator[MachineFinding]:
    """Look for the vendors' libraries; an adapter used through SocketCAN needs none."""
    present = [name for name, library in DRIVERS.items() if ctypes.util.find_library(library)]
    absent = [name for name in DRIVERS if name not in present]
    what = f"present: {', '.join(present) or 'none'}; absent: {', '.join(absent) or 'none'} (SocketCAN needs none)"
    yield MachineFinding("vendors' drivers", "ok", what)


CHECKS = (kernel_family, interfaces, programs, adapter_drivers)
