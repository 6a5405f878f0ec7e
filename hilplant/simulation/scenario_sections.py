"""The parts of a scenario file that are not inputs of the plant: the driver's stalk, and what is expected."""

from typing import Any

from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.yaml_reader import Document
from hilplant.ecu.stalk import StalkTurn, move_named, wanted
from hilplant.verdicts.binding import Placed
from hilplant.verdicts.written import kind_of


def read_stalk(reading: Reading, document: Document) -> tuple[StalkTurn, ...]:
    """Return the movements of the stalk, `[TIME, POSITION]` each, times rising."""
    turns: list[StalkTurn] = []
    for index, pair in enumerate(_list_at(document, "stalk")):
        if not isinstance(pair, list) or len(pair) != 2:
            continue  # its section has been told so
        time_s, position = pair
        move = move_named(str(position))
        if isinstance(time_s, bool) or not isinstance(time_s, int | float) or not 0.0 <= time_s < float("inf"):
            reading.note(document, ("stalk", index), f"a time is seconds from the first tick on, not {time_s!r}")
        elif move is None:
            reading.note(document, ("stalk", index), f"position must be {wanted()}, not {position!r}")
        elif turns and time_s <= turns[-1].time_s:
            reading.note(document, ("stalk", index), f"time {time_s} s must come after {turns[-1].time_s} s")
        else:
            turns.append(StalkTurn(float(time_s), move))
    return tuple(turns)


def read_expectations(reading: Reading, document: Document) -> tuple[Placed, ...]:
    """Return what is expected, each with its line; the signals' names are checked when a bench is known."""
    found: list[Placed] = []
    for index, entry in enumerate(_list_at(document, "expect")):
        if not isinstance(entry, dict):
            continue
        try:
            kind = kind_of(entry)
        except ValueError as error:
            reading.note(document, ("expect", index), str(error))
            continue
        expected = reading.check(document, ("expect", index), entry, kind)
        if expected is not None:
            found.append(Placed(expected, *document.place(("expect", index))))
    return tuple(found)


def _list_at(document: Document, key: str) -> list[Any]:
    items = document.at((key,))
    return items if isinstance(items, list) else []
