"""`hilplant source`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName

app = command_app()


@app.command(epilog="Example: hilplant source default --out wiper")
def source(
    out: Annotated[Path, typer.Option(help="folder for the C files; it is made where there is none")],
    bench: BenchName = DEFAULT,
) -> None:
    """Write the plant as C sources, with a bench as data.

    Needs no library but C's own; docs/c_source.md says how to call it, from a Simulink S-function for example.
    """
    from hilplant.bench import load_bench
    from hilplant.c_source.bench_files import COMPILE, write_sources

    for path in write_sources(load_bench(bench), out):
        typer.echo(str(path))
    typer.echo(f"compile there: {COMPILE}")
