"""Statements of the subset, from Python's syntax tree to lines of C."""

import ast
from collections.abc import Callable, Iterator
from typing import Any

from hilplant.c_source import declarations
from hilplant.c_source.c_types import INTEGER, Array, Several, Type, unified
from hilplant.c_source.expression import TIMES, Expression, converted
from hilplant.c_source.expressions import as_type, expression, number, truth
from hilplant.c_source.scope import Scope, Variable, c_name
from hilplant.c_source.subset import assigned_in, names_in

Lines = Iterator[str]
INDENT = "    "


def block(body: list[ast.stmt], scope: Scope) -> Lines:
    """Return the lines of a block."""
    for statement in body:
        for name in declarations.before(statement, body, scope):
            if name in scope.variables:
                yield f"{scope.program.use(scope.variables[name].type)} {c_name(name)};"
        kind = _KINDS.get(type(statement))
        if kind is None:
            scope.source.fail(statement, f"{type(statement).__name__} is not in the subset")
        yield from kind(statement, body, scope)


def _indented(body: list[ast.stmt], scope: Scope) -> Lines:
    for line in block(body, scope):
        yield INDENT + line


def _assign(statement: ast.Assign, body: list[ast.stmt], scope: Scope) -> Lines:
    if len(statement.targets) != 1:
        scope.source.fail(statement, "assigns to several targets")
    yield from _assigned(statement.targets[0], statement.value, statement, body, scope)


def _annotated(statement: ast.AnnAssign, body: list[ast.stmt], scope: Scope) -> Lines:
    if statement.value is None:
        scope.source.fail(statement, "declares without a value")
    yield from _assigned(statement.target, statement.value, statement, body, scope)


def _assigned(target: ast.expr, value: ast.expr, statement: ast.stmt, body: list[ast.stmt], scope: Scope) -> Lines:
    if not isinstance(target, ast.Tuple):
        yield _one(target, expression(value, scope), statement, body, scope)
        return
    if isinstance(value, ast.Tuple):
        yield from _side_by_side(target, value, statement, body, scope)
        return
    whole = expression(value, scope)
    if not isinstance(whole.type, Several) or len(whole.type.parts) != len(target.elts):
        scope.source.fail(statement, f"is not a tuple of {len(target.elts)}")
    result = scope.temporary()
    yield f"const {scope.program.use(whole.type)} {result} = {whole.c};"
    for index, element in enumerate(target.elts):
        if ast.unparse(element) != "_":
            part = Expression(f"{result}.item_{index}", whole.type.parts[index])
            yield _one(element, part, statement, body, scope)


def _side_by_side(
    target: ast.Tuple, value: ast.Tuple, statement: ast.stmt, body: list[ast.stmt], scope: Scope
) -> Lines:
    """Assign part by part; what a later part still reads is kept first."""
    if len(target.elts) != len(value.elts):
        scope.source.fail(statement, "as many values as targets are wanted")
    indices = [names_in(element) for element in target.elts if isinstance(element, ast.Subscript)]
    if set(assigned_in(target)) & set().union(*indices):
        scope.source.fail(statement, "assigns an index and uses it")
    parts: list[Expression] = []
    for index, element in enumerate(value.elts):
        part = expression(element, scope)
        earlier = {ast.unparse(other).split("[")[0] for other in target.elts[:index]}
        if earlier & names_in(element):
            result = scope.temporary()
            yield f"const {scope.program.use(part.type)} {result} = {part.value};"
            part = Expression(result, part.type)
        parts.append(part)
    # those that read what others assign have been kept above, before anything was assigned
    for element, part in zip(target.elts, parts, strict=True):
        yield _one(element, part, statement, body, scope)


def _one(target: ast.expr, value: Expression, statement: ast.stmt, body: list[ast.stmt], scope: Scope) -> str:
    if isinstance(target, ast.Subscript):
        place = expression(target, scope)
        array = expression(target.value, scope).type
        if not isinstance(array, Array) or not array.writable:
            scope.source.fail(statement, "only arrays of the caller that are there to be written are written")
        done = converted(value, place.type)
        if done is None:
            scope.source.fail(statement, f"is {value.type.c}, not a number")
        return f"{place.c} = {done.c};"
    if not isinstance(target, ast.Name):
        scope.source.fail(statement, "only names and elements of arrays are assigned")
    return declarations.assignment(target.id, value, statement, body, scope)


def _augmented(statement: ast.AugAssign, body: list[ast.stmt], scope: Scope) -> Lines:
    target = ast.copy_location(ast.parse(ast.unparse(statement.target), mode="eval").body, statement)
    whole = ast.copy_location(ast.BinOp(target, statement.op, statement.value), statement)
    combined = expression(ast.fix_missing_locations(whole), scope)
    old, new = expression(target, scope), number(statement.value, scope)
    signs = {ast.Add: "+=", ast.Sub: "-=", ast.Mult: "*=", ast.Div: "/="}
    sign = signs.get(type(statement.op))
    if not isinstance(statement.target, ast.Name) or sign is None or combined.type != old.type:
        yield _one(statement.target, combined, statement, body, scope)
    else:
        declarations.met(statement.target.id, combined.type, scope)
        yield f"{old.c} {sign} {new.within(TIMES) if sign == '*=' else new.c};"


def _if(statement: ast.If, _: list[ast.stmt], scope: Scope) -> Lines:
    yield f"if ({truth(statement.test, scope).c}) {{"
    yield from _indented(statement.body, scope)
    if len(statement.orelse) == 1 and isinstance(statement.orelse[0], ast.If):
        first, *rest = block(statement.orelse, scope)
        yield f"}} else {first}"
        yield from rest
        return
    if statement.orelse:
        yield "} else {"
        yield from _indented(statement.orelse, scope)
    yield "}"


def _while(statement: ast.While, _: list[ast.stmt], scope: Scope) -> Lines:
    if statement.orelse:
        scope.source.fail(statement, "a loop has no else")
    yield f"while ({truth(statement.test, scope).c}) {{"
    yield from _indented(statement.body, scope)
    yield "}"


def _for(statement: ast.For, _: list[ast.stmt], scope: Scope) -> Lines:
    """Count as range does: the bounds are those at the start, and the loop's body does not move the counter."""
    loop, target, assigned = statement.iter, statement.target, assigned_in(ast.Module(statement.body, []))
    ranged = isinstance(loop, ast.Call) and scope.known(loop.func) is range and not loop.keywords
    if not ranged or not isinstance(target, ast.Name) or statement.orelse or target.id in set(assigned) - {"_"}:
        scope.source.fail(statement, "only `for NAME in range(...)` without else, and NAME is not assigned inside")
    assert isinstance(loop, ast.Call)
    if target.id != "_" and declarations.outlives(target.id, statement, scope):
        scope.source.fail(statement, f"{target.id} is used outside its loop")
    terms = [as_type(argument, INTEGER, scope) for argument in loop.args]
    step = scope.known(loop.args[2]) if len(terms) == 3 else 1
    if not isinstance(step, int) or step == 0:
        scope.source.fail(statement, "the step of a range is a literal")
    first, last = ("0", terms[0]) if len(terms) == 1 else (terms[0].c, terms[1])
    end = last.c
    if names_in(loop) & set(assigned):
        end = scope.temporary()
        yield f"const int64_t {end} = {last.c};"
    scope.temporaries += target.id == "_"
    counter = f"round_{scope.temporaries}" if target.id == "_" else c_name(target.id)
    scope.variables[target.id] = Variable(INTEGER)
    advance = f"++{counter}" if step == 1 else f"--{counter}" if step == -1 else f"{counter} += {step}"
    yield f"for (int64_t {counter} = {first}; {counter} {'<' if step > 0 else '>'} {end}; {advance}) {{"
    yield from _indented(statement.body, scope)
    yield "}"


def _return(statement: ast.Return, _: list[ast.stmt], scope: Scope) -> Lines:
    if statement.value is None:
        yield "return;"
        return
    value = expression(statement.value, scope)
    before: Type = scope.returns or value.type
    scope.returns = before if converted(value, before) else unified(before, value.type)
    done = converted(value, scope.returns) if scope.returns else None
    if scope.returns is None or done is None:
        scope.source.fail(statement, f"returns {value.type.c}, elsewhere {before.c}")
    scope.program.use(scope.returns)
    yield f"return {done.value};"


def _expression(statement: ast.Expr, _: list[ast.stmt], scope: Scope) -> Lines:
    if isinstance(statement.value, ast.Constant):  # a docstring
        return
    if not isinstance(statement.value, ast.Call):
        scope.source.fail(statement, "does nothing")
    yield f"{expression(statement.value, scope).c};"


def _word(word: str) -> Callable[[Any, list[ast.stmt], Scope], Lines]:
    def lines(_: ast.stmt, __: list[ast.stmt], ___: Scope) -> Lines:
        if word:
            yield f"{word};"

    return lines


_KINDS: dict[type[ast.stmt], Callable[[Any, list[ast.stmt], Scope], Lines]] = {
    ast.Assign: _assign,
    ast.AnnAssign: _annotated,
    ast.AugAssign: _augmented,
    ast.If: _if,
    ast.For: _for,
    ast.While: _while,
    ast.Return: _return,
    ast.Expr: _expression,
    ast.Break: _word("break"),
    ast.Continue: _word("continue"),
    ast.Pass: _word(""),
}
