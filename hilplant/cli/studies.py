"""The command line of what is drawn and studied: `hilplant plot ...` and `hilplant study ...`."""

from pathlib import Path
from typing import Annotated

import typer

from hilplant.cli.options import DEFAULT, BenchName, JsonFile, claim, write_json
from hilplant.failure import Failure

PICTURES = (".png", ".svg", ".pdf")


def _drawable(path: Path) -> Path:
    """Refuse a picture that cannot be written, before any work is done for it."""
    if path.suffix.lower() not in PICTURES:
        raise Failure(f"{path}: the ending must be one of {', '.join(PICTURES)}")
    if not path.parent.is_dir():
        raise Failure(f"{path}: cannot be written: there is no folder {path.parent}")
    return path


Picture = Annotated[Path, typer.Argument(help=f"picture to write: {', '.join(PICTURES)}", callback=_drawable)]

plot_app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Draw a recording, or what a bench is made of, as a picture: PNG, SVG or PDF.",
    epilog="Example: hilplant plot positions default wiper.png",
)
study_app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    help="Run the source's experiments again and print them beside its tables.",
    epilog="Example: hilplant study control --out study",
)


@study_app.command(
    "control",
    short_help="Compare all velocity controllers, section 7.2.",
    epilog="Example: hilplant study control --out study --json study.json",
)
def study_control(
    bench: BenchName = DEFAULT,
    out: Annotated[Path | None, typer.Option(help="folder for the pictures")] = None,
    search: Annotated[bool, typer.Option("--search", help="search better gains instead; takes minutes")] = False,
    json_file: JsonFile = None,
) -> None:
    """Put all velocity controllers through the test of section 7.2.

    With the speed sensor and without it, and through an hour of rain.
    """
    from hilplant.thesis.control_command import control_study

    claim(json_file)
    write_json(json_file, control_study(bench, out, search))


@study_app.command(
    "identification",
    short_help="Compute Tables 5-2 to 5-5 again.",
    epilog="Example: hilplant study identification --json study.json",
)
def study_identification(json_file: JsonFile = None) -> None:
    """Compute Tables 5-2 to 5-5 again, each printed number beside ours.

    Exit code 1 when one is neither reached nor explained by rounding.
    """
    from hilplant.thesis.published import as_table, figures, published_lines

    lines = published_lines()
    typer.echo(as_table(lines))
    write_json(json_file, figures(lines))
    raise typer.Exit(1 if any(line.agrees == "no" for line in lines) else 0)


@study_app.command(
    "thesis",
    short_help="Run the source's own checks again.",
    epilog="Example: hilplant study thesis",
)
def study_thesis(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Run the source's own checks of motor, park circuits and mechanics.

    Exit code 1 when one does not hold.
    """
    from hilplant.thesis.mechanics_command import thesis_study

    claim(json_file)
    figures, holds = thesis_study(bench)
    write_json(json_file, figures)
    raise typer.Exit(0 if holds else 1)


@study_app.command(
    "solver",
    short_help="Hold the step against an adaptive solver.",
    epilog="Example: hilplant study solver default",
)
def study_solver(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Hold the step against an adaptive solver of the same equations.

    Start, wet and dry, brown-out, stall, reverse, park, wind. Exit code 1 when an error is above 0.5 % of range.
    """
    from hilplant.thesis.mechanics_command import solver_study

    claim(json_file)
    figures, within = solver_study(bench)
    write_json(json_file, figures)
    raise typer.Exit(0 if within else 1)


@study_app.command(
    "twin",
    short_help="Identify data of a known bench.",
    epilog="Example: hilplant study twin --seeds 100 --full 5 --json twin.json",
)
def study_twin(
    bench: BenchName = DEFAULT,
    seeds: Annotated[int, typer.Option(help="noises for the last stage alone; minutes for 100", min=0)] = 10,
    full: Annotated[int, typer.Option(help="noises for all three stages", min=0)] = 1,
    compare: Annotated[bool, typer.Option("--compare", help="also compare the global searches")] = False,
    json_file: JsonFile = None,
) -> None:
    """Identify data of a known bench, and hold the result against the truth.

    Exit code 1 when errors or intervals are worse than they are to be.
    """
    from hilplant.bench import load_bench
    from hilplant.thesis.twin_study import twin_study

    claim(json_file)
    good, figures = twin_study(load_bench(bench), (seeds, full), compare, typer.echo)
    write_json(json_file, figures)
    raise typer.Exit(0 if good else 1)


@study_app.command(
    "wiping",
    short_help="Tell cycles a minute and currents, 9 to 16 V.",
    epilog="Example: hilplant study wiping default",
)
def study_wiping(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Tell cycles a minute and currents from 9 to 16 V, dry and wet.

    With the three figures of FMVSS 104 beside them.
    """
    from hilplant.thesis.mechanics_command import wiping_study

    claim(json_file)
    write_json(json_file, wiping_study(bench))


@study_app.command(
    "surrogates",
    short_help="Compare cost and accuracy of all loads and motors.",
    epilog="Example: hilplant study surrogates --seconds 600 --out study",
)
def study_surrogates(
    seconds: Annotated[float, typer.Option(min=40.0, help="how long each model drives the bus")] = 600.0,
    out: Annotated[Path | None, typer.Option(help="folder for the picture")] = None,
    json_file: JsonFile = None,
) -> None:
    """Compare cost and accuracy of all loads and motors, and what an ECU sees of them.

    Exit code 1 when to the ECU one is not as good as the physics that it stands for.
    """
    from hilplant.thesis.surrogate_study import surrogates_study

    claim(json_file)
    kept, figures = surrogates_study(seconds, out)
    write_json(json_file, figures)
    raise typer.Exit(0 if kept else 1)


@plot_app.command("recording", epilog="Example: hilplant plot recording run.hilrec run.png")
def plot_recording(
    recording: Annotated[Path, typer.Argument(help="what run --record has written")], out: Picture
) -> None:
    """Draw a recording: voltage, current, speed, arms, switches."""
    from hilplant.plots.recording import plot_recording as draw

    draw(recording, out)
    typer.echo(f"{out} written")


@plot_app.command("positions", epilog="Example: hilplant plot positions default wiper.png")
def plot_positions(bench: BenchName, out: Picture) -> None:
    """Draw linkage, arms and blades in four positions."""
    from hilplant.bench import load_bench
    from hilplant.plots.positions import plot_positions as draw

    loaded = load_bench(bench)
    draw(loaded.plant.mechanics.wiper, out, f"{loaded.name}: {loaded.plant.mechanics.written.name}")
    typer.echo(f"{out} written")


@plot_app.command("torque", epilog="Example: hilplant plot torque default torque.png")
def plot_torque(bench: BenchName, out: Picture) -> None:
    """Draw the torque over the crank angle, dry, tacky and wet."""
    from hilplant.bench import load_bench
    from hilplant.plots.mechanics import plot_torque as draw

    draw(load_bench(bench), out)
    typer.echo(f"{out} written")


@plot_app.command("conditions", epilog="Example: hilplant plot conditions default conditions.png")
def plot_conditions(bench: BenchName, out: Picture) -> None:
    """Draw the torque of five wipes, wet, in wind, and dry.

    That is the test of section 4.6.
    """
    from hilplant.bench import load_bench
    from hilplant.plots.mechanics import plot_conditions as draw

    draw(load_bench(bench), out)
    typer.echo(f"{out} written")


@plot_app.command("park", epilog="Example: hilplant plot park park.png")
def plot_park(out: Picture) -> None:
    """Draw slow, fast, off with the three park circuits."""
    from hilplant.plots.park import plot_park_sequences

    plot_park_sequences(out)
    typer.echo(f"{out} written")
