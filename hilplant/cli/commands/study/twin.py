"""`hilplant study twin`."""

from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, write_json
from hilplant.extras import need

app = command_app()


@app.command(
    epilog="Example: hilplant study twin --seeds 100 --full 5 --json twin.json",
)
def twin(
    bench: BenchName = DEFAULT,
    seeds: Annotated[int, typer.Option(help="noises for the last stage alone; minutes for 100", min=0)] = 10,
    full: Annotated[int, typer.Option(help="noises for all three stages", min=0)] = 1,
    compare: Annotated[bool, typer.Option("--compare", help="also compare the global searches")] = False,
    json_file: JsonFile = None,
) -> None:
    """Identify data of a known bench.

    The result is held against the truth. Exit code 1 when errors or intervals are worse than they are to be.
    """
    need("identify")
    from hilplant.bench import load_bench
    from hilplant.thesis.twin_study import twin_study

    claim(json_file)
    good, figures = twin_study(load_bench(bench), (seeds, full), compare, typer.echo)
    write_json(json_file, figures)
    raise typer.Exit(0 if good else 1)
