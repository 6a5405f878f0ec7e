"""The command line: one thin function for each sub-command; what they do lives in the rooms they call."""

import json
import re
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer

from hilplant.failure import Failure

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

BenchName = Annotated[str, typer.Argument(help="a bench file, or the name of a shipped bench", metavar="BENCH")]
Seconds = Annotated[
    float | None, typer.Option(min=0.001, max=1e9, help="end after this time; without it, on Ctrl-C or SIGTERM")
]
JsonFile = Annotated[Path | None, typer.Option("--json", help="write the figures to this file")]
Channel = Annotated[str | None, typer.Option(help="use this channel instead of the bench's, such as can0")]

DEFAULT = "default"


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
def run(
    bench: BenchName = DEFAULT,
    seconds: Seconds = None,
    record: Annotated[Path | None, typer.Option(help="record every tick and every frame to this file")] = None,
    channel: Channel = None,
    json_file: JsonFile = None,
) -> None:
    """Serve a bench on its CAN interface.

    Ends when the time is up, or on SIGTERM or Ctrl-C.
    """
    from hilplant.daemon import run_daemon

    _claim(json_file)
    summary = run_daemon(bench, seconds, record, channel)
    missing = " | ".join(f"{given.name}: {given.mend}" for given in summary.privileges if not given.granted)
    _write_json(json_file, _flat(asdict(summary) | {"privileges": {"missing": missing}}))
    raise typer.Exit(1 if summary.stopped_by_overrun or not summary.recording_complete else 0)


@app.command(epilog='Example: hilplant ecu default --stalk "0:off,1:slow,6:fast,11:off"')
def ecu(
    bench: BenchName = DEFAULT,
    seconds: Seconds = None,
    stalk: Annotated[str | None, typer.Option(help="positions of the stalk by time [s]: TIME:POSITION,...")] = None,
    channel: Channel = None,
) -> None:
    """Be the stand-in relay ECU, a CAN node of its own.

    The stalk has off, slow, fast and intermittent; off parks. Without --stalk it is read from standard input.
    """
    from hilplant.ecu.command import ecu_command

    raise typer.Exit(ecu_command(bench, seconds, stalk, channel))


@app.command(epilog="Example: hilplant check my_bench.yaml")
def check(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Say all that is wrong with a bench, with file and line.

    Exit code 0 when nothing is wrong, else 1.
    """
    from hilplant.bench import check_bench

    problems = check_bench(bench)
    for problem in problems:
        typer.echo(str(problem), err=True)
    typer.echo(f"{bench}: {len(problems)} problem(s)" if problems else f"{bench}: nothing is wrong")
    _write_json(json_file, {"problems": len(problems), "messages": [str(problem) for problem in problems]})
    raise typer.Exit(1 if problems else 0)


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
    from hilplant.simulation import simulate_to_file

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
    _write_json(json_file, _flat(asdict(result)))
    raise typer.Exit(0 if result.equal else 1)


@app.command(epilog="Example: hilplant export run.hilrec run.mf4")
def export(recording: Path, out: Path) -> None:
    """Convert a recording to .mf4, .blf, .asc, .csv or .parquet."""
    from hilplant.recording.export import export as export_recording

    typer.echo(export_recording(recording, out))


@app.command(epilog="Example: hilplant plot run.hilrec run.png")
def plot(recording: Path, out: Path) -> None:
    """Draw a recording: voltage, current, speed, arms, switches."""
    from hilplant.recording.plot import plot_recording

    plot_recording(recording, out)
    typer.echo(f"{out} written")


@app.command(epilog="Example: hilplant perf --json perf.json")
def perf(
    json_file: JsonFile = None,
    only: Annotated[str | None, typer.Option(help="parts to measure, such as step,tick,wakeup")] = None,
) -> None:
    """Measure speed, latency and memory of this machine.

    Each figure stands beside its limit, measured in the same run.
    """
    from hilplant.benchmarks.perf import measure_and_print

    _claim(json_file)
    _write_json(json_file, measure_and_print(only))


@app.command(epilog="Example: hilplant doctor")
def doctor(json_file: JsonFile = None) -> None:
    """Say what helps or hinders real time and CAN here.

    With the command that mends it.
    """
    from hilplant.doctor import examine, print_findings

    findings = examine()
    print_findings(findings)
    _write_json(json_file, {re.sub(r"\W+", "_", finding.name).lower(): finding.state for finding in findings})


@app.command(
    epilog="Example: hilplant vcan candump vcan0",
    context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False},
)
def vcan(command: list[str]) -> None:
    """Run a command with a private vcan0.

    From this kernel where it can, else in User Mode Linux.
    """
    from hilplant.bus.private_vcan import run_with_vcan

    raise typer.Exit(run_with_vcan(command, limit_s=0.0))


def _flat(record: dict[str, Any]) -> dict[str, Any]:
    """Lift nested figures to the top, as `outer_inner`."""
    flat: dict[str, Any] = {}
    for key, value in record.items():
        if isinstance(value, dict):
            flat.update({f"{key}_{inner}": figure for inner, figure in value.items()})
        else:
            flat[key] = value
    return flat


def _claim(path: Path | None) -> None:
    """Refuse a file that cannot be written before something long begins."""
    if path is not None:
        _write(path, "")


def _write_json(path: Path | None, figures: dict[str, Any]) -> None:
    if path is not None:
        _write(path, json.dumps(figures, indent=2, default=str) + "\n")


def _write(path: Path, text: str) -> None:
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise Failure(f"{path}: cannot be written ({error.strerror})") from error


def main() -> None:
    """Run the command line; what goes wrong is one line on stderr and exit code 2, `--debug` shows its origin."""
    debug = "--debug" in sys.argv and sys.argv[1] != "vcan"  # behind vcan it is the command's own
    arguments = [argument for argument in sys.argv[1:] if not debug or argument != "--debug"]
    try:
        code = app(arguments, prog_name="hilplant", standalone_mode=False)
    except Exception as error:
        if debug:
            raise
        typer.echo(_one_line(error), err=True)
        raise SystemExit(2) from None
    raise SystemExit(code if isinstance(code, int) else 0)


def _one_line(error: Exception) -> str:
    if isinstance(error, Failure):
        return str(error)
    if hasattr(error, "format_message"):  # wrong use, as the library of the command line found it
        text: str = error.format_message()
        command = sys.argv[1] if len(sys.argv) > 1 and "command" not in text else ""
        hint = f"({f'hilplant {command}'.strip()} --help shows what is right)"
        return text if text.startswith("Usage") else f"{text} {hint}"
    return f"{type(error).__name__}: {error} (--debug shows where)"
