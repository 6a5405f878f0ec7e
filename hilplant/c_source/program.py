"""The whole C text: structs, constants and functions, each once and before its first use."""

import re
import typing
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from hilplant.c_source.c_types import Array, Class, Record, Several, Type, declared_type
from hilplant.c_source.expression import Expression, literal, struct

#: Records of more elements than this go to a function by their address.
BY_VALUE = 4

#: Words that mean something in C, and functions of its library that a name of ours would hide.
RESERVED = frozenset(
    keyword
    for words in (
        "auto break case char const continue default do double else enum extern float for goto if inline int long",
        "register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while",
        "bool true false exp log sin cos tan sqrt floor ceil fmod fabs pow main remainder round",
    )
    for keyword in words.split()
)


@dataclass(frozen=True)
class Translated:
    """A function in C: its name, what it takes, what it returns."""

    c: str
    arguments: tuple[tuple[str, Type, bool], ...]  # name, type, whether by address
    returns: Type
    text: str


@dataclass
class Program:
    """What has been translated so far."""

    translate: Callable[["Program", Any, tuple[Type, ...]], Translated]
    functions: dict[Any, Translated] = field(default_factory=dict)
    structs: dict[str, str] = field(default_factory=dict)
    constants: dict[str, str] = field(default_factory=dict)
    fields: dict[type[Any], dict[str, Type | None]] = field(default_factory=dict)
    open: list[Any] = field(default_factory=list)

    def function(self, function: Any, arguments: tuple[Type, ...]) -> Translated:
        """Return a function in C for these types of arguments, translating it where that is not yet done."""
        key = (function, arguments)
        if key not in self.functions:
            if key in self.open:
                raise RecursionError(f"{function.__name__} calls itself")
            self.open.append(key)
            self.functions[key] = self.translate(self, function, arguments)
            self.open.remove(key)
        return self.functions[key]

    def members(self, record: type[Any]) -> dict[str, Type | None]:
        """Return the elements of a record; None is one whose type the first construction will say."""
        if record not in self.fields:
            hints = typing.get_type_hints(record)
            self.fields[record] = {name: declared_type(hints[name]) for name in record._fields}
        return self.fields[record]

    def size(self, kind: Type) -> int:
        """Return how many numbers a value holds."""
        if isinstance(kind, Record):
            return sum(self.size(part) for part in self.members(kind.cls).values() if part)
        return sum(self.size(part) for part in kind.parts) if isinstance(kind, Several) else 1

    def by_address(self, kind: Type) -> bool:
        """Return whether a function takes this as an address."""
        return isinstance(kind, Record) and self.size(kind) > BY_VALUE

    def use(self, kind: Type) -> str:
        """Return the name of a type, and see to it that it is declared."""
        if kind.c in self.structs or isinstance(kind, Class):
            return kind.c
        if isinstance(kind, Array):
            data = f"{'' if kind.writable else 'const '}{kind.of} *data;"
            self.structs[kind.c] = f"typedef struct {{ {data} int64_t size[{len(kind.dimensions)}]; }} {kind.c};"
        elif isinstance(kind, Record):
            lines = [f"    {self.use(part)} {name};" for name, part in self.members(kind.cls).items() if part]
            summary = plain((kind.cls.__doc__ or "").split("\n")[0])
            self.structs[kind.c] = "\n".join([f"/* {summary} */", "typedef struct {", *lines, f"}} {kind.c};"])
        elif isinstance(kind, Several):
            parts = " ".join(f"{self.use(part)} item_{index};" for index, part in enumerate(kind.parts))
            self.structs[kind.c] = f"typedef struct {{ {parts} }} {kind.c};"
        return kind.c

    def constant(self, name: str, module: str, number: Any) -> Expression:
        """Return a module's constant by its name; two of one name get that of their module in front."""
        value = self.known(number)
        text = re.sub(r"\(\w+\)(?={)", "", value.c)  # with a record's type in front it would be no constant in C
        for candidate in (name.upper(), f"{module}_{name}".upper()):
            declared = f"static const {self.use(value.type)} {candidate} = {text};"
            if self.constants.setdefault(candidate, declared) == declared:
                return Expression(candidate, value.type, place=True)
        raise ValueError(f"{module}.{name} has two values")

    def known(self, number: Any) -> Expression:
        """Return what is known when translating: a number, or a record of numbers."""
        if isinstance(number, bool | int | float):
            return literal(number)
        parts = tuple(self.known(part) for part in number)
        return struct(Record(type(number)), parts)

    def free_name(self, wanted: str, module: str) -> str:
        """Return a name for a function that no other has."""
        taken = {function.c for function in self.functions.values()} | RESERVED
        return wanted if wanted not in taken else f"{module}_{wanted}"


def plain(text: str) -> str:
    """Return a docstring's line without what only the documentation's pages need."""
    return re.sub(r":\w+:`~?([^`]*)`", r"\1", text).replace("``", "`").replace("*/", "* /")
