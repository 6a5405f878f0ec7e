"""What can be read of a KCD, SYM or ARXML that cantools refuses as a whole: its messages are judged one by one.

What is left out becomes blank, so that lines keep their numbers.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple
from xml.parsers import expat

from hilplant.bus.sound_dbc import LeftOut

#: With more flaws than this it is no such file.
MOST_FLAWS = 50
_MESSAGES = {"kcd": "Message", "arxml": "CAN-FRAME-TRIGGERING"}
_REFERENCE = re.compile(rb"<(?:\w+:)?FRAME-REF\b[^>]*>[^<]*?([^</]+)</")
_HEAD = re.compile(r"\{(?P<section>\w+)\}|\[\"?(?P<message>[^\]\"]+)\"?\]|(?:Enum=|Sig=|enum )\"?(?P<entry>[^\s(\"]+)")
#: What stands before the messages of a SYM; each may use those before it.
_SYM_ORDER = {"ENUMS": 0, "SIGNALS": 1}
_NOT_BLANK = re.compile(rb"[^\r\n]")

Refusal = Callable[[str], str]


class _Part(NamedTuple):
    """A message, or an entry that messages use, and its bytes from and to; a SYM has a multiplexer's pages apart."""

    name: str
    is_message: bool
    spans: tuple[tuple[int, int], ...]


class _TooManyError(Exception):
    pass


def sound_sections(text: str, ending: str, refusal: Refusal) -> tuple[str, list[LeftOut]]:
    """Return a file's text without the parts that cannot be read, and these.

    `refusal` tells why a text cannot be read, nothing when it can. Where the rest cannot be read either, nothing is
    left out.
    """
    content = text.encode("utf-8")
    groups = _sym_parts(content) if ending == "sym" else [_elements(content, _MESSAGES[ending])]
    flaws: list[tuple[_Part, str]] = []
    for index, group in enumerate(groups):
        hidden = [*(part for part, _ in flaws), *(part for later in groups[index + 1 :] for part in later)]
        try:
            flaws += _flaws(content, group, hidden, refusal)
        except _TooManyError:
            return text, []
    out = [LeftOut(part.name if part.is_message else None, _told(content, part, reason)) for part, reason in flaws]
    return _without(content, [part for part, _ in flaws]), out


def _flaws(content: bytes, group: Sequence[_Part], hidden: list[_Part], refusal: Refusal) -> list[tuple[_Part, str]]:
    """Return which parts of a group cannot be read beside what is not hidden, and why, by halves."""
    found: list[tuple[_Part, str]] = []

    def search(some: Sequence[_Part]) -> None:
        others = [part for part in group if part not in some]
        reason = refusal(_without(content, [*hidden, *others]))
        if not reason:
            return
        if len(some) <= 1:
            found.extend((part, reason) for part in some)
            if not some or len(found) > MOST_FLAWS:
                raise _TooManyError
            return
        middle = len(some) // 2
        search(some[:middle])
        search(some[middle:])

    search([])
    search(group)
    return found


def _without(content: bytes, parts: Sequence[_Part]) -> str:
    blank = bytearray(content)
    for first, end in (span for part in parts for span in part.spans):
        blank[first:end] = _NOT_BLANK.sub(b" ", content[first:end])
    return blank.decode("utf-8")


def _told(content: bytes, part: _Part, reason: str) -> str:
    what = reason.rstrip(".") if part.is_message else f"{part.name}: {reason.rstrip('.')}"
    line = content.count(b"\n", 0, part.spans[0][0]) + 1
    return what if "at line" in what else f"{what}, at line {line}"


def _sym_parts(content: bytes) -> list[list[_Part]]:
    """Return the enumerations of a SYM, its signals, and its messages: each may use those before."""
    groups: list[dict[tuple[str, str], list[tuple[int, int]]]] = [{}, {}, {}]
    for section, name, span in _sym_entries(content):
        groups[_SYM_ORDER.get(section, 2)].setdefault((section, name), []).append(span)
    return [
        [_Part(name, place == 2, tuple(spans)) for (_, name), spans in group.items()]
        for place, group in enumerate(groups)
    ]


def _sym_entries(content: bytes) -> Iterator[tuple[str, str, tuple[int, int]]]:
    """Tell section, name and bytes of all that a SYM defines."""
    section, name, first, at = "", "", 0, 0
    for line in [*content.splitlines(keepends=True), b"{END}"]:
        head = _HEAD.match(line.decode("utf-8"))
        if head is not None and (head["section"] or head["message"] or section in _SYM_ORDER):
            if name:
                yield section, name, (first, at)
            section = head["section"] or section
            name, first = head["message"] or head["entry"] or "", at
        at += len(line)


def _elements(content: bytes, tag: str) -> list[_Part]:
    """Return the elements of an XML that stand for messages; none where it is no XML."""
    parser, starts, found = expat.ParserCreate(), [0], list[_Part]()
    names = [""]

    def begin(element: str, attributes: dict[str, str]) -> None:
        if element.rsplit(":", maxsplit=1)[-1] == tag:
            starts.append(parser.CurrentByteIndex)
            names.append(attributes.get("name", ""))

    def end(element: str) -> None:
        if element.rsplit(":", maxsplit=1)[-1] == tag and len(starts) > 1:
            closing = re.compile(rb"</%b\s*>" % element.encode("utf-8")).match(content, parser.CurrentByteIndex)
            first, last = starts.pop(), closing.end() if closing else parser.CurrentByteIndex  # <.../> is past already
            reference = _REFERENCE.search(content, first, last)
            name = names.pop() or (reference[1].decode("utf-8") if reference else "")
            found.append(_Part(name, True, ((first, last),)))

    parser.StartElementHandler, parser.EndElementHandler = begin, end
    try:
        parser.Parse(content, True)
    except expat.ExpatError:
        return []
    return found
