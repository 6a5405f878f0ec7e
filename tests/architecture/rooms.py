"""The rooms of the package: what each may import, and a measurement of what it is.

::

    python -m tests.architecture.rooms           # rooms, arrows, circles, lines
    python -m tests.architecture.rooms TREE      # the same of another checkout
    python -m tests.architecture.rooms --write   # draw the picture in docs/architecture.md again
"""

import argparse
import re
import statistics
from pathlib import Path

from .house import House

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "architecture.md"

#: From the bottom to the top: an arrow points to a room of the same layer or of a lower one.
LAYERS: dict[str, str] = {
    "ground": "units failure arrays inlined jit progress atomic_write resources extras declaration signals"
    " vcan companion",
    "physics": "models mechanics control",
    "borders": "checked_yaml bus verdicts faults web",
    "bench": "bench",
    "server": "runtime ecu recording channel",
    "offline": "inventory c_source simulation measurements motor_bench identify train",
    "results": "plots reports testing perf doctor operator_page demo modelling",
    "thesis": "thesis",
    "top": "cli __init__ __main__",
}
_GROUND = "units failure arrays progress atomic_write resources extras declaration signals"
_PHYSICS = f"{_GROUND} jit models mechanics control"
_OFFLINE = f"{_PHYSICS} checked_yaml bus bench runtime ecu recording verdicts faults"
#: What a room may import from, itself apart. A new room says here what it needs, and in LAYERS where it stands.
ARROWS: dict[str, str] = {
    "units": "",
    "failure": "",
    "arrays": "",
    "inlined": "",
    "jit": "inlined",
    "declaration": "",
    "progress": "",
    "vcan": "",
    "atomic_write": "failure",
    "resources": "failure",
    "extras": "failure",
    "companion": "failure",
    "web": "failure extras companion",
    "signals": "units declaration",
    "models": "units declaration signals arrays jit",
    "mechanics": "units declaration signals arrays failure models",
    "control": "units declaration signals arrays failure jit models",
    "checked_yaml": "failure resources",
    "bus": "units declaration signals arrays failure extras",
    "verdicts": "units declaration signals arrays failure checked_yaml",
    "faults": "units declaration signals arrays failure models checked_yaml bus verdicts",
    "bench": f"{_PHYSICS} checked_yaml bus",
    "runtime": "units declaration signals arrays failure jit models control bus faults",
    "ecu": f"{_PHYSICS} checked_yaml bus bench runtime",
    "recording": "units declaration signals arrays failure extras atomic_write jit models bus runtime",
    "channel": (
        "units declaration signals arrays failure extras companion checked_yaml models control faults bench runtime"
        " recording"
    ),
    "inventory": _OFFLINE,
    "c_source": _OFFLINE,
    "simulation": _OFFLINE,
    "measurements": _OFFLINE,
    "motor_bench": f"{_OFFLINE} measurements",
    "identify": f"{_OFFLINE} simulation measurements motor_bench",
    "train": f"{_OFFLINE} simulation",
    "plots": f"{_OFFLINE} measurements simulation identify train",
    "reports": f"{_OFFLINE} identify train plots",
    "perf": f"{_OFFLINE} simulation c_source",
    "testing": f"{_OFFLINE} channel simulation plots",
    "doctor": "extras jit",
    "modelling": (f"{_OFFLINE} simulation measurements motor_bench identify train plots reports inventory web channel"),
    "operator_page": f"{_OFFLINE} simulation channel companion web testing",
    "demo": f"{_OFFLINE} plots channel companion operator_page",
    "thesis": f"{_OFFLINE} simulation measurements motor_bench identify train plots reports perf c_source",
    "__init__": "bench channel checked_yaml simulation",
    "__main__": "cli",
}
#: Imports from all rooms: the command line alone.
FREE = "cli"


def layer_of(name: str) -> int:
    """Return where a room stands, from the bottom.

    Raises
    ------
    KeyError
        For a room that no layer names.

    """
    for height, names in enumerate(LAYERS.values()):
        if name in names.split():
            return height
    raise KeyError(f"no layer names the room {name}: tests/architecture/rooms.py")


def picture(house: House) -> str:
    """Draw layers and arrows in Mermaid; the ground, which nearly all rooms use, is one box."""
    ground = LAYERS["ground"].split()
    lines = ["```mermaid", "flowchart TD"]
    for title, names in reversed(LAYERS.items()):
        shown = [name for name in names.split() if name in house.rooms and not name.startswith("__")]
        if title == "ground":
            lines.append(f'    ground["{", ".join(shown)}"]')
            continue
        lines += [f"    subgraph layer_{title}[{title}]", *(f"        {name}" for name in shown), "    end"]
    arrows = {pair for pair in house.drawn() if not pair[0].startswith("__") and pair[1] not in ground}
    above = {name for name in house.rooms if name not in ground and not name.startswith("__")}
    arrows |= {(name, "ground") for name in above - {name for name, _ in arrows}}
    drawn = [f"    {name} --> {other}" for name, other in sorted(arrows)]
    return "\n".join([*lines, *drawn, "```"])


def sentences(house: House) -> str:
    """Return a table with a sentence for each room, from the top to the bottom."""
    rows = ["| room | what it is |", "|---|---|"]
    for names in reversed(LAYERS.values()):
        for name in names.split():
            if name in house.rooms and not name.startswith("__"):
                rows.append(f"| `{name}` | {house.rooms[name].sentence.removesuffix('.')} |")
    return "\n".join(rows)


def with_drawing(page: str, house: House) -> str:
    """Return the page with picture and table as the sources are now."""
    for mark, text in (("picture", picture(house)), ("rooms", sentences(house))):
        begin, end = f"<!-- {mark} -->", f"<!-- end of {mark} -->"
        page = re.sub(f"{begin}.*?{end}", lambda _, t=text, b=begin, e=end: f"{b}\n{t}\n{e}", page, flags=re.DOTALL)
    return page


def report(house: House) -> str:
    """Return the measurement as text, the biggest room first."""
    files = {name: lines for room in house.rooms.values() for name, lines in room.files.items()}
    arrows = sum(len(room.arrows & house.rooms.keys()) for room in house.rooms.values())
    total = sum(files.values())
    circles = ", ".join(" <-> ".join(sorted(circle)) for circle in house.circles) or "none"
    longest = sorted(files.items(), key=lambda item: -item[1])[:6]
    biggest = max(house.rooms.values(), key=lambda room: room.lines)
    rows = [
        f"{len(files)} files, {total} lines, {len(house.rooms)} rooms, {arrows} arrows, circles: {circles}",
        f"median file {statistics.median(files.values()):g} lines, median function "
        f"{statistics.median(house.functions):g}, longest function {max(house.functions)}",
        f"biggest room: {biggest.name}, {100.0 * biggest.lines / total:.0f} % of the lines",
        f"files over 260 lines: {sum(lines > 260 for lines in files.values())}",
        "longest files: " + ", ".join(f"{name} {lines}" for name, lines in longest),
        "",
    ]
    for room in sorted(house.rooms.values(), key=lambda room: -room.lines):
        rows.append(f"{room.name:14}{len(room.files):4} files{room.lines:6} lines  -> {' '.join(sorted(room.arrows))}")
    return "\n".join(rows)


def main() -> None:
    """Print the measurement of a checkout, or write the picture of this one."""
    parser = argparse.ArgumentParser(prog="python -m tests.architecture.rooms", description=__doc__)
    parser.add_argument("tree", nargs="?", type=Path, default=ROOT, help="a checkout; this one when left out")
    parser.add_argument("--write", action="store_true", help="draw docs/architecture.md again")
    options = parser.parse_args()
    house = House.of(options.tree)
    if options.write:
        PAGE.write_text(with_drawing(PAGE.read_text(encoding="utf-8"), house), encoding="utf-8")
    print(report(house))


if __name__ == "__main__":
    main()
