"""What names mean within one function that is being translated."""

import ast
import builtins
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from hilplant.c_source.c_types import Class, Type
from hilplant.c_source.expression import Expression
from hilplant.c_source.program import RESERVED, Program
from hilplant.c_source.subset import FunctionSource

#: The answer of :meth:`Scope.known` for what is known at run time only.
UNKNOWN = object()


@dataclass(frozen=True)
class Variable:
    """A parameter or a local variable."""

    type: Type
    pointer: bool = False


@dataclass
class Scope:
    """One function, with the types of its parameters and of the variables that were met so far."""

    program: Program
    source: FunctionSource
    variables: dict[str, Variable]
    returns: Type | None = None
    temporaries: int = 0

    def known(self, node: ast.AST) -> Any:
        """Return what an expression is when it is known in the module: a number, a function, a class."""
        if isinstance(node, ast.Constant):
            return node.value
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) and isinstance(node.operand, ast.Constant):
            return -node.operand.value  # type: ignore[operator]
        if isinstance(node, ast.Attribute):
            base = self.known(node.value)
            return getattr(base, node.attr, UNKNOWN) if isinstance(base, ModuleType) else UNKNOWN
        return self._named(node.id) if isinstance(node, ast.Name) else UNKNOWN

    def _named(self, name: str) -> Any:
        variable = self.variables.get(name)
        if variable is not None:
            return variable.type.cls if isinstance(variable.type, Class) else UNKNOWN
        if name in self.source.assigned or name in self.source.arguments:
            return UNKNOWN
        return self.source.names.get(name, getattr(builtins, name, UNKNOWN))

    def module_of(self, node: ast.expr) -> str:
        """Return in which module a constant stands."""
        base = self.known(node.value) if isinstance(node, ast.Attribute) else UNKNOWN
        name = base.__name__ if isinstance(base, ModuleType) else str(self.source.names.get("__name__", ""))
        return name.rsplit(".", 1)[-1]

    def variable(self, node: ast.Name) -> Expression:
        """Return a variable, whose type is that of what was assigned to it."""
        variable = self.variables.get(node.id)
        if variable is None:
            self.source.fail(node, "is used before it is assigned, or is no name of the module")
        return Expression(c_name(node.id), variable.type, pointer=variable.pointer, place=True)

    def temporary(self) -> str:
        """Return a new name."""
        self.temporaries += 1
        return f"result_{self.temporaries}"


def c_name(name: str) -> str:
    """Return a variable's name in C."""
    return f"{name}_" if name in RESERVED else name
