"""`hilplant demo`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant demo --seconds 12 --out demo")
def demo(
    seconds: Annotated[float | None, typer.Option(help="length of the demonstration")] = None,
    out: Annotated[Path, typer.Option(help="folder for the recording and the plot")] = Path("hilplant-demo"),
) -> None:
    """Show plant and stand-in ECU at work on an in-memory bus.

    Needs no CAN in the kernel and no privileges; leaves a recording and a plot.
    """
    need("demo")
    from hilplant.cli.actions.demo import run_demo

    run_demo(seconds, out)
