"""`hilplant judge`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.commands.test import HtmlFile, JUnitFile
from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, write_json
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant judge run.hilrec my_test.yaml")
def judge(  # noqa: PLR0913, PLR0917
    recording: Path,
    scenario: Annotated[str, typer.Argument(help="the scenario whose `expect` section is to hold")],
    bench: Annotated[str | None, typer.Option(help="bench that protects the messages, for counters and CRCs")] = None,
    junit: JUnitFile = None,
    html: HtmlFile = None,
    json_file: JsonFile = None,
) -> None:
    """Judge a recording by what a scenario expects.

    The recording's first tick is time 0. Exit code 0 when all that is expected holds, else 1; ticks or frames that
    were lost make what depends on them inconclusive.
    """
    need("testing")
    from hilplant.testing.junit import write_junit
    from hilplant.testing.report import write_report
    from hilplant.testing.scenario_test import judge_recording
    from hilplant.testing.suite import figures_of
    from hilplant.testing.words import lines_of

    for file in (junit, html, json_file):
        claim(file)
    found = judge_recording(recording, scenario, bench)
    typer.echo("\n".join(lines_of(found)))
    if junit is not None:
        write_junit(junit, [found])
    if html is not None:
        write_report(html, [found])
    write_json(json_file, figures_of([found]))
    raise typer.Exit(0 if found.ruling == "pass" else 1)
