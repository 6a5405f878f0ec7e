"""The command line: one thin function for each sub-command; what they do lives in the rooms they call."""

import re
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli import identification as cli_identification
from hilplant.cli.options import DEFAULT, BenchName, Channel, JsonFile, Seconds, claim, flat, write_json
from hilplant.cli.studies import plot_app, study_app
from hilplant.cli.train import train_app
from hilplant.failure import Failure, Unfit

app = typer.Typer(
    name="hilplant",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
    help="Virtual windscreen wipers on a real CAN bus, at 1 kHz. Start with: hilplant demo",
    epilog="An expected failure is one line; with --debug anywhere, where it came from is shown too.",
)

app.add_typer(plot_app, name="plot", short_help="Draw a recording, or what a bench is made of.")
app.add_typer(study_app, name="study", short_help="Run the source's experiments again, beside its tables.")
app.add_typer(train_app, name="train", short_help="Fit fast stand-ins to a bench's physical plant.")


@app.command(epilog="Example: hilplant demo --seconds 12 --out demo")
def demo(
    seconds: Annotated[float | None, typer.Option(help="length of the demonstration")] = None,
    out: Annotated[Path, typer.Option(help="folder for the recording and the plot")] = Path("hilplant-demo"),
) -> None:
    """Show plant and stand-in ECU at work on an in-memory bus.

    Needs no CAN in the kernel and no privileges; leaves a recording and a plot.
    """
    from hilplant.demo import run_demo

    raise typer.Exit(run_demo(seconds, out))


@app.command(epilog="Example: hilplant run default --channel can0 --record run.hilrec")
def run(  # noqa: PLR0913, PLR0917
    bench: BenchName = DEFAULT,
    seconds: Seconds = None,
    record: Annotated[Path | None, typer.Option(help="record every tick and every frame to this file")] = None,
    channel: Channel = None,
    controller: Annotated[str | None, typer.Option(help="a velocity controller inside the loop, by its name")] = None,
    reference: Annotated[
        str | None, typer.Option(help="its wanted crank speed: RAD_S, or TIME:RAD_S,...  [default: 3.14]")
    ] = None,
    json_file: JsonFile = None,
) -> None:
    """Serve a bench on its CAN interface.

    Ends when the time is up, or on SIGTERM or Ctrl-C. With --controller, relays and supply are commanded inside the
    loop in every tick, and not by frames; docs/control.md tells the names.
    """
    from hilplant.daemon import Inside, run_daemon

    if reference is not None and controller is None:
        raise Failure("--reference is what a controller is asked for: give --controller NAME with it")
    claim(json_file)
    inside = None if controller is None else Inside(controller, reference or "3.14")
    summary = run_daemon(bench, seconds, record, channel, inside)
    missing = " | ".join(f"{given.name}: {given.mend}" for given in summary.privileges if not given.granted)
    write_json(json_file, flat(asdict(summary) | {"privileges": {"missing": missing}}))
    raise typer.Exit(1 if summary.stopped_by_overrun or not summary.recording_complete else 0)


@app.command(epilog='Example: hilplant ecu default --stalk "0:off,1:slow,6:fast,11:i3,30:off,33:flick"')
def ecu(
    bench: BenchName = DEFAULT,
    seconds: Seconds = None,
    stalk: Annotated[str | None, typer.Option(help="movements of the stalk by time [s]: TIME:POSITION,...")] = None,
    channel: Channel = None,
    chart: Annotated[bool, typer.Option("--chart", help="print the controller's states as a Mermaid diagram")] = False,
) -> None:
    """Be the stand-in relay ECU, a CAN node of its own.

    The stalk has off, intermittent (1 to 6), slow, fast, flick and wash; off parks. It is what --stalk says, else what
    the bench's stalk message says once one has come, else what is typed.
    """
    if chart:
        from hilplant.ecu.mermaid import chart_text

        typer.echo(chart_text())
        raise typer.Exit()
    from hilplant.ecu.command import ecu_command

    raise typer.Exit(ecu_command(bench, seconds, stalk, channel))


@app.command(epilog="Example: hilplant control default --controller cascade --reference 0:3.14,10:3.77")
def control(
    bench: BenchName = DEFAULT,
    controller: Annotated[str, typer.Option(help="name of the controller; a wrong one lists all")] = "cascade",
    reference: Annotated[str, typer.Option(help="wanted crank speed: RAD_S, or TIME:RAD_S,...")] = "3.14",
    seconds: Seconds = None,
    channel: Channel = None,
) -> None:
    """Be a velocity controller, a CAN node of its own.

    It commands the supply voltage and both relays, and ticks with the plant's speed message. With _sensorless behind
    its name, as in pid_sensorless, a controller uses voltage, current and park switch only.
    """
    from hilplant.ecu.velocity_command import control_command

    raise typer.Exit(control_command(bench, controller, reference, seconds, channel))


@app.command(epilog="Example: hilplant check my_bench.yaml")
def check(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Say all that is wrong with a bench, with file and line.

    When nothing is, say what the bench amounts to. Exit code 0 when nothing is wrong, else 1.
    """
    from hilplant.bench.verdict import verdict_on

    found = verdict_on(bench)
    for problem in found.problems:
        typer.echo(problem, err=True)
    typer.echo("\n".join(found.lines))
    write_json(json_file, found.figures)
    raise typer.Exit(1 if found.problems else 0)


@app.command(epilog="Example: hilplant simulate default slow_fast_park --out wipe.csv")
def simulate(
    bench: BenchName,
    out: Annotated[Path, typer.Option(help="file for one row a tick: .csv, .mf4 or .parquet")],
    scenario: Annotated[
        str | None, typer.Argument(help="a scenario file, or the name of a shipped scenario", metavar="SCENARIO")
    ] = None,
) -> None:
    """Run a scenario through the daemon's step, as fast as possible.

    With one name alone, it is the scenario's, and the bench is the default one.
    """
    from hilplant.simulation.run import simulate_to_file

    if scenario is None:
        bench, scenario = DEFAULT, bench
    typer.echo(simulate_to_file(bench, scenario, out))


@app.command(epilog="Example: hilplant replay run.hilrec")
def replay(recording: Path, json_file: JsonFile = None) -> None:
    """Run a recording's inputs again; compare every output bit.

    Exit code 0 when all are equal, else 1 with the first tick and signal that differ.
    """
    from hilplant.recording.replay import replay as replay_recording

    result = replay_recording(recording)
    typer.echo(str(result))
    write_json(json_file, flat(asdict(result)))
    raise typer.Exit(0 if result.equal else 1)


@app.command(epilog="Example: hilplant export run.hilrec run.mf4")
def export(recording: Path, out: Path) -> None:
    """Convert a recording to .mf4, .blf, .asc, .csv or .parquet."""
    from hilplant.recording.export import export as export_recording

    typer.echo(export_recording(recording, out))


@app.command(epilog="Example: hilplant perf --json perf.json")
def perf(
    json_file: JsonFile = None,
    only: Annotated[str | None, typer.Option(help="parts to measure, such as step,tick,wakeup")] = None,
) -> None:
    """Measure speed, latency and memory of this machine.

    Each figure stands beside its limit, measured in the same run.
    """
    from hilplant.perf.perf import measure_and_print

    claim(json_file)
    write_json(json_file, measure_and_print(only))


@app.command(epilog="Example: hilplant doctor")
def doctor(json_file: JsonFile = None) -> None:
    """Say what helps or hinders real time and CAN here.

    With the command that mends it.
    """
    from hilplant.doctor import examine, print_findings

    findings = examine()
    print_findings(findings)
    write_json(json_file, {re.sub(r"\W+", "_", finding.name).lower(): finding.state for finding in findings})


@app.command(
    epilog="Example: hilplant vcan candump vcan0",
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
)
def vcan(command: list[str]) -> None:
    """Run a command with a private vcan0.

    From this kernel where it can, else in User Mode Linux.
    """
    from hilplant.vcan.private_vcan import run_with_vcan

    raise typer.Exit(run_with_vcan(command, limit_s=0.0))


@app.command(
    short_help="Say what is wrong with a measurement, and what it shows.",
    epilog='Example: hilplant inspect rig.csv --columns "voltage=U1,current=I1[mA],park=PS"',
)
def inspect(  # noqa: PLR0913, PLR0917
    data: Path,
    columns: Annotated[str, typer.Option(help="role=NAME[unit],...: time, voltage, current, park, fast, on")] = "",
    frames: Annotated[str | None, typer.Option(help="bus database, or bench, that reads a log of CAN frames")] = None,
    mode: Annotated[str | None, typer.Option(help="slow or fast, where no column says it")] = None,
    gear_ratio: Annotated[float, typer.Option(min=1.0, help="turns of the motor in one turn of the crank")] = 63.0,
    json_file: JsonFile = None,
) -> None:
    """Say what is wrong with a measurement, what was done to it, and what motor it shows.

    Exit code 0 when it will do for identification, else 1.
    """
    from hilplant.identify.command import Wish, inspect_data

    claim(json_file)
    good, figures = inspect_data(Wish(data, columns, frames, mode, gear_ratio))
    write_json(json_file, figures)
    raise typer.Exit(0 if good else 1)


@app.command(
    short_help="Play a test sequence for identification, or write it.",
    epilog="Example: hilplant sequence default --out sequence.yaml",
)
def sequence(
    bench: BenchName = DEFAULT,
    out: Annotated[Path | None, typer.Option(help="write it as a scenario, timed by this bench's plant")] = None,
    kind: Annotated[str, typer.Option(help="informative or figure-5-4")] = "informative",
    volts: Annotated[str, typer.Option(help="voltages [V] with commas between")] = "10,12,14,16",
    channel: Channel = None,
) -> None:
    """Play a test sequence for identification: on the bench's bus, or with --out into a scenario.

    On the bus it commands relays and supply of a real rig and steps on at the park edges.
    """
    from hilplant.identify.sequence_runs import play_on_bus, stages_of, write_scenario

    if out is None:
        play_on_bus(bench, stages_of(kind, volts), channel, typer.echo)
    else:
        typer.echo(write_scenario(bench, stages_of(kind, volts), out))


cli_identification.add_to(app)


def main() -> None:
    """Run the command line; what goes wrong is one line on stderr and exit code 2, `--debug` shows its origin.

    Where data were judged and will not do it is exit code 1.
    """
    debug = "--debug" in sys.argv and sys.argv[1] != "vcan"  # behind vcan it is the command's own
    arguments = [argument for argument in sys.argv[1:] if not debug or argument != "--debug"]
    try:
        code = app(arguments, prog_name="hilplant", standalone_mode=False)
    except Exception as error:
        if debug:
            raise
        typer.echo(_one_line(error), err=True)
        raise SystemExit(1 if isinstance(error, Unfit) else 2) from None
    raise SystemExit(code if isinstance(code, int) else 0)


def _one_line(error: Exception) -> str:
    if isinstance(error, Failure):
        return str(error)
    if hasattr(error, "format_message"):  # wrong use, as the library of the command line found it
        text: str = error.format_message()
        context = getattr(error, "ctx", None)
        hint = f"({context.command_path if context else 'hilplant'} --help shows what is right)"
        return text if text.startswith("Usage") else f"{text} {hint}"
    return f"{type(error).__name__}: {error} (--debug shows where)"
