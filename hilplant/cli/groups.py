"""Commands found by themselves: a group of commands is a package, each command a module in it.

A module of a group holds `app`, made by :func:`command_app`, with one command, a function whose name begins with the
module's; a package holds `app`, made by :func:`group_app`. A module is imported when its command is wanted. The list of
all takes the first line of each from the module's compiled code, without an import.
"""

from collections.abc import Iterator, Mapping
from functools import cached_property
from importlib import import_module
from inspect import cleandoc
from pkgutil import iter_modules
from types import CodeType
from typing import Any

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command


class FoundCommands(Mapping[str, Any]):
    """The commands of a package by name: those in `first` in that order, then the others by the alphabet."""

    def __init__(self, package: str, first: tuple[str, ...]) -> None:
        self._package, self._first = package, first

    @cached_property
    def _modules(self) -> dict[str, Any]:
        return {module.name: module for module in iter_modules(import_module(self._package).__path__)}

    @cached_property
    def _names(self) -> list[str]:
        return [*self._first, *(name for name in sorted(self._modules) if name not in self._first)]

    def __getitem__(self, name: str) -> Any:
        """Return the command of a module; a - in its name is a _ in the module's."""
        module = name.replace("-", "_")
        if module not in self._names:
            raise KeyError(name)
        command = get_command(import_module(f"{self._package}.{module}").app)
        command.name = name
        return command

    def listed(self, name: str) -> Any:
        """Return what the list of all commands shows of one."""
        module = self._modules[name.replace("-", "_")]
        if module.ispkg:
            return self[name]
        code = module.module_finder.find_spec(module.name).loader.get_code(module.name)
        function = next(c for c in code.co_consts if isinstance(c, CodeType) and c.co_name.startswith(module.name))
        return TyperCommand(name, help=cleandoc(function.co_consts[0]))

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
            self.found = FoundCommands(package, first)
            super().__init__(**settings | {"commands": self.found})

        def format_commands(self, ctx: Any, formatter: Any) -> None:
            listed = TyperGroup(commands={name: self.found.listed(name) for name in self.found})
            listed.format_commands(ctx, formatter)

    settings = {"add_completion": False, "no_args_is_help": True, "rich_markup_mode": None} | texts
    app = typer.Typer(cls=PackageGroup, **settings)
    app.callback()(lambda: None)
    return app


def command_app() -> typer.Typer:
    """Return what holds the one command of a module."""
    return typer.Typer(add_completion=False, rich_markup_mode=None)
