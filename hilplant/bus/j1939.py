"""Identifiers of SAE J1939: the parameter group, from any sender at any priority (J1939-21, 5.1 and 5.2)."""

from collections.abc import Iterable

#: From this PDU format on an identifier has no destination: SAE J1939-21, 5.2.
BROADCAST = 240
#: Addresses of all, and of nobody: a database that states them leaves the destination open.
GLOBAL, NULL = 255, 254


def parameter_group(identifier: int) -> int:
    """Return the group of a 29-bit identifier: without priority, source, and destination where it has one."""
    group = (identifier >> 8) & 0x3FFFF
    return group if (group >> 8) & 0xFF >= BROADCAST else group & 0x3FF00


def destination(identifier: int) -> int:
    """Return to which address a frame goes; `GLOBAL` for groups that have no destination."""
    return GLOBAL if (identifier >> 16) & 0xFF >= BROADCAST else (identifier >> 8) & 0xFF


class Groups:
    """Messages by their group: a frame of any sender is that message, unless two messages share the group.

    A frame to an address is for the message with that destination, or with one that leaves it open; a frame to all
    is for every message of its group.
    """

    def __init__(self, identifiers: Iterable[int]) -> None:
        self._by_group: dict[int, int | None] = {}
        for identifier in identifiers:
            group = parameter_group(identifier)
            self._by_group[group] = None if group in self._by_group else identifier

    def stated(self, identifier: int) -> int:
        """Return the identifier that the database states for the message of a frame; the frame's own where none is."""
        found = self._by_group.get(parameter_group(identifier))
        if found is None:
            return identifier
        fits = {destination(found), GLOBAL} if destination(found) not in (GLOBAL, NULL) else None
        return found if fits is None or destination(identifier) in fits else identifier
