"""What can be read of a DBC that cantools refuses as a whole: each message and each remark is judged by itself."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import NamedTuple

from hilplant.bus.lean_import import without_asammdf

_BEGINS = re.compile(r"\s*(BO_|SG_|VAL_|SIG_VALTYPE_|SG_MUL_VAL_|CM_|BA_|BA_REL_|BO_TX_BU_|SIG_GROUP_)\s+\S")
_OTHER = re.compile(r"\s*(VERSION|NS_|BS_|BU_|EV_|VAL_TABLE_|BA_DEF\w*|ENVVAR_DATA_|SGTYPE_)\b")
_MESSAGE = re.compile(r"\s*BO_\s+(\d+)\s+([^\s:]+)")
_SIGNAL = re.compile(r"\s*SG_\s+([A-Za-z_]\w*)", re.MULTILINE)
_ABOUT = re.compile(r"\s*(?:(?:VAL_|SIG_VALTYPE_)\s+(\d+)\s+(\S+)|(?:SG_MUL_VAL_|BO_TX_BU_|SIG_GROUP_)\s+(\d+))")
_SYNTAX = re.compile(r"Invalid syntax at line (\d+)")
_REMARK = re.compile(r"\s*(?:CM_|BA_\s+\"[^\"]*\")\s+(?:BO_|SG_)\s+(\d+)")


class LeftOut(NamedTuple):
    """What was not read: a message by its name, or else None, and why."""

    message: str | None
    text: str


def sound_part(text: str) -> tuple[str, list[LeftOut]]:
    """Return a DBC's text without the messages that cannot be read, and without what is said of none."""
    signals: dict[str, set[str]] = {}
    kept: list[str] = []
    out: list[LeftOut] = []
    rest = []
    for line, statement in _statements(text):
        found = _MESSAGE.match(statement)
        if found is None:
            rest.append(statement)
        elif reason := _flaw(statement, line):
            out.append(LeftOut(found[2], reason))
        else:
            signals.setdefault(found[1], set()).update(_SIGNAL.findall(statement))
            kept.append(statement)
    after = len(rest)
    before = next((n for n, each in enumerate(rest) if _ABOUT.match(each) or _REMARK.match(each)), after)
    tail = []
    for statement in rest[before:]:
        if missing := _missing(statement, signals):
            out.append(LeftOut(None, f"{statement.split()[0]} of {missing}, which is not there"))
        else:
            tail.append(statement)
    return "".join([*rest[:before], *kept, *tail]), out


def _statements(text: str) -> Iterator[tuple[int, str]]:
    """Cut a DBC where something new begins, with the number of its first line; signals stay with their message."""
    lines: list[str] = []
    quoted = False
    first = 1
    for number, line in enumerate(text.splitlines(keepends=True), start=1):
        begins = not quoted and (_BEGINS.match(line) or _OTHER.match(line)) and not line.lstrip().startswith("SG_ ")
        if begins and lines:
            yield first, "".join(lines)
            first, lines = number, []
        lines.append(line)
        quoted ^= line.replace('\\"', "").count('"') % 2 == 1
    yield first, "".join(lines)


def _flaw(message: str, line: int) -> str:
    """Return why a message that begins at a line cannot be read, nothing when it can."""
    with without_asammdf():
        from cantools.database.can.formats.dbc import load_string
    try:
        load_string(f'VERSION ""\n{message}\n', strict=False)
    except Exception as error:  # cantools' parser lets errors of every kind through
        said = " ".join(str(error).split()).strip('"')
        if place := _SYNTAX.match(said):
            return f"its syntax is not that of a DBC at line {line + int(place[1]) - 2}"
        return f"{said.rstrip('.')}, at line {line}"
    return ""


def _missing(statement: str, signals: dict[str, set[str]]) -> str:
    """Return the message, or the signal of one, that a statement is about and that is not there."""
    about = _ABOUT.match(statement)
    if about is not None and about[1] is not None and not statement.lstrip().startswith("SG_MUL"):
        if about[1] in signals and about[2] not in signals[about[1]]:
            return f"{about[1]} {about[2]}"
        is_variable = not about[1].isdigit()
        return "" if is_variable or about[1] in signals else f"{about[1]} {about[2]}"
    remark = _REMARK.match(statement)
    number = (about[3] if about is not None else None) or (remark[1] if remark is not None else None)
    return number if number is not None and number not in signals else ""
