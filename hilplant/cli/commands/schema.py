"""`hilplant schema`."""

from enum import StrEnum
from typing import Annotated

import typer

from hilplant.cli.groups import command_app

app = command_app()


class Kind(StrEnum):
    """Kinds of files that have a schema."""

    BENCH = "bench"
    MOTOR = "motor"
    LINKAGE = "linkage"
    SCREEN = "screen"
    SCENARIO = "scenario"
    ECU = "ecu"
    CONTROLLER = "controller"


@app.command(epilog="Example: hilplant schema bench > bench-1.json")
def schema(kind: Annotated[Kind, typer.Argument(help="kind of file; ecu is that section of a bench")]) -> None:
    """Print the JSON Schema of a kind of file.

    For editors, and for checks without hilplant; docs/bench.md says how to set an editor up.
    """
    from hilplant.simulation.schema import schema_text

    typer.echo(schema_text(kind.value), nl=False)
