"""What the translation takes, and the error for what it does not."""

import ast
import inspect
import textwrap
import typing
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NoReturn

from hilplant.failure import Failure


class NotInSubset(Failure):
    """Compiled Python that has no translation; the text names file, line and what is missing."""


@dataclass(frozen=True)
class FunctionSource:
    """One Python function that is to be translated; `names` are those that it takes from its module."""

    file: str
    tree: ast.FunctionDef
    names: dict[str, Any]
    annotations: dict[str, Any]

    @classmethod
    def of(cls, function: Callable[..., Any]) -> "FunctionSource":
        """Read a function's text; `function` is not compiled, or the Python in a compiled one."""
        python = getattr(function, "py_func", function)
        lines, first = inspect.getsourcelines(python)
        tree = ast.parse(textwrap.dedent("".join(lines))).body[0]
        assert isinstance(tree, ast.FunctionDef)
        ast.increment_lineno(tree, first - 1)
        names = {**python.__globals__, **inspect.getclosurevars(python).nonlocals}
        return cls(python.__code__.co_filename, tree, names, typing.get_type_hints(python))

    @classmethod
    def written(cls, name: str, head: str, lines: list[str], names: dict[str, Any]) -> "FunctionSource":
        """Return the function that is written for the records among its arguments."""
        tree = ast.parse("\n    ".join([f"def {name}({head}):", *lines])).body[0]
        assert isinstance(tree, ast.FunctionDef)
        return cls(f"<{name}>", tree, names, {})

    def fail(self, node: ast.AST, what: str) -> NoReturn:
        """Say that a construct is not translated."""
        where = f"{Path(self.file).name}:{getattr(node, 'lineno', self.tree.lineno)}"
        shown = ast.unparse(node).splitlines()[0]
        raise NotInSubset(
            f"{where}: in {self.tree.name}: `{shown}`: {what}; translated are scalars, NamedTuples, "
            "arrays of floats, if, for over range, and math"
        )

    @property
    def arguments(self) -> list[str]:
        """Names of the parameters, in their order."""
        return [argument.arg for argument in self.tree.args.args]

    @cached_property
    def assigned(self) -> dict[str, int]:
        """How often each name is assigned in the function."""
        return assigned_in(self.tree)

    @cached_property
    def first_use(self) -> dict[str, ast.stmt]:
        """The first statement of the function's own block in which each name stands."""
        found: dict[str, ast.stmt] = {}
        for statement in self.tree.body:
            for name in names_in(statement):
                found.setdefault(name, statement)
        return found

    @cached_property
    def counters(self) -> set[str]:
        """Names that count a loop."""
        loops = (node for node in ast.walk(self.tree) if isinstance(node, ast.For))
        return {loop.target.id for loop in loops if isinstance(loop.target, ast.Name)}

    @property
    def summary(self) -> str:
        """The first line of the docstring."""
        return (ast.get_docstring(self.tree) or "").split("\n")[0]


def assigned_in(node: ast.AST) -> dict[str, int]:
    """Return how often each name is assigned below a node."""
    found: dict[str, int] = {}
    for inner in ast.walk(node):
        if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store):
            found[inner.id] = found.get(inner.id, 0) + 1
    return found


def names_in(node: ast.AST) -> set[str]:
    """Return the names that stand below a node."""
    return {inner.id for inner in ast.walk(node) if isinstance(inner, ast.Name)}
