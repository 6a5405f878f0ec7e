"""Reads a bus database in any format that cantools knows: DBC, ARXML, KCD, SYM."""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from hilplant.bus.lean_import import without_asammdf
from hilplant.failure import Failure

if TYPE_CHECKING:
    from cantools.database.can import Database

_FORMATS = ("dbc", "arxml", "kcd", "sym")
#: What a parser says, up to where it quotes the file.
_WITHOUT_CONTENT = re.compile(r"(\bat line \d+, column \d+):.*")


class DatabaseError(Failure):
    """A bus database that cannot be read."""


def load_database(path: str | Path) -> Database:
    """Read a bus database.

    It is not read strictly: real matrices have signals that overlap; only mapped messages need to be sound.

    Raises
    ------
    DatabaseError
        In one line, naming the file.

    """
    logging.getLogger("cantools").setLevel(logging.ERROR)  # it warns of messages that nobody maps
    path = Path(path)
    if path.suffix.lower()[1:] not in _FORMATS:
        raise DatabaseError(f"{path}: a bus database ends in .{', .'.join(_FORMATS)}")
    with without_asammdf():
        from cantools.database import load_file  # a tenth of a second that not every command needs
        from cantools.database.can import Database
    try:
        database = load_file(str(path), strict=False)
    except OSError as error:
        raise DatabaseError(f"{path} cannot be read: {error.strerror}") from error
    except Exception as error:  # cantools' parsers let errors of every kind through
        reason = _WITHOUT_CONTENT.sub(r"\1", " ".join(str(error).split())) or type(error).__name__
        raise DatabaseError(f"{path} cannot be read as a bus database: {reason}") from error
    if not isinstance(database, Database):
        raise DatabaseError(f"{path} holds diagnostics, not messages")
    return database


@lru_cache(maxsize=8)
def parse_database(text: str, ending: str) -> Database:
    """Read a bus database from its text, as a recording or a loaded bench holds it; `ending` names the format.

    Raises
    ------
    DatabaseError
        When it is none.

    """
    with without_asammdf():
        from cantools.database import load_string
        from cantools.database.can import Database
    try:
        database = load_string(text, database_format=ending, strict=False)
    except Exception as error:  # cantools' parsers let errors of every kind through
        raise DatabaseError(f"the bus database cannot be read: {' '.join(str(error).split())}") from error
    if not isinstance(database, Database):
        raise DatabaseError("the bus database holds diagnostics, not messages")
    return database


def database_among(sources: Mapping[str, str]) -> Database | None:
    """Return the bus database among the texts of a bench's files, by their names; None where there is none."""
    logging.getLogger("cantools").setLevel(logging.ERROR)
    for name, text in sources.items():
        ending = Path(name).suffix.lower()[1:]
        if ending in _FORMATS:
            return parse_database(text, ending)
    return None
