"""The types that a translated function may use, and how each is written in C."""

import types
from dataclasses import dataclass
from typing import Annotated, Any, get_args, get_origin


@dataclass(frozen=True)
class Scalar:
    """A number or a truth value."""

    c: str


REAL, INTEGER, BOOLEAN, NOTHING = Scalar("double"), Scalar("int64_t"), Scalar("bool"), Scalar("void")


@dataclass(frozen=True)
class Array:
    """Numbers in row-major order; a dimension that is not known here is None."""

    dimensions: tuple[int | None, ...]
    writable: bool = False
    of: str = "double"

    @property
    def c(self) -> str:
        """A name that says shape and access."""
        fixed = "".join("n" if size is None else str(size) for size in self.dimensions)
        return f"{'Writable' if self.writable else ''}{'Array' if self.of == 'double' else 'Integers'}_{fixed}"


@dataclass(frozen=True)
class Record:
    """A NamedTuple; a struct in C."""

    cls: type[Any]

    @property
    def c(self) -> str:
        """The class's own name."""
        return self.cls.__name__


@dataclass(frozen=True)
class Several:
    """What a function returns where it returns a tuple; a struct without names in C."""

    parts: tuple["Type", ...]

    @property
    def c(self) -> str:
        """A name made of those of the parts."""
        return "_".join(part.c for part in self.parts)


@dataclass(frozen=True)
class Class:
    """A NamedTuple's class as an argument: known when translating, and gone in C."""

    cls: type[Any]
    c: str = ""


Type = Scalar | Array | Record | Several | Class


def is_record(cls: Any) -> bool:
    """Return whether this is a NamedTuple's class."""
    return isinstance(cls, type) and issubclass(cls, tuple) and hasattr(cls, "_fields")


def declared_type(annotation: Any) -> Type | None:
    """Return the type that an annotation says, or None where it leaves it open."""
    if get_origin(annotation) is Annotated:
        return declared_type(get_args(annotation)[0])
    if get_origin(annotation) is tuple:
        parts = [declared_type(part) for part in get_args(annotation)]
        return Several(tuple(part for part in parts if part)) if all(parts) else None
    if is_record(annotation):
        return Record(annotation)
    return {float: REAL, int: INTEGER, bool: BOOLEAN, None: NOTHING, types.NoneType: NOTHING}.get(annotation)


def unified(one: Type, other: Type) -> Type | None:
    """Return the type that holds values of both, or None when there is none."""
    if one == other:
        return one
    if isinstance(one, Scalar) and isinstance(other, Scalar):
        order = [BOOLEAN, INTEGER, REAL]
        return max(one, other, key=order.index) if one in order and other in order else None
    if isinstance(one, Several) and isinstance(other, Several) and len(one.parts) == len(other.parts):
        parts = [unified(*pair) for pair in zip(one.parts, other.parts, strict=True)]
        return Several(tuple(part for part in parts if part)) if all(parts) else None
    return None
