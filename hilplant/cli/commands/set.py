"""`hilplant set`."""

from typing import Annotated, Any

import typer

from hilplant.cli.groups import command_app
from hilplant.failure import Failure

app = command_app()

#: What is not an input: a mark, the controller's reference, a parameter by its place such as motor.damping_n_m_s.
_MARK, _REFERENCE = "mark", "reference"


@app.command(epilog="Example: hilplant set supply_v=9.5 screen=wet --hold 5")
def set(
    assignments: Annotated[
        list[str],
        typer.Argument(help="INPUT=VALUE, PARAMETER=VALUE, reference=RAD_S or mark=TEXT", metavar="NAME=VALUE..."),
    ],
    run: Annotated[
        str | None, typer.Option(help="which run: its CAN channel, bench or process; not needed for the only one")
    ] = None,
    hold: Annotated[
        float | None, typer.Option(min=0.001, help="hold the inputs for so many seconds, against bus and scenario")
    ] = None,
) -> None:
    """Set inputs or parameters of a run that goes on.

    Prints the tick at which that was applied. An input stays as it is set until a frame carries another value for it.
    With --hold it stays for that time, or until Ctrl-C. Inputs of one call change in one tick, and so do parameters.
    """
    import threading

    from hilplant.channel.client import connect
    from hilplant.models.records import PARAMETER_INDEX

    wanted = dict(_assignment(text) for text in assignments)
    parameters = {name: wanted.pop(name) for name in list(wanted) if name in PARAMETER_INDEX}
    with connect(run) as channel:
        if _MARK in wanted:
            _said(_MARK, channel.mark(str(wanted.pop(_MARK))))
        if _REFERENCE in wanted:
            _said(_REFERENCE, channel.reference(wanted.pop(_REFERENCE)))
        if parameters:
            _said(", ".join(parameters), channel.parameter(parameters))
        if wanted and hold is None:
            _said(", ".join(wanted), channel.set(wanted))
        elif wanted:
            _said(", ".join(wanted), channel.override(wanted))
            threading.Event().wait(hold)


def _said(what: str, tick: int) -> None:
    typer.echo(f"{what}: tick {tick}")


def _assignment(text: str) -> tuple[str, Any]:
    name, equals, value = text.partition("=")
    if not equals or not name:
        raise Failure(f"'{text}': write NAME=VALUE, such as supply_v=9.5")
    if name == _MARK:
        return name, value
    if value in ("true", "false"):
        return name, value == "true"
    try:
        return name, float(value)
    except ValueError:
        return name, value
