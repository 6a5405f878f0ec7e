"""`hilplant sequence`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, Channel
from hilplant.cli.voice import Voice

app = command_app()


@app.command(
    epilog="Example: hilplant sequence default --out sequence.yaml",
)
def sequence(
    bench: BenchName = DEFAULT,
    out: Annotated[Path | None, typer.Option(help="write it as a scenario, timed by this bench's plant")] = None,
    kind: Annotated[str, typer.Option(help="informative or figure-5-4")] = "informative",
    volts: Annotated[str, typer.Option(help="voltages [V] with commas between")] = "10,12,14,16",
    channel: Channel = None,
) -> None:
    """Play a test sequence for identification, or write it.

    On the bench's bus it commands relays and supply of a real rig and steps on at the park edges; with --out it writes
    a scenario.
    """
    from hilplant.identify.sequence_runs import play_on_bus, stages_of, write_scenario

    if out is None:
        play_on_bus(bench, stages_of(kind, volts), channel, Voice().say)
    else:
        typer.echo(write_scenario(bench, stages_of(kind, volts), out))
