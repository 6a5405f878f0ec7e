"""`hilplant fault`."""

from typing import Annotated, Any

import typer

from hilplant.cli.groups import command_app
from hilplant.failure import Failure

app = command_app()

#: The loop ends a fault in its tick; this command leaves a little later.
_ENDS_S = 0.1


@app.command(epilog="Example: hilplant fault resistance_53 resistance_ohm=0.5 --for 2")
def fault(
    name: Annotated[str, typer.Argument(help="name of a fault; hilplant faults lists all")],
    keys: Annotated[
        list[str] | None,
        typer.Argument(help="its quantities, and message, signal, value, direction, at, ramp ...", metavar="KEY=VALUE"),
    ] = None,
    run: Annotated[
        str | None, typer.Option(help="which run: its CAN channel, bench or process; not needed for the only one")
    ] = None,
    lasts: Annotated[float | None, typer.Option("--for", min=0.001, help="how long it lasts [s]")] = None,
) -> None:
    """Insert a fault into a run that goes on.

    Prints the tick from which on it is there. It stays for as long as --for says, else until Ctrl-C; it goes with this
    command.
    """
    import threading

    from hilplant.channel.client import connect

    given = dict(_key(text) for text in keys or [])
    if lasts is not None:
        given["for"] = lasts
    with connect(run) as channel:
        typer.echo(f"{name}: tick {channel.fault(name, **given)}")
        threading.Event().wait(None if lasts is None else given.get("at", 0.0) + lasts + _ENDS_S)


def _key(text: str) -> tuple[str, Any]:
    name, equals, value = text.partition("=")
    if not equals or not name or name == "fault":
        raise Failure(f"'{text}': write KEY=VALUE, such as resistance_ohm=0.5")
    try:
        return name, int(value) if name == "seed" else float(value)
    except ValueError:
        return name, value
