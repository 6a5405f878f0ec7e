"""The blocks of an MF4 file: whether all of them are there, which a reader need not notice."""

import struct
from pathlib import Path

#: What each block begins with: its kind, its length and how many links to other blocks follow.
_HEAD = struct.Struct("<4s4xQQ")
#: The block of the header, behind the identification.
_FIRST = 64


def missing_bytes(path: Path) -> int:
    """Return how many bytes at least are missing behind the end of the file; 0 where no block says so.

    A file that its logger did not finish cannot say it: its lengths are not final.
    """
    size = end = path.stat().st_size
    with open(path, "rb") as file:
        if file.read(10) != b"MDF     4.":
            return 0
        seen, waiting = {_FIRST}, [_FIRST]
        while waiting:
            place = waiting.pop()
            end = max(end, place + _HEAD.size)
            if place + _HEAD.size > size:
                continue
            file.seek(place)
            mark, length, links = _HEAD.unpack(file.read(_HEAD.size))
            if mark[:2] != b"##" or length < _HEAD.size + 8 * links:
                continue
            end = max(end, place + length)
            known = file.read(min(8 * links, size))
            found = {link for (link,) in struct.iter_unpack("<Q", known[: len(known) // 8 * 8])} - seen - {0}
            seen |= found
            waiting += found
    return end - size
