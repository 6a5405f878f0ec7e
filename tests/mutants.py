"""Changes of a piece of code, one place at a time: operators, numbers, conditions, calls whose answer nobody takes."""

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

_COMPARE = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
_ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.BitAnd: ast.BitOr}


class Mutant(NamedTuple):
    """One change: file, line, how it reads before and after, and the whole text of the changed file."""

    file: Path
    line: int
    before: str
    after: str
    text: str


def changes(node: ast.AST) -> Iterator[None]:
    """Change a node in each way that makes sense, one after the other; it is as before after each."""
    if isinstance(node, ast.Compare):
        for index, operator in enumerate(node.ops):
            if type(operator) in _COMPARE:
                node.ops[index] = _COMPARE[type(operator)]()
                yield
                node.ops[index] = operator
    elif isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        before = node.op
        node.op = _ARITHMETIC[type(before)]()
        yield
        node.op = before
    elif isinstance(node, ast.BoolOp):
        kind = node.op
        node.op = ast.Or() if isinstance(kind, ast.And) else ast.And()
        yield
        node.op = kind
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool | int | float):
        value = node.value
        node.value = not value if isinstance(value, bool) else value + 1
        yield
        node.value = value
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        test = node.test
        node.test = ast.UnaryOp(ast.Not(), test)
        yield
        node.test = test
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        call = node.value
        node.value = ast.Constant(None)  # type: ignore[assignment]
        yield
        node.value = call


def mutants_of(file: Path) -> list[Mutant]:
    """Return every change of a file's functions; annotations, docstrings and constants of the module stay."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    found = []
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for node in dict.fromkeys(inner for function in functions for part in function.body for inner in ast.walk(part)):
        before = ast.unparse(node) if isinstance(node, ast.expr | ast.stmt) else ""
        for _ in changes(node):
            found.append(Mutant(file, getattr(node, "lineno", 0), before, ast.unparse(node), ast.unparse(tree)))
    return found
