"""The rooms of a checkout with their files, lines and arrows, read as text: nothing is imported."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path


@dataclass
class Room:
    """A folder of the package, or a module at its top: its files with their lines, and its arrows."""

    name: str
    sentence: str = ""
    files: dict[str, int] = field(default_factory=dict)
    arrows: set[str] = field(default_factory=set)

    @property
    def lines(self) -> int:
        """Lines of all files."""
        return sum(self.files.values())


@dataclass
class House:
    """All rooms of a checkout."""

    rooms: dict[str, Room]
    functions: list[int]

    @classmethod
    def of(cls, tree: Path) -> "House":
        """Read the package of a checkout, as text."""
        package, rooms, functions = tree / "hilplant", dict[str, Room](), list[int]()
        for path in sorted(package.rglob("*.py")):
            relative = path.relative_to(package)
            name = relative.parts[0].removesuffix(".py")
            text = path.read_text(encoding="utf-8")
            parsed = ast.parse(text)
            room = rooms.setdefault(name, Room(name))
            room.files[relative.as_posix()] = len(text.splitlines())
            room.arrows |= imported_rooms(parsed) - {name}
            if len(relative.parts) == 1 or relative.as_posix() == f"{name}/__init__.py":
                room.sentence = (ast.get_docstring(parsed) or "").split("\n")[0]
            functions += [
                node.end_lineno - node.lineno + 1
                for node in ast.walk(parsed)
                if isinstance(node, ast.FunctionDef) and node.end_lineno
            ]
        return cls(rooms, functions)

    @cached_property
    def reach(self) -> dict[str, set[str]]:
        """The rooms that each room needs, directly or through others."""
        reach = {name: set(room.arrows & self.rooms.keys()) for name, room in self.rooms.items()}
        changed = True
        while changed:
            changed = False
            for name, far in reach.items():
                wider = far.union(*(reach[other] for other in far))
                changed |= wider != far
                reach[name] = wider
        return reach

    @property
    def circles(self) -> list[set[str]]:
        """Rooms that need each other."""
        found = [{n for n in far if name in self.reach[n]} for name, far in self.reach.items() if name in far]
        return [circle for index, circle in enumerate(found) if circle not in found[:index]]

    def drawn(self) -> Iterator[tuple[str, str]]:
        """Yield the arrows that do not follow from others."""
        for name, room in self.rooms.items():
            direct = room.arrows & self.rooms.keys()
            for other in sorted(direct):
                if not any(other in self.reach[between] for between in direct - {other}):
                    yield name, other


def imported_rooms(parsed: ast.Module) -> set[str]:
    """Return the rooms that a file imports from, wherever in it."""
    found: set[str] = set()
    for node in ast.walk(parsed):
        if isinstance(node, ast.ImportFrom) and node.module == "hilplant":
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("hilplant."):
            found.add(str(node.module).split(".")[1])
        elif isinstance(node, ast.Import):
            found |= {alias.name.split(".")[1] for alias in node.names if alias.name.startswith("hilplant.")}
    return found - {"__version__"}
