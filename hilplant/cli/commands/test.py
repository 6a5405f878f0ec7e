"""`hilplant test`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, Pace, write_json
from hilplant.extras import need
from hilplant.failure import Failure

app = command_app()

JUnitFile = Annotated[Path | None, typer.Option("--junit", help="write the verdicts to this file as JUnit XML")]
HtmlFile = Annotated[Path | None, typer.Option("--html", help="write a report to this file, one page of HTML")]


@app.command(epilog="Example: hilplant test my_tests/ --bench my_car.yaml --junit report.xml --html report.html")
def test(  # noqa: PLR0913, PLR0917
    scenarios: Annotated[
        list[str] | None, typer.Argument(help="scenario files, folders of them, or names of shipped tests")
    ] = None,
    bench: Annotated[str | None, typer.Option(help="bench for all; else the scenario's own, else the default")] = None,
    on: Annotated[
        str,
        typer.Option(help="virtual: in virtual time; else a channel of the bench's interface, such as can0"),
    ] = "virtual",
    pace: Pace = None,
    ecu: Annotated[str, typer.Option(help="stand-in; external: none joins here")] = "stand-in",
    jobs: Annotated[
        int | None, typer.Option(min=1, help="processes, in virtual time; as many as there are CPUs if left out")
    ] = None,
    controller: Annotated[
        str | None, typer.Option(help="a velocity controller inside the loop, in virtual time, instead of an ECU")
    ] = None,
    reference: Annotated[str, typer.Option(help="its wanted crank speed: RAD_S, or TIME:RAD_S,...")] = "3.14",
    junit: JUnitFile = None,
    html: HtmlFile = None,
    json_file: JsonFile = None,
) -> None:
    """Run scenarios as tests, and judge what they expect.

    Plant and stand-in ECU meet on an in-memory bus in virtual time; with --on CHANNEL on that channel of the bench's
    interface, in real time, one test after the other. Without a scenario it is the shipped suite. With --controller
    a velocity controller commands relays and supply inside the loop.
    Exit code 0 when all pass; 1 when one fails, was blocked or stayed inconclusive.
    """
    need("testing")
    from hilplant.ecu.loop_controller import Inside
    from hilplant.testing.junit import write_junit
    from hilplant.testing.report import write_report
    from hilplant.testing.suite import Where, figures_of, run_tests, scenario_files, summary_of
    from hilplant.testing.words import lines_of

    _refuse_misfits(on, ecu, controller, pace)
    for file in (junit, html, json_file):
        claim(file)
    inside = None if controller is None else Inside(controller, reference)
    where = Where(None if on == "virtual" else on, ecu == "stand-in", jobs, inside, pace, html is not None)
    tests = run_tests(scenario_files(scenarios or []), bench, where, lambda done: typer.echo("\n".join(lines_of(done))))
    typer.echo(summary_of(tests))
    if junit is not None:
        write_junit(junit, tests)
    if html is not None:
        write_report(html, tests)
    write_json(json_file, figures_of(tests))
    raise typer.Exit(0 if all(done.ruling == "pass" for done in tests) else 1)


def _refuse_misfits(on: str, ecu: str, controller: str | None, pace: float | None) -> None:
    """Refuse options that do not fit each other."""
    if ecu not in ("stand-in", "external"):
        raise Failure(f"--ecu must be stand-in or external, not {ecu}")
    if controller is not None and on != "virtual":
        raise Failure(f"--controller is for virtual time; on {on}: hilplant run --controller, or hilplant control")
    if pace is not None and on == "virtual":
        raise Failure("--pace is that of a real clock, and virtual time has none: give --on CHANNEL with it")
