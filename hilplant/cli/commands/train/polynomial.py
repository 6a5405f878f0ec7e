"""`hilplant train polynomial`."""

from pathlib import Path

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, Out
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant train polynomial linkage_alone --out polynomial")
def polynomial(
    bench: BenchName = DEFAULT,
    out: Out = Path("trained-polynomial"),
    json_file: JsonFile = None,
) -> None:
    """Fit the no-load torque of the linkage, section 6.3.

    Two polynomials and two constants, by the costs (6.4) and (6.5).
    """
    need("train")
    from hilplant.cli.actions.train import run_training
    from hilplant.reports.polynomial import train_polynomial

    claim(json_file)
    run_training(lambda _: train_polynomial(bench, out), json_file)
