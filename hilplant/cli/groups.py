"""Commands found by themselves: a group of commands is a package, each command a module in it.

A module of a group holds `app`, made by :func:`command_app`, with one command; a package holds `app`, made by
:func:`group_app`. A module is imported when its command is wanted, or the list of all.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_command


class FoundCommands(Mapping[str, Any]):
    """The commands of a package by name: those in `first` in that order, then the others by the alphabet."""

    def __init__(self, package: str, first: tuple[str, ...]) -> None:
        self._package, self._first = package, first

    @cached_property
    def _names(self) -> list[str]:
        found = sorted(module.name for module in iter_modules(import_module(self._package).__path__))
        return [*self._first, *(name for name in found if name not in self._first)]

    def __getitem__(self, name: str) -> Any:
        """Return the command of a module; a - in its name is a _ in the module's."""
        module = name.replace("-", "_")
        if module not in self._names:
            raise KeyError(name)
        command = get_command(import_module(f"{self._package}.{module}").app)
        command.name = name
        return command

    def __iter__(self) -> Iterator[str]:
        """Iterate over the names."""
        return (name.replace("_", "-") for name in self._names)

    def __len__(self) -> int:
        """Count the commands."""
        return len(self._names)


def group_app(package: str, first: tuple[str, ...] = (), **texts: Any) -> typer.Typer:
    """Return the group of the commands in a package; `texts` are settings of Typer, such as its help."""

    class PackageGroup(TyperGroup):
        def __init__(self, **settings: Any) -> None:
            super().__init__(**settings | {"commands": FoundCommands(package, first)})

    settings = {"add_completion": False, "no_args_is_help": True, "rich_markup_mode": None} | texts
    app = typer.Typer(cls=PackageGroup, **settings)
    app.callback()(lambda: None)
    return app


def command_app() -> typer.Typer:
    """Return what holds the one command of a module."""
    return typer.Typer(add_completion=False, rich_markup_mode=None)
