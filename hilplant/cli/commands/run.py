"""`hilplant run`."""

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import (
    DEFAULT,
    BenchName,
    Budget,
    Channel,
    JsonFile,
    Pace,
    Seconds,
    flat,
    write_json,
)
from hilplant.cli.page_option import LOGS, Browser, PageAddress, PageLogs, Stream, WithPage, page_options
from hilplant.failure import Failure

if TYPE_CHECKING:
    from hilplant.recording.beside_loop import RecordTo

app = command_app()


@app.command(cls=WithPage, epilog="Example: hilplant run default --channel can0 --record run.hilrec")
def run(  # noqa: PLR0913, PLR0917
    bench: BenchName = DEFAULT,
    seconds: Seconds = None,
    record: Annotated[
        Path | None, typer.Option(help="record every tick and every frame to this file, or to a new one in this folder")
    ] = None,
    rotate: Annotated[str | None, typer.Option(help="record in parts of this size or time: 100MB, 1h, or both")] = None,
    keep: Annotated[int | None, typer.Option(min=1, help="keep this many parts, the newest of all starts")] = None,
    channel: Channel = None,
    pace: Pace = None,
    controller: Annotated[str | None, typer.Option(help="a velocity controller inside the loop")] = None,
    reference: Annotated[
        str | None, typer.Option(help="its wanted crank speed: RAD_S, or TIME:RAD_S,...  [default: 3.14]")
    ] = None,
    budget_us: Budget = None,
    no_channel: Annotated[
        bool, typer.Option("--no-channel", help="open no local socket through which other programs take part")
    ] = False,
    page: PageAddress = None,
    logs: PageLogs = LOGS,
    browser: Browser = False,
    stream: Stream = "",
    scenario: Annotated[
        Path | None, typer.Option(help="play this scenario, judge what it expects, and end with it")
    ] = None,
    verdicts: Annotated[bool, typer.Option(hidden=True)] = True,
    json_file: JsonFile = None,
) -> None:
    """Serve a bench on its CAN interface.

    Ends when the time is up, or on SIGTERM or Ctrl-C. With --controller, relays and supply are commanded inside the
    loop in every tick, and not by frames; docs/control.md tells the names. With --scenario, exit code 0 only if all
    that it expects holds.
    """
    from hilplant.cli.actions.run import Played, run_daemon
    from hilplant.ecu.loop_controller import Inside
    from hilplant.runtime.server import StopRequest, ended_by_signals

    if reference is not None and controller is None:
        raise Failure("--reference is what a controller is asked for: give --controller NAME with it")
    to = _record_to(record, rotate, keep)
    claim(json_file)
    inside = None if controller is None else Inside(controller, reference or "3.14", budget_us)
    played = None if scenario is None else Played(scenario, verdicts)
    page_wanted = page_options(page, logs, browser, stream)
    summary = run_daemon(bench, seconds, to, channel, inside, not no_channel, page_wanted, played, pace)
    missing = " | ".join(f"{given.name}: {given.fix}" for given in summary.privileges if not given.granted)
    with ended_by_signals(StopRequest()):  # one more Ctrl-C shall not cost the figures
        write_json(json_file, flat(asdict(summary) | {"privileges": {"missing": missing}}))
    raise typer.Exit(0 if summary.is_sound else 1)


def _record_to(record: Path | None, rotate: str | None, keep: int | None) -> "RecordTo | None":
    """Return where to record and in which parts."""
    from hilplant.recording.beside_loop import RecordTo
    from hilplant.recording.rotation import Rotation

    rotation = Rotation.parse(rotate, keep)
    if rotation.in_parts and record is None:
        raise Failure("--rotate is about a recording: give --record FILE with it")
    return None if record is None else RecordTo(record, rotation)
