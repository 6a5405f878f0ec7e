"""Expressions of the subset, from Python's syntax tree to C."""

import ast
from collections.abc import Callable
from typing import Any

from hilplant.c_source import calls
from hilplant.c_source.c_types import BOOLEAN, INTEGER, REAL, Array, Record, Several, Type, unified
from hilplant.c_source.expression import (
    AND,
    CONDITION,
    EQUAL,
    OR,
    PLUS,
    PRIMARY,
    RELATION,
    TIMES,
    UNARY,
    Expression,
    converted,
    literal,
    struct,
)
from hilplant.c_source.scope import UNKNOWN, Scope

NUMBERS = (BOOLEAN, INTEGER, REAL)
_OPERATORS: dict[type[ast.operator], tuple[str, int]] = {
    ast.Add: ("+", PLUS),
    ast.Sub: ("-", PLUS),
    ast.Mult: ("*", TIMES),
    ast.Div: ("/", TIMES),
}
_RELATIONS: dict[type[ast.cmpop], tuple[str, int]] = {
    ast.Lt: ("<", RELATION),
    ast.LtE: ("<=", RELATION),
    ast.Gt: (">", RELATION),
    ast.GtE: (">=", RELATION),
    ast.Eq: ("==", EQUAL),
    ast.NotEq: ("!=", EQUAL),
}


def expression(node: ast.expr, scope: Scope) -> Expression:
    """Return an expression in C."""
    known = scope.known(node)
    if known is not UNKNOWN:
        return constant(node, known, scope)
    return _KINDS.get(type(node), _unknown)(node, scope)


def _unknown(node: ast.expr, scope: Scope) -> Expression:
    scope.source.fail(node, f"{type(node).__name__} is not in the subset")


def constant(node: ast.expr, known: Any, scope: Scope) -> Expression:
    """Return what the module knows by that name."""
    numeric = isinstance(known, bool | int | float)
    if not numeric and not (isinstance(known, tuple) and hasattr(known, "_fields")):
        scope.source.fail(node, f"a {type(known).__name__} is no number and no record of numbers")
    if not isinstance(node, ast.Name | ast.Attribute) or (
        isinstance(node, ast.Attribute) and scope.module_of(node) == "math"
    ):
        return literal(known)
    name = node.attr if isinstance(node, ast.Attribute) else ast.unparse(node)
    return scope.program.constant(name, scope.module_of(node), known)


def _name(node: ast.Name, scope: Scope) -> Expression:
    return scope.variable(node)


def number(node: ast.expr, scope: Scope) -> Expression:
    """Return an expression that is a number."""
    found = expression(node, scope)
    if found.type not in NUMBERS:
        scope.source.fail(node, "is not a number")
    return found


def truth(node: ast.expr, scope: Scope) -> Expression:
    """Return an expression that is true or false: Python's truth of numbers and records is not translated."""
    found = expression(node, scope)
    if found.type != BOOLEAN:
        scope.source.fail(node, "is not a comparison or a truth value")
    return found


def as_type(node: ast.expr, wanted: Type, scope: Scope) -> Expression:
    """Return an expression as the wanted type."""
    found = expression(node, scope)
    done = converted(found, wanted)
    if done is None:
        scope.source.fail(node, f"is {found.type.c}, not {wanted.c}")
    return done


def _binary(node: ast.BinOp, scope: Scope) -> Expression:
    left, right = number(node.left, scope), number(node.right, scope)
    kind = REAL if REAL in (left.type, right.type) else INTEGER
    if isinstance(node.op, ast.Pow):
        return _power(node, left, scope)
    if isinstance(node.op, ast.Mod):
        function = "float_modulo" if kind == REAL else "integer_modulo"
        return Expression(f"{function}({left.c}, {right.c})", kind)
    if type(node.op) not in _OPERATORS:
        scope.source.fail(node, f"{type(node.op).__name__} is not in the subset")
    sign, binds = _OPERATORS[type(node.op)]
    text = left.within(binds)
    if isinstance(node.op, ast.Div) and kind == INTEGER:
        kind, text = REAL, f"(double){left.within(UNARY)}"
    return Expression(f"{text} {sign} {right.within(binds + 1)}", kind, binds)


def _power(node: ast.BinOp, base: Expression, scope: Scope) -> Expression:
    """Return a power as numba multiplies it: squares, and the product of those that the exponent needs."""
    exponent = scope.known(node.right)
    if base.type != REAL or not isinstance(exponent, int) or not 1 <= exponent <= 4:
        scope.source.fail(node, "the base is not a float, or the exponent no literal from 1 to 4")
    if exponent > 1 and not (base.binds == PRIMARY and isinstance(node.left, ast.Name)):
        scope.source.fail(node, "the base of a power is a name")
    square = f"{base.c} * {base.c}"
    text = {1: base.c, 2: square, 3: f"{base.c} * ({square})", 4: f"({square}) * ({square})"}[exponent]
    return Expression(text, REAL, TIMES)


def _unary(node: ast.UnaryOp, scope: Scope) -> Expression:
    if isinstance(node.op, ast.Not):
        return Expression(f"!{truth(node.operand, scope).within(UNARY)}", BOOLEAN, UNARY)
    operand = number(node.operand, scope)
    if not isinstance(node.op, ast.USub) or operand.type == BOOLEAN:
        scope.source.fail(node, f"{type(node.op).__name__} is not in the subset")
    text = operand.within(UNARY)
    return Expression(f"-({text})" if text.startswith("-") else f"-{text}", operand.type, UNARY)


def _compare(node: ast.Compare, scope: Scope) -> Expression:
    terms, parts = [node.left, *node.comparators], []
    for place, operator in enumerate(node.ops):
        one, other = terms[place], terms[place + 1]
        if isinstance(operator, ast.In) and isinstance(other, ast.Tuple):
            values = [_relation(one, ast.Eq(), value, scope) for value in other.elts]
            parts.append(Expression(" || ".join(values), BOOLEAN, OR))
        else:
            parts.append(Expression(_relation(one, operator, other, scope), BOOLEAN, EQUAL))
    if len(parts) == 1:
        return parts[0]
    return Expression(" && ".join(part.within(EQUAL) for part in parts), BOOLEAN, AND)


def _relation(one: ast.expr, operator: ast.cmpop, other: ast.expr, scope: Scope) -> str:
    if type(operator) not in _RELATIONS:
        scope.source.fail(one, f"{type(operator).__name__} is not in the subset")
    sign, _ = _RELATIONS[type(operator)]
    return f"{number(one, scope).within(PLUS)} {sign} {number(other, scope).within(PLUS)}"


def _both(node: ast.BoolOp, scope: Scope) -> Expression:
    sign, binds = ("&&", AND) if isinstance(node.op, ast.And) else ("||", OR)
    # compilers warn of && within || without parentheses
    parts = [truth(value, scope).within(EQUAL) for value in node.values]
    return Expression(f" {sign} ".join(parts), BOOLEAN, binds)


def _choice(node: ast.IfExp, scope: Scope) -> Expression:
    yes, no = expression(node.body, scope), expression(node.orelse, scope)
    kind = unified(yes.type, no.type)
    if kind is None:
        scope.source.fail(node, f"is {yes.type.c} or {no.type.c}")
    texts = [converted(branch, kind) for branch in (yes, no)]
    scope.program.use(kind)
    first, second = (
        f"*{text.c}" if text.pointer else text.within(OR if at == 0 else CONDITION)
        for at, text in enumerate(texts)
        if text is not None
    )
    return Expression(f"{truth(node.test, scope).within(OR)} ? {first} : {second}", kind, CONDITION)


def _attribute(node: ast.Attribute, scope: Scope) -> Expression:
    base = expression(node.value, scope)
    if not isinstance(base.type, Record):
        scope.source.fail(node, "is no element of a record")
    kind = scope.program.members(base.type.cls).get(node.attr)
    if kind is None:
        scope.source.fail(node, f"{base.type.c} has no {node.attr}, or its type is nowhere declared")
    access = "->" if base.pointer else "."
    return Expression(f"{base.within(PRIMARY)}{access}{node.attr}", kind, PRIMARY, place=base.place or base.pointer)


def _subscript(node: ast.Subscript, scope: Scope) -> Expression:
    if isinstance(node.value, ast.Attribute) and node.value.attr == "shape":
        return _size(node, node.value.value, scope)
    base = expression(node.value, scope)
    if isinstance(base.type, Several):
        place = scope.known(node.slice)
        if not isinstance(place, int) or not 0 <= place < len(base.type.parts):
            scope.source.fail(node, "the place in a tuple is a literal")
        return Expression(f"{base.within(PRIMARY)}.item_{place}", base.type.parts[place])
    if not isinstance(base.type, Array):
        scope.source.fail(node, "is no element of an array")
    return calls.element(node, base, base.type, scope)


def _size(node: ast.Subscript, array: ast.expr, scope: Scope) -> Expression:
    base, place = expression(array, scope), scope.known(node.slice)
    if not isinstance(base.type, Array) or not isinstance(place, int):
        scope.source.fail(node, "is no size of an array")
    fixed = base.type.dimensions[place]
    return literal(fixed) if fixed is not None else Expression(f"{base.c}.size[{place}]", INTEGER)


def _tuple(node: ast.Tuple, scope: Scope) -> Expression:
    parts = tuple(expression(part, scope) for part in node.elts)
    kind = Several(tuple(part.type for part in parts))
    return Expression(struct(kind, parts).c, kind, PRIMARY, parts)


def _call(node: ast.Call, scope: Scope) -> Expression:
    return calls.call(node, scope)


_KINDS: dict[type[ast.expr], Callable[[Any, Scope], Expression]] = {
    ast.Name: _name,
    ast.BinOp: _binary,
    ast.UnaryOp: _unary,
    ast.Compare: _compare,
    ast.BoolOp: _both,
    ast.IfExp: _choice,
    ast.Attribute: _attribute,
    ast.Subscript: _subscript,
    ast.Tuple: _tuple,
    ast.Call: _call,
}
