"""`hilplant vcan`."""

import typer

from hilplant.cli.groups import command_app

app = command_app()


@app.command(
    epilog="Example: hilplant vcan candump vcan0",
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
)
def vcan(command: list[str]) -> None:
    """Run a command with a private vcan0.

    From this kernel where it can, else in User Mode Linux.
    """
    from hilplant.vcan.private_vcan import run_with_vcan

    raise typer.Exit(run_with_vcan(command, limit_s=0.0))
