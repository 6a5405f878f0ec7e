"""Lines of text logs made such that python-can reads them: ASC by Vector's tools, candump's .log, PEAK's .trc.

A line that cannot be read is counted and left out; a last line without its end was cut off while it was written.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain

#: Lines before the first frame in which a header is looked for.
HEAD_LINES = 200
#: Marks an identifier of 29 bits among the names of messages.
EXTENDED = 1 << 31
_ASC_HEAD = ("base hex  timestamps absolute\n", "internal events logged\n")
_ASC_BASE = re.compile(r"base\s+(?P<base>hex|dec)(\s+timestamps\s+(?P<times>absolute|relative))?", re.IGNORECASE)
_ASC_EVENT = re.compile(r"\s*(?P<time>\d+[.,]?\d*)\s+(?P<rest>\S.*)", re.DOTALL)
_ASC_FRAME = re.compile(
    r"(?P<channel>\d+)(?P<gap>\s+)(?P<name>\S+)(?P<way>\s+(Rx|Tx|TxRq)\s)(?P<data>.*)", re.DOTALL | re.IGNORECASE
)


class Lines:
    """Lines for a reader of python-can, which may begin anew behind a line that it could not read.

    Each iteration gives the header again, then goes on where the last one stopped.
    """

    def __init__(self, head: Iterable[str], rest: Iterator[str]) -> None:
        self.head, self.rest = tuple(head), rest
        self.given = 0
        self.closed = False

    def __iter__(self) -> Iterator[str]:
        """Give the header, then the lines that are left."""
        yield from self.head
        for line in self.rest:
            self.given += 1
            yield line

    def close(self) -> None:
        """Do what a reader asks of a file."""
        self.closed = True


def whole_lines(lines: Iterable[str], notes: list[str]) -> Iterator[str]:
    """Give the lines, but not a last one whose end is missing."""
    for line in lines:
        if line.endswith("\n"):
            yield line
        elif line.strip() and not line.lower().startswith("end trigger"):
            notes.append("the last line has no end: the log was cut off there, the line is left out")


def asc_lines(lines: Iterator[str], names: Mapping[str, int], notes: list[str]) -> Lines:
    """Give ASC lines in one form: absolute times, identifiers for the `names` of messages, no requests to send.

    A header line may be missing, or in another language.
    """
    head: list[str] = []
    base, relative = "hex", False
    for line in lines:
        if found := _ASC_BASE.match(line.strip()):
            base, relative = found["base"].lower(), (found["times"] or "").lower() == "relative"
        elif _ASC_EVENT.match(line) or len(head) >= HEAD_LINES:
            head.append(line)
            break
        else:
            head.append(line)
    if relative:
        notes.append("times are relative to the line before: added up")
    first = _ASC_HEAD[0].replace("hex", base), _ASC_HEAD[1]
    return Lines(first, _asc_events(chain(head, lines), base, relative, names))


def _asc_events(lines: Iterable[str], base: str, relative: bool, names: Mapping[str, int]) -> Iterator[str]:
    now_s = 0.0
    for line in lines:
        event = _ASC_EVENT.fullmatch(line)
        if event is None:
            continue
        time_s = float(event["time"].replace(",", "."))
        now_s = now_s + time_s if relative else time_s
        rest = event["rest"]
        if frame := _ASC_FRAME.fullmatch(rest):
            if frame["way"].strip().lower() == "txrq":
                continue  # the request; the frame itself follows as Tx
            name = frame["name"]
            if name in names and not re.fullmatch(r"[0-9A-Fa-f]+x?", name):
                number = names[name]
                written = f"{number & 0x1FFFFFFF:X}" if base == "hex" else str(number & 0x1FFFFFFF)
                name = written + "x" * bool(number & EXTENDED)
                rest = f"{frame['channel']} {name}{frame['way']}{frame['data']}"
        yield f"{now_s:.9f} {rest}"


def trc_lines(lines: Iterator[str]) -> Lines:
    """Give the lines of a .trc file with its header first."""
    head: list[str] = []
    for line in lines:
        if not line.startswith(";"):
            return Lines(head, chain([line], lines))
        head.append(line)
    return Lines(head, iter(()))


def resumed(reader: Iterable[object], lines: Lines, count: Callable[[str], None]) -> Iterator[object]:
    """Give what a reader reads; behind a line that it cannot read it begins again."""
    while True:
        before = lines.given
        try:
            yield from reader
            return
        except Exception as error:  # the readers of python-can let errors of every kind through
            if lines.given == before:
                raise
            count(str(error) or type(error).__name__)
