"""What a log of CAN frames holds, its frames, and the texts and bytes that strangers' tools make of them."""

import struct
import zlib
from pathlib import Path

import cantools
import numpy as np

DBC = """VERSION ""
BU_: RIG
BO_ 256 Motor: 4 RIG
 SG_ Amps : 0|16@1- (0.01,0) [-300|300] "A" RIG
 SG_ Volts : 16|16@1+ (0.001,0) [0|40] "V" RIG
BO_ 257 Switch: 1 RIG
 SG_ Park : 0|1@1+ (1,0) [0|1] "" RIG
VAL_ 257 Park 1 "closed" 0 "open" ;
"""
COUNT = 1500
TIME_S = np.arange(COUNT) * 1e-3
VOLTS = np.where(TIME_S < 0.5, 0.0, 12.0)
AMPERES = np.round(np.where(TIME_S < 0.5, 0.0, 2.0 + 0.5 * np.sin(7.0 * TIME_S)), 2)
PARK = ((TIME_S % 0.5) < 0.05).astype(float)
Row = tuple[float, int, bytes]


def rows(database: Path, late_s: float = 0.0, jitter_s: float = 0.0) -> list[Row]:
    """Motor on every millisecond, the switch's frames so much later; each frame waits up to `jitter_s` for the bus."""
    known = cantools.database.load_file(database)
    rng = np.random.default_rng(1)
    motor, switch = (known.get_message_by_name(name) for name in ("Motor", "Switch"))
    found = []
    for tick, time_s in enumerate(TIME_S.tolist()):
        data = motor.encode({"Amps": AMPERES[tick], "Volts": VOLTS[tick]})
        found.append((time_s + rng.uniform(0.0, jitter_s), 256, data))
        if tick % 20 == 0 or PARK[tick] != PARK[tick - 1]:
            found.append((time_s + late_s + rng.uniform(0.0, jitter_s), 257, switch.encode({"Park": int(PARK[tick])})))
    return sorted(found)


HEAD = "date Sat Nov 28 11:08:14.349 am 2026\nbase hex  timestamps absolute\ninternal events logged\n"


def line(time_s: float, identifier: int, data: bytes, channel: int = 1, way: str = "Rx") -> str:
    return f"{time_s:11.6f} {channel}  {identifier:<15X} {way:4} d {len(data)} {data.hex(' ').upper()}\n"


def asc(path: Path, lines: list[str], head: str = HEAD, encoding: str = "utf-8") -> Path:
    path.write_text(head + "".join(lines), encoding)
    return path


def blf_object(row: Row, version: int = 1, size: int | None = None, kind: int = 1) -> bytes:
    time_s, identifier, data = row
    body = struct.pack("<HBBL8s", 1, 0, len(data), identifier, data.ljust(8, b"\0"))
    whole = 32 + len(body)
    head = struct.pack("<4sHHLL", b"LOBJ", 32, version, whole if size is None else size, kind)
    return head + struct.pack("<LHHQ", 2, 0, 0, round(time_s * 1e9)) + body


def blf(path: Path, objects: list[bytes]) -> Path:
    content = b""
    raw = b"".join(objects)
    for part in (raw[: len(raw) // 2 + 5], raw[len(raw) // 2 + 5 :]):  # an object goes on in the next container
        packed = struct.pack("<H6xL4x", 2, len(part)) + zlib.compress(part)
        size = 16 + len(packed)
        content += struct.pack("<4sHHLL", b"LOBJ", 16, 1, size, 10) + packed + b"\0" * (size % 4)
    time = struct.pack("<8H", 2026, 11, 6, 28, 11, 8, 14, 349)
    head = struct.pack("<4sL8BQQLL", b"LOGG", 144, 0, 0, 0, 0, 2, 6, 8, 1, 144 + len(content), 0, len(objects), 0)
    path.write_bytes((head + time + time).ljust(144, b"\0") + content)
    return path
