"""An expression in C, with its type and how strongly it binds."""

import math
from dataclasses import dataclass

from hilplant.c_source.c_types import BOOLEAN, INTEGER, REAL, Several, Type

#: How strongly C's operators bind; a literal or a call binds most.
PRIMARY, UNARY, TIMES, PLUS, RELATION, EQUAL, AND, OR, CONDITION, ASSIGNMENT = range(10, 0, -1)


@dataclass(frozen=True)
class Expression:
    """Text in C. `parts` are those of a tuple that has not become a struct."""

    c: str
    type: Type
    binds: int = PRIMARY
    parts: tuple["Expression", ...] | None = None
    pointer: bool = False
    place: bool = False  # whether an address may be taken

    def within(self, binds: int) -> str:
        """Return the text, in parentheses where an operator that binds so strongly would tear it apart."""
        return self.c if self.binds >= binds else f"({self.c})"

    @property
    def value(self) -> str:
        """The text of the value itself where this is a pointer to it."""
        return f"*{self.c}" if self.pointer else self.c


def literal(number: float | bool) -> Expression:
    """Return a number as C reads it back, bit for bit."""
    if isinstance(number, bool):
        return Expression("true" if number else "false", BOOLEAN)
    if isinstance(number, int):
        return Expression(str(number), INTEGER, UNARY if number < 0 else PRIMARY)
    if math.isnan(number):
        return Expression("NAN", REAL)
    text = "INFINITY" if math.isinf(number) else repr(abs(number))
    negative = math.copysign(1.0, number) < 0.0
    return Expression(f"-{text}" if negative else text, REAL, UNARY if negative else PRIMARY)


def converted(expression: Expression, wanted: Type) -> Expression | None:
    """Return the expression as the wanted type, or None where it is no such value."""
    if isinstance(wanted, Several) and isinstance(expression.type, Several):
        if expression.parts is None:
            return expression if expression.type == wanted else None
        parts = [converted(*pair) for pair in zip(expression.parts, wanted.parts, strict=True)]
        done = tuple(part for part in parts if part)
        return struct(wanted, done) if len(done) == len(wanted.parts) else None
    if expression.type == wanted:
        return expression
    numbers = (BOOLEAN, INTEGER, REAL)
    if expression.type not in numbers or wanted not in numbers or wanted == BOOLEAN:
        return None
    if numbers.index(expression.type) > numbers.index(wanted):
        return None
    return Expression(expression.c, wanted, expression.binds)  # C converts by itself


def struct(kind: Type, parts: tuple[Expression, ...], names: tuple[str, ...] = ()) -> Expression:
    """Return a struct with these parts, by name where names are given."""
    label = [f".{name} = " for name in names] or [""] * len(parts)
    text = ", ".join(name + part.value for name, part in zip(label, parts, strict=True))
    return Expression(f"({kind.c}){{{text}}}", kind, PRIMARY, place=True)
