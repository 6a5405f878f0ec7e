"""Prove the lower bounds of pyproject.toml: an environment that holds exactly these runs every command, and tests.

python tests/lower_bounds.py [FOLDER]     # several minutes; FOLDER (.lower-bounds) holds the environment afterwards

The libraries that those need in turn are the newest that fit. Exit code 1 when a command or a test fails.
"""

import itertools
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TESTS = (
    "tests/unit",
    "tests/property",
    "tests/scenario/recording",
    "tests/scenario/test_ecu_with_plant.py",
    "tests/scenario/test_loop_under_fault.py",
    "tests/oracle/test_plant_against_solver.py",
    "tests/oracle/test_identify_published.py",
)
#: What is run besides the help of each command; {out} is an empty folder.
COMMANDS = (
    "--version",
    "check",
    "simulate slow_fast_park --out {out}/wipe.csv",
    "simulate slow_fast_park --out {out}/wipe.mf4",
    "simulate slow_fast_park --out {out}/wipe.parquet",
    "run virtual --seconds 1 --record {out}/run.hilrec",
    "replay {out}/run.hilrec",
    "export {out}/run.hilrec {out}/run.blf",
    "ecu virtual --seconds 1 --stalk 0:slow",
    "control virtual --seconds 1",
    "plot positions default {out}/wiper.png",
    "study thesis",
    "doctor",
)
#: Prints the names of all commands.
_NAMES = "from hilplant.cli.main import app; from typer.main import get_command; print(*get_command(app).commands)"


def lower_bounds() -> list[str]:
    """Return each library that pyproject.toml names, at its lower bound, as pip's constraints."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    named = itertools.chain(project["dependencies"], *project["optional-dependencies"].values())
    return sorted({requirement.replace(">=", "==") for requirement in named if ">=" in requirement})


def main(folder: Path) -> int:
    """Make the environment, run the commands and the tests; return the exit code."""
    python, hilplant = folder / "bin/python", folder / "bin/hilplant"
    subprocess.run([sys.executable, "-m", "venv", "--clear", folder], check=True)
    constraints = folder / "lower_bounds.txt"
    constraints.write_text("\n".join(lower_bounds()) + "\n", encoding="utf-8")
    print(constraints.read_text(encoding="utf-8"), flush=True)
    pip = [python, "-m", "pip", "install", "-q", "--disable-pip-version-check", "-c", constraints]
    subprocess.run([*pip, f"{ROOT}[test]"], check=True)
    names = subprocess.check_output([python, "-c", _NAMES], text=True, cwd=folder).split()
    with tempfile.TemporaryDirectory() as out:
        words = [[name, "--help"] for name in names] + [line.format(out=out).split() for line in COMMANDS]
        failed = [" ".join(line) for line in words if not runs([hilplant, *line], Path(out))]
        arguments = [python, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-m", "not vcan", *TESTS]
        if not runs(arguments, ROOT, quiet=False):
            failed.append("the tests")
    print(f"{len(words)} commands and the tests of {len(TESTS)} places; failed: {', '.join(failed) or 'none'}")
    return 1 if failed else 0


def runs(words: list[object], folder: Path, quiet: bool = True) -> bool:
    """Run a program; show what it said when it failed."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    output = subprocess.PIPE if quiet else None
    ended = subprocess.run([str(word) for word in words], cwd=folder, stdin=subprocess.DEVNULL, stdout=output,
                           stderr=subprocess.STDOUT, text=True, check=False, env=environment)  # fmt: skip
    if ended.returncode and quiet:
        print(f"FAILED {ended.args[1:]}: {ended.stdout[-2000:]}", flush=True)
    return ended.returncode == 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / ".lower-bounds").resolve()))
