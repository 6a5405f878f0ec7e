"""One compiled function, from Python to C."""

from typing import Any

from hilplant import jit
from hilplant.c_source import declarations
from hilplant.c_source.c_types import NOTHING, Class, Record, Type, declared_type
from hilplant.c_source.program import Program, Translated, plain
from hilplant.c_source.scope import Scope, Variable, c_name
from hilplant.c_source.statements import INDENT, block
from hilplant.c_source.subset import FunctionSource

_ROUNDS = 5


def translate(program: Program, function: Any, given: tuple[Type, ...]) -> Translated:
    """Return a function in C for these types of arguments."""
    source = _source(function, given)
    kinds = _parameters(source, given)
    returns = declared_type(source.annotations.get("return", Any))
    start = {name: Variable(kind) for name, kind in kinds.items()}
    scope = Scope(program, source, start, returns)
    lines: list[str] = []
    for _ in range(_ROUNDS):  # until no variable has turned out to be of another type
        before = {name: variable.type for name, variable in scope.variables.items()}
        scope.temporaries = 0
        for name, kind in kinds.items():
            scope.variables[name] = Variable(kind, declarations.by_address(name, kind, scope))
        lines = list(block(source.tree.body, scope))
        if before == {name: variable.type for name, variable in scope.variables.items()}:
            break
    returned = scope.returns or NOTHING
    arguments = tuple((name, kind, scope.variables[name].pointer) for name, kind in kinds.items())
    name = program.free_name(_name(function, given), str(source.names.get("__name__", "")).rsplit(".", 1)[-1])
    head = f"static inline {program.use(returned)} {name}({', '.join(_declared(program, arguments))})"
    comment = [f"/* {plain(source.summary)} */"] if source.summary else []
    return Translated(
        name, arguments, returned, "\n".join([*comment, head, "{", *(INDENT + line for line in lines), "}"])
    )


def _source(function: Any, given: tuple[Type, ...]) -> FunctionSource:
    writer = jit.WRITTEN_OUT.get(function)
    if writer is None:
        return FunctionSource.of(function)
    lines, names = writer(*(kind.cls if isinstance(kind, Class | Record) else None for kind in given))
    python = FunctionSource.of(function)
    return FunctionSource.written(function.__name__, ", ".join(python.arguments), lines, names)


def _name(function: Any, given: tuple[Type, ...]) -> str:
    if function not in jit.WRITTEN_OUT:
        return c_name(str(function.__name__))
    kind = next(kind for kind in given if isinstance(kind, Class | Record))
    return f"{function.__name__}_{kind.cls.__name__.lower()}"


def _parameters(source: FunctionSource, given: tuple[Type, ...]) -> dict[str, Type]:
    """Return the parameters' types: those that are declared, else those that are given."""
    if len(given) != len(source.arguments) or source.tree.args.kwonlyargs or source.tree.args.vararg:
        source.fail(source.tree.args, f"takes {len(source.arguments)} arguments by position, not {len(given)}")
    return {
        name: declared_type(source.annotations.get(name, Any)) or kind
        for name, kind in zip(source.arguments, given, strict=True)
    }


def _declared(program: Program, arguments: tuple[tuple[str, Type, bool], ...]) -> list[str]:
    texts = []
    for name, kind, pointer in arguments:
        if not isinstance(kind, Class):
            texts.append(f"{'const ' if pointer else ''}{program.use(kind)} {'*' if pointer else ''}{c_name(name)}")
    return texts or ["void"]
