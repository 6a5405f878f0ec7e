"""`hilplant plot animation`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchOption
from hilplant.extras import need
from hilplant.failure import Failure

app = command_app()


@app.command(epilog="Example: hilplant plot animation run.hilrec wiper.gif --to 5")
def animation(  # noqa: PLR0913, PLR0917
    result: Annotated[Path, typer.Argument(help="a recording, or what simulate has written")],
    out: Annotated[Path, typer.Argument(help="moving picture to write: .gif")],
    bench: BenchOption = DEFAULT,
    from_s: Annotated[float, typer.Option("--from", min=0.0, help="begin at this time [s]")] = 0.0,
    to_s: Annotated[float | None, typer.Option("--to", min=0.0, help="end at this time [s]")] = None,
    frames: Annotated[float, typer.Option(min=1.0, max=50.0, help="a second")] = 20.0,
    faster: Annotated[float, typer.Option(min=0.01, max=1000.0, help="times faster than real")] = 1.0,
) -> None:
    """Draw a moving picture of the wiper.

    The crank angle is the result's; --bench says which wiper it moves.
    """
    if out.suffix.lower() != ".gif":
        raise Failure(f"{out}: the ending must be .gif")
    need("plot")
    claim(out)
    from hilplant.bench import load_bench
    from hilplant.cli.progress import progress_shown
    from hilplant.plots.animation import Film, write_animation

    wiper = load_bench(bench).plant.mechanics.wiper
    with progress_shown() as on_progress:
        count = write_animation(result, wiper, out, Film(from_s, to_s, frames, faster), on_progress)
    typer.echo(f"{out} written, {count} frames")
