"""Reads a bus database in any format that cantools knows: DBC, ARXML, KCD, SYM."""

from __future__ import annotations

import codecs
import logging
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from hilplant.bus.frame_layout import CLASSIC_BYTES
from hilplant.bus.lean_import import without_asammdf
from hilplant.bus.sound_dbc import LeftOut, sound_part
from hilplant.bus.sound_sections import sound_sections
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
    return load_sound(path)[0]


def load_sound(path: str | Path) -> tuple[Database, tuple[LeftOut, ...]]:
    """Read a bus database, and say which parts of it were left out because they cannot be read.

    Raises
    ------
    DatabaseError
        In one line, naming the file.

    """
    path = Path(path)
    ending = path.suffix.lower()[1:]
    if ending not in _FORMATS:
        raise DatabaseError(f"{path}: a bus database ends in .{', .'.join(_FORMATS)}")
    try:
        content = path.read_bytes()
    except OSError as error:
        raise DatabaseError(f"{path} cannot be read: {error.strerror}") from error
    try:
        return _parsed(_text(content, ending), ending)
    except _DiagnosticsError:
        raise DatabaseError(f"{path} holds diagnostics, not messages") from None
    except Exception as error:  # cantools' parsers let errors of every kind through
        raise DatabaseError(f"{path} cannot be read as a bus database: {_reason(error)}") from error


def _text(content: bytes, ending: str) -> str:
    """Return a file's text: by its mark where it has one, else as cantools reads the format."""
    if content.startswith(codecs.BOM_UTF8):
        return content.decode("utf-8-sig")
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16")
    return content.decode("cp1252" if ending in ("dbc", "sym") else "utf-8", "replace")


class _DiagnosticsError(Exception):
    """The file is a database of another kind."""


def _parsed(text: str, ending: str) -> tuple[Database, tuple[LeftOut, ...]]:
    """Read a text; of one that is refused, what can be read."""
    try:
        return _strictly(text, ending), ()
    except Exception:
        if ending == "dbc":
            sound, left_out = sound_part(text)
        else:
            sound, left_out = sound_sections(text, ending, lambda part: _refusal(part, ending))
        if not left_out:
            raise
        database = _strictly(sound, ending)
        if not database.messages:
            raise
        return database, tuple(left_out)


def _refusal(text: str, ending: str) -> str:
    """Return why a text cannot be read, nothing when it can."""
    try:
        _strictly(text, ending)
    except Exception as error:  # cantools' parsers let errors of every kind through
        cause = getattr(error, f"e_{ending}", None) or error
        if isinstance(cause, KeyError):
            return f"{cause} is not there"
        return "something that it needs is missing" if isinstance(cause, TypeError) else _reason(cause)
    return ""


def _reason(error: Exception) -> str:
    """Return in one line what a parser says, without what it quotes of the file."""
    return _WITHOUT_CONTENT.sub(r"\1", " ".join(str(error).split())) or type(error).__name__


def _strictly(text: str, ending: str) -> Database:
    logging.getLogger("cantools").setLevel(logging.ERROR)  # it warns of messages that nobody maps
    with without_asammdf():
        from cantools.database import load_string  # a tenth of a second that not every command needs
        from cantools.database.can import Database
    database = load_string(text, database_format=ending, strict=False)
    if not isinstance(database, Database):
        raise _DiagnosticsError
    for message in database.messages:
        message.unused_bit_pattern = 0  # cantools supposes 0xFF where a format does not say
        if message.length > CLASSIC_BYTES and message.protocol != "j1939" and not message.is_container:
            message.is_fd = True  # a DBC need not say so: no classic frame is so long
    return database


@lru_cache(maxsize=8)
def parse_database(text: str, ending: str) -> Database:
    """Read a bus database from its text, as a recording or a loaded bench holds it; `ending` names the format.

    Raises
    ------
    DatabaseError
        When it is none.

    """
    try:
        return _parsed(text.removeprefix("\ufeff"), ending)[0]
    except _DiagnosticsError:
        raise DatabaseError("the bus database holds diagnostics, not messages") from None
    except Exception as error:  # cantools' parsers let errors of every kind through
        raise DatabaseError(f"the bus database cannot be read: {' '.join(str(error).split())}") from error


def database_among(sources: Mapping[str, str]) -> Database | None:
    """Return the bus database among the texts of a bench's files, by their names; None where there is none."""
    for name, text in sources.items():
        ending = Path(name).suffix.lower()[1:]
        if ending in _FORMATS:
            return parse_database(text, ending)
    return None
