"""`hilplant train estimator`."""

from pathlib import Path

from hilplant.atomic_write import claim
from hilplant.cli.groups import command_app
from hilplant.cli.options import DEFAULT, BenchName, JsonFile, Out, Seed
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant train estimator default --out trained --seed 1")
def estimator(
    bench: BenchName = DEFAULT, seed: Seed = 1, out: Out = Path("trained-estimator"), json_file: JsonFile = None
) -> None:
    """Train the speed network (velocity estimator), section 7.5.

    Its error stands beside the observer's. A controller's file names it: `speed: network`. Exit code 1 when it is no
    good with the very motor that it was trained on.
    """
    need("train")
    from hilplant.cli.actions.train import run_training
    from hilplant.reports.estimator import train_estimator

    claim(json_file)
    run_training(lambda on_progress: train_estimator(bench, seed, out, on_progress), json_file)
