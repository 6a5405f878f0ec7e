"""The optional libraries: which extra of the package brings them, and the one line for a command that misses one."""

from importlib.util import find_spec
from typing import NamedTuple

from hilplant.failure import Failure


class Extra(NamedTuple):
    """What needs an extra, in the plural, and the libraries that it brings, as in pyproject.toml."""

    purpose: str
    libraries: tuple[str, ...]


EXTRAS = {
    "dask": Extra("Dask clusters", ("distributed",)),
    "demo": Extra("recording and plot of the demo", ("matplotlib", "pyarrow")),
    "identify": Extra("measurements", ("cma", "jinja2", "matplotlib", "pyarrow", "uncertainties")),
    "mcap": Extra("MCAP files", ("mcap",)),
    "mdf": Extra("MF4 files", ("asammdf",)),
    "plot": Extra("pictures", ("matplotlib",)),
    "recording": Extra("recordings and Parquet files", ("pyarrow",)),
    "testing": Extra("tests of an ECU", ("jinja2", "matplotlib", "pyarrow")),
    "train": Extra("trained models and their reports", ("matplotlib", "threadpoolctl")),
    "udp": Extra("CAN frames by UDP multicast", ("msgpack",)),
    "web": Extra("pages in a browser", ("starlette", "uvicorn", "websockets")),
}


def missing(extra: str) -> list[str]:
    """Return the libraries of an extra that are not installed."""
    return [library for library in EXTRAS[extra].libraries if find_spec(library) is None]


def remedy(extra: str) -> str:
    """Return the command that installs an extra."""
    return f"pip install 'hilplant[{extra}]'"


def need(extra: str) -> None:
    """Check before any work is done that the libraries of an extra are there.

    Raises
    ------
    Failure
        When one is missing; the line says how it is installed.

    """
    if absent := missing(extra):
        raise Failure(f"{EXTRAS[extra].purpose} need {', '.join(absent)}: {remedy(extra)}")


def extra_of(library: str | None) -> str | None:
    """Return the smallest extra that brings a library, or None when none does."""
    bringing = [extra for extra, contents in EXTRAS.items() if library in contents.libraries]
    return min(bringing, key=lambda extra: len(EXTRAS[extra].libraries), default=None)
