"""`hilplant control`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, Budget, Channel, Seconds

app = command_app()


@app.command(epilog="Example: hilplant control default --controller cascade --reference 0:3.14,10:3.77")
def control(  # noqa: PLR0913, PLR0917
    bench: BenchName = DEFAULT,
    controller: Annotated[str, typer.Option(help="name, file, or module:function; a wrong one lists all")] = "cascade",
    reference: Annotated[str, typer.Option(help="wanted crank speed: RAD_S, or TIME:RAD_S,...")] = "3.14",
    seconds: Seconds = None,
    channel: Channel = None,
    budget_us: Budget = None,
) -> None:
    """Run a velocity controller, a CAN node of its own.

    It commands the supply voltage and both relays, and ticks with the plant's speed message. With _sensorless behind
    its name, as in pid_sensorless, a controller uses voltage, current and park switch only. docs/control.md shows
    how to tune one in a file, and how to write your own. One that is stopped ends the node with exit code 1.
    """
    from hilplant.cli.actions.control import control_command

    sound = control_command(bench, (controller, reference, budget_us), seconds, channel)
    raise typer.Exit(0 if sound else 1)
