"""`hilplant ecu`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, Channel, Pace, Seconds

app = command_app()


@app.command(epilog='Example: hilplant ecu default --stalk "0:off,1:slow,6:fast,11:i3,30:off,33:flick"')
def ecu(  # noqa: PLR0913, PLR0917
    bench: BenchName = DEFAULT,
    seconds: Seconds = None,
    stalk: Annotated[str | None, typer.Option(help="movements of the stalk by time [s]: TIME:POSITION,...")] = None,
    channel: Channel = None,
    pace: Pace = None,
    chart: Annotated[bool, typer.Option("--chart", help="print the controller's states as a Mermaid diagram")] = False,
) -> None:
    """Simulate the body ECU, a CAN node of its own.

    The stalk has off, intermittent (1 to 6), slow, fast, flick and wash; off parks. It is what --stalk says, else what
    the bench's stalk message says once one has come, else what is typed.
    """
    if chart:
        from hilplant.ecu.mermaid import chart_text

        typer.echo(chart_text())
        raise typer.Exit()
    from hilplant.cli.actions.ecu import ecu_command

    ecu_command(bench, seconds, stalk, (channel, pace))
