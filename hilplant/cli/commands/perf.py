"""`hilplant perf`."""

from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, write_json

app = command_app()


@app.command(epilog="Example: hilplant perf --json perf.json")
def perf(
    json_file: JsonFile = None,
    only: Annotated[str | None, typer.Option(help="parts to measure, such as step,tick,wakeup")] = None,
) -> None:
    """Measure speed, latency and memory of this machine.

    Each figure stands beside its limit, measured in the same run.
    """
    from hilplant.cli.actions.perf import measure_and_print

    claim(json_file)
    write_json(json_file, measure_and_print(only))
