"""The command line: its options, and what an error looks like; the commands are in `hilplant.cli.commands`."""

import io
import sys
from typing import Annotated

import typer

import hilplant
from hilplant.cli.groups import group_app
from hilplant.extras import extra_of, remedy
from hilplant.failure import Failure, Unfit

#: The first commands of the list; the others follow by the alphabet.
FIRST = ("demo", "run", "ecu", "check", "simulate", "replay")

app = group_app(
    "hilplant.cli.commands",
    FIRST,
    name="hilplant",
    add_completion=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Virtual windscreen wipers on a real CAN bus, at 1 kHz. Start with: hilplant demo",
    epilog="An expected failure is one line; with --debug anywhere, where it came from is shown too.",
)


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"hilplant {hilplant.__version__}")
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")
    ] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line; what goes wrong is one line on stderr and exit code 2, `--debug` shows its origin.

    Where data were judged and will not do it is exit code 1.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a console of another code page ends no command
    debug = "--debug" in sys.argv and sys.argv[1] != "vcan"  # behind vcan it is the command's own
    arguments = [argument for argument in sys.argv[1:] if not debug or argument != "--debug"]
    try:
        code = app(arguments, prog_name="hilplant", standalone_mode=False)
    except Exception as error:
        if debug:
            raise
        typer.echo(_one_line(error), err=True)
        raise SystemExit(1 if isinstance(error, Unfit) else 2) from None
    raise SystemExit(code if isinstance(code, int) else 0)


def _one_line(error: Exception) -> str:
    if isinstance(error, Failure):
        return str(error)
    if hasattr(error, "format_message"):  # wrong use, as the library of the command line found it
        text: str = error.format_message()
        context = getattr(error, "ctx", None)
        hint = f"({context.command_path if context else 'hilplant'} --help shows what is right)"
        return text if text.startswith("Usage") else f"{text} {hint}"
    if isinstance(error, ModuleNotFoundError) and (extra := extra_of(error.name)):
        return f"this needs {error.name}: {remedy(extra)}"
    return f"{type(error).__name__}: {error} (--debug shows where)"
