"""The sources as syntax trees: nothing is imported."""

import ast
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@dataclass(unsafe_hash=True)
class Source:
    """One Python file of the package."""

    path: Path

    @cached_property
    def name(self) -> str:
        return self.path.relative_to(ROOT / "hilplant").as_posix()

    @cached_property
    def room(self) -> str:
        """The folder below the package, or the module's own name at the top."""
        return self.name.split("/")[0].removesuffix(".py")

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.path.read_text(encoding="utf-8"))

    @cached_property
    def imports(self) -> set[str]:
        """Every module named in an import, wherever in the file; a name taken from the package counts as a module."""
        found: set[str] = set()
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Import):
                found |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{self.name}: imports are absolute"
                module = node.module or ""
                found |= {f"{module}.{alias.name}" for alias in node.names} if module == "hilplant" else {module}
        return found

    @cached_property
    def libraries(self) -> set[str]:
        """The top-level packages that the file imports."""
        return {module.split(".")[0] for module in self.imports}

    @cached_property
    def calls(self) -> set[str]:
        """The functions that the file calls by a bare name."""
        nodes = (node.func for node in ast.walk(self.tree) if isinstance(node, ast.Call))
        return {node.id for node in nodes if isinstance(node, ast.Name)}

    @cached_property
    def rooms(self) -> set[str]:
        """The other rooms that this file imports from."""
        modules = {module.split(".")[1] for module in self.imports if module.startswith("hilplant.")}
        return modules - {self.room, "__version__"}

    def attributes_of(self, module: str) -> set[str]:
        """Which attributes of a module the file uses, whatever name it gave the module."""
        names = {
            alias.asname or alias.name
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Import)
            for alias in node.names
            if alias.name == module
        }
        used = {
            node.attr
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in names
        }
        taken = {
            alias.name
            for node in ast.walk(self.tree)
            if isinstance(node, ast.ImportFrom) and node.module == module
            for alias in node.names
        }
        return used | taken

    def attributes_of_dates(self) -> set[str]:
        """Which methods of the classes of the datetime module the file uses."""
        return {
            node.attr
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Attribute) and ast.unparse(node.value).split(".")[-1] in ("datetime", "date")
        }


@pytest.fixture(scope="session")
def root() -> Path:
    return ROOT


@pytest.fixture(scope="session")
def sources() -> list[Source]:
    return [Source(path) for path in sorted((ROOT / "hilplant").rglob("*.py"))]
