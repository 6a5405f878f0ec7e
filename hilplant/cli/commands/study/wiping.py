"""`hilplant study wiping`."""

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, write_json

app = command_app()


@app.command(
    epilog="Example: hilplant study wiping default",
)
def wiping(bench: BenchName = DEFAULT, json_file: JsonFile = None) -> None:
    """Report the wipe rate and currents, 9 to 16 V.

    Dry and wet, with the three figures of FMVSS 104 beside them.
    """
    from hilplant.cli.report import print_report
    from hilplant.thesis.mechanics_studies import wiping_study

    claim(json_file)
    study = wiping_study(bench)
    print_report(study.parts)
    write_json(json_file, study.figures)
