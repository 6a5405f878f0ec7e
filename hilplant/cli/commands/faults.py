"""`hilplant faults`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app

app = command_app()


@app.command(epilog="Example: hilplant faults short_53_to_31")
def faults(name: Annotated[str | None, typer.Argument(help="one fault, to be told in full")] = None) -> None:
    """List the faults that can be inserted.

    With a name: its quantities, its effect, and a line for a scenario's `faults` section.
    """
    from hilplant.faults.listing import fault_lines, list_lines

    typer.echo("\n".join(list_lines() if name is None else fault_lines(name)))
