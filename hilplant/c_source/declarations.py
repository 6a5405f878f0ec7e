"""Where a variable is declared: Python's belong to the function, C's to a block."""

import ast
from collections.abc import Iterator

from hilplant.c_source.c_types import Record, Type, unified
from hilplant.c_source.expression import Expression, converted
from hilplant.c_source.scope import Scope, Variable, c_name
from hilplant.c_source.subset import names_in


def assignment(name: str, value: Expression, statement: ast.stmt, body: list[ast.stmt], scope: Scope) -> str:
    """Return the line that assigns a variable, and declares it where that is the place for it.

    A record that is found in another one, and is assigned once, is not copied: the variable is its address.
    """
    here = name not in scope.source.arguments and declared_at(name, scope) == (id(body), id(statement))
    once = scope.source.assigned.get(name, 0) == 1
    kind = met(name, value.type, scope)
    done = converted(value, kind)
    if done is None:
        scope.source.fail(statement, f"{name} is {value.type.c}, elsewhere {kind.c}")
    kind_c = scope.program.use(kind)
    if here and once and scope.program.by_address(kind) and (done.place or done.pointer) and "(" not in done.c:
        scope.variables[name] = Variable(kind, pointer=True)
        return f"const {kind_c} *{c_name(name)} = {done.c if done.pointer else '&' + done.c};"
    prefix = ("const " if once else "") + f"{kind_c} " if here else ""
    text = done.value.removeprefix(f"({kind_c})") if here and done.value.startswith(f"({kind_c}){{") else done.value
    return f"{prefix}{c_name(name)} = {text};"


def met(name: str, kind: Type, scope: Scope) -> Type:
    """Return the type of a variable that is given this; a whole number becomes a float where it is both."""
    before = scope.variables.get(name)
    joined = unified(before.type, kind) if before else kind
    if joined is None:
        joined = before.type if before else kind
    if before is None or before.type != joined:
        scope.variables[name] = Variable(joined)
    return joined


def before(statement: ast.stmt, body: list[ast.stmt], scope: Scope) -> Iterator[str]:
    """Return the variables that are declared in front of a statement, without a value yet."""
    source = scope.source
    if body is not source.tree.body:
        return
    for name in source.assigned:
        if name == "_" or name in source.arguments or name in source.counters:
            continue
        if source.first_use[name] is statement and declared_at(name, scope) is None:
            yield name


def declared_at(name: str, scope: Scope) -> tuple[int, int] | None:
    """Return block and statement whose assignment declares a variable, or None when the function must.

    The statement assigns the variable before anything else uses it, and everything else is in its block.
    """
    found = _innermost(scope.source.tree.body, name)
    body, first = found
    assigns = isinstance(first, ast.Assign | ast.AnnAssign) and name in {
        target.id
        for target in ast.walk(ast.Module(list(_targets(first)), []))  # type: ignore[arg-type]
        if isinstance(target, ast.Name)
    }
    return (id(body), id(first)) if assigns else None


def outlives(name: str, loop: ast.For, scope: Scope) -> bool:
    """Return whether a loop's counter is used outside loops that have it as their counter."""
    inside = {id(node) for node in ast.walk(loop)}
    others = {
        id(node)
        for other in ast.walk(scope.source.tree)
        if isinstance(other, ast.For) and isinstance(other.target, ast.Name) and other.target.id == name
        for node in ast.walk(other)
    }
    return any(
        isinstance(node, ast.Name) and node.id == name and id(node) not in inside | others
        for node in ast.walk(scope.source.tree)
    )


def by_address(name: str, kind: Type, scope: Scope) -> bool:
    """Return whether a parameter comes as an address: a big record that is not assigned anew."""
    return isinstance(kind, Record) and scope.program.by_address(kind) and name not in scope.source.assigned


def _targets(statement: ast.Assign | ast.AnnAssign) -> list[ast.expr]:
    return statement.targets if isinstance(statement, ast.Assign) else [statement.target]


def _innermost(body: list[ast.stmt], name: str) -> tuple[list[ast.stmt], ast.stmt]:
    """Return the innermost block that has all that is said of a name, and its first statement that does."""
    using = [statement for statement in body if name in names_in(statement)]
    if len(using) == 1:
        inner = [
            part
            for part in (getattr(using[0], "body", []), getattr(using[0], "orelse", []))
            if isinstance(part, list) and any(name in names_in(statement) for statement in part)
        ]
        head = [node for node in (getattr(using[0], "test", None), getattr(using[0], "iter", None)) if node is not None]
        if len(inner) == 1 and not any(name in names_in(node) for node in head):
            return _innermost(inner[0], name)
    return body, using[0]
