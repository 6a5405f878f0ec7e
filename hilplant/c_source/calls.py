"""Calls, records and elements of arrays, from Python's syntax tree to C."""

import ast
import builtins
import math
from collections.abc import Callable
from typing import Any

from hilplant import jit
from hilplant.c_source import expressions
from hilplant.c_source.c_types import BOOLEAN, INTEGER, REAL, Array, Class, Record, Scalar, Type, is_record
from hilplant.c_source.expression import PLUS, PRIMARY, TIMES, UNARY, Expression, converted, struct
from hilplant.c_source.program import Translated
from hilplant.c_source.scope import UNKNOWN, Scope

#: Functions of C's library that numba calls for those of the same name.
_SAME = (
    math.exp, math.expm1, math.log, math.log1p, math.sqrt, math.copysign, math.sin, math.cos, math.tan, math.asin,
    math.acos, math.atan, math.atan2, math.sinh, math.cosh, math.tanh, math.fabs,
)  # fmt: skip
_MATH: dict[Any, tuple[str, Type]] = {function: (function.__name__, REAL) for function in _SAME}
_MATH |= {math.isfinite: ("isfinite", BOOLEAN), math.isnan: ("isnan", BOOLEAN)}
_TO_INTEGER = {math.floor: "floor", math.ceil: "ceil"}


def call(node: ast.Call, scope: Scope) -> Expression:
    """Return a call: of a record's class, of the math module, of a builtin, or of a compiled function."""
    function = scope.known(node.func)
    if is_record(function):
        return record(node, function, scope)
    if node.keywords or function is UNKNOWN:
        scope.source.fail(node, "only functions that the module knows are called, by position")
    if function in _MATH:
        name, kind = _MATH[function]
        inner = ", ".join(expressions.as_type(argument, REAL, scope).c for argument in node.args)
        return Expression(f"{name}({inner})", kind)
    if function in _TO_INTEGER:
        return Expression(f"(int64_t){_TO_INTEGER[function]}({_only(node, scope).c})", INTEGER, UNARY)
    if function in _BUILTINS:
        return _BUILTINS[function](node, scope)
    if hasattr(function, "py_func") or function in jit.WRITTEN_OUT:
        return compiled(node, function, scope)
    scope.source.fail(node, "is not compiled, and not among the functions that are translated")


def _only(node: ast.Call, scope: Scope) -> Expression:
    if len(node.args) != 1:
        scope.source.fail(node, "takes one argument")
    return expressions.number(node.args[0], scope)


def _absolute(node: ast.Call, scope: Scope) -> Expression:
    number = _only(node, scope)
    return Expression(f"fabs({number.c})" if number.type == REAL else f"llabs({number.c})", number.type)


def _extreme(node: ast.Call, scope: Scope) -> Expression:
    """Return min or max of two, as Python decides: the second where it is less, or greater, than the first."""
    if len(node.args) != 2:
        scope.source.fail(node, "takes two numbers")
    one, other = (expressions.number(argument, scope) for argument in node.args)
    kind = REAL if REAL in (one.type, other.type) else INTEGER
    name = "smaller" if scope.known(node.func) is min else "greater"
    return Expression(f"{name if kind == REAL else name + '_integer'}({one.c}, {other.c})", kind)


def _float(node: ast.Call, scope: Scope) -> Expression:
    number = _only(node, scope)
    return number if number.type == REAL else Expression(f"(double){number.within(UNARY)}", REAL, UNARY)


def _int(node: ast.Call, scope: Scope) -> Expression:
    number = _only(node, scope)
    return number if number.type == INTEGER else Expression(f"(int64_t){number.within(UNARY)}", INTEGER, UNARY)


def _bool(node: ast.Call, scope: Scope) -> Expression:
    return expressions.truth(node.args[0], scope)


_BUILTINS: dict[Any, Callable[[ast.Call, Scope], Expression]] = {
    builtins.abs: _absolute,
    builtins.min: _extreme,
    builtins.max: _extreme,
    builtins.float: _float,
    builtins.int: _int,
    builtins.bool: _bool,
}


def record(node: ast.Call, cls: type[Any], scope: Scope) -> Expression:
    """Return a new record; an element whose type was left open has that of what it is given first."""
    members, given = scope.program.members(cls), dict(zip(cls._fields, node.args, strict=False))
    given |= {keyword.arg: keyword.value for keyword in node.keywords if keyword.arg}
    parts = []
    for name in cls._fields:
        if name not in given:  # compiled Python knows no defaults either
            scope.source.fail(node, f"{name} is not given")
        value = expressions.expression(given[name], scope)
        kind = members[name] or value.type
        members[name] = kind
        done = converted(value, kind)
        if done is None:
            scope.source.fail(node, f"{name} is {value.type.c}, not {kind.c}")
        parts.append(done)
    scope.program.use(Record(cls))
    return struct(Record(cls), tuple(parts), tuple(cls._fields) if node.keywords else ())


def compiled(node: ast.Call, function: Any, scope: Scope) -> Expression:
    """Return a call of a compiled function, which is translated for these types of arguments."""
    given = [_argument(argument, scope) for argument in node.args]
    try:
        target = scope.program.function(function, tuple(argument.type for argument in given))
    except RecursionError as error:
        scope.source.fail(node, str(error))
    return Expression(f"{target.c}({', '.join(_passed(node, given, target, scope))})", target.returns)


def _argument(node: ast.expr, scope: Scope) -> Expression:
    known = scope.known(node)
    return Expression("", Class(known)) if is_record(known) else expressions.expression(node, scope)


def _passed(node: ast.Call, given: list[Expression], target: Translated, scope: Scope) -> list[str]:
    texts = []
    for expression, (name, kind, by_address) in zip(given, target.arguments, strict=True):
        done = converted(expression, kind)
        if done is None:
            scope.source.fail(node, f"{name} is {expression.type.c}, not {kind.c}")
        if not isinstance(kind, Class):
            texts.append(address(done, kind) if by_address else done.value)
    return texts


def address(expression: Expression, kind: Type) -> str:
    """Return where a record is, making room for one that is nowhere yet."""
    if expression.pointer:
        return expression.c
    return f"&{expression.c}" if expression.place else f"({kind.c}[]){{{expression.c}}}"


def element(node: ast.Subscript, base: Expression, kind: Array, scope: Scope) -> Expression:
    """Return an element of an array, a row of it, or what is left of a row; no index is negative."""
    if isinstance(node.slice, ast.Slice):
        return _rest(node, base, kind, scope)
    indices = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
    at = ""
    for place, index in enumerate(indices):
        number = expressions.number(index, scope)
        if number.type != INTEGER or number.c.startswith("-"):
            scope.source.fail(node, "an index is a whole number, not negative")
        fixed = kind.dimensions[place]
        size = f"{base.c}.size[{place}]" if fixed is None else str(fixed)
        joined = f"({at}) * {size}" if " + " in at else f"{at} * {size}"
        at = f"{joined} + {number.within(PLUS)}" if at else number.within(PLUS)
    left = kind.dimensions[len(indices) :]
    if not left:
        return Expression(f"{base.c}.data[{at}]", Scalar(kind.of), PRIMARY, place=True)
    if left != (None,) or len(indices) != 1:
        scope.source.fail(node, "is neither a number nor a row")
    row = Array((None,), kind.writable, kind.of)
    scope.program.use(row)
    first = expressions.number(indices[0], scope).within(TIMES)
    return Expression(f"({row.c}){{{base.c}.data + {first} * {base.c}.size[1], {{{base.c}.size[1]}}}}", row)


def _rest(node: ast.Subscript, base: Expression, kind: Array, scope: Scope) -> Expression:
    cut = node.slice
    assert isinstance(cut, ast.Slice)
    if cut.lower is None or cut.upper is not None or cut.step is not None or len(kind.dimensions) != 1:
        scope.source.fail(node, "only the rest of a row is cut, row[first:]")
    first = expressions.number(cut.lower, scope).within(PLUS)
    return Expression(f"({kind.c}){{{base.c}.data + {first}, {{{base.c}.size[0] - {first}}}}}", kind)
