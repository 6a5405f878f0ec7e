"""An output, an input and a load are each added in two files of a copy of the package, and all else follows.

Recordings from before still replay there.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

#: What is added, as edits: file, the line before which it goes (none: a new file), and the text.
OUTPUT = (
    (
        "signals.py",
        '    load_mode: Annotated[float, choice(ACTIVE_MODELS, "which model gives',
        '    armature_power_w: Annotated[float, real("W", -1e4, 1e4, "power that the armature takes")]\n',
    ),
    (
        "models/plant.py",
        "        load_mode=train.load_mode,\n",
        "        armature_power_w=connection.terminal_v * motion.current,\n",
    ),
)
INPUT = (
    (
        "signals.py",
        "    left_screen: Annotated[",
        '    drag_torque_n_m: Annotated[float, real("N m", 0.0, 50.0, "a worn bearing", guarded=0.0)] = 0.0\n',
    ),
    ("models/reduced.py", "    damping = value(", "    dry += inputs.drag_torque_n_m\n"),
)
SPRING = '''"""A torsion spring at the crank."""

import math

from hilplant.jit import compiled
from hilplant.models.records import Load
from hilplant.models.resistance import Crank, Resistance


@compiled
def spring(crank: Crank, load: Load) -> Resistance:
    """Return a torque that goes with the sine of the angle, `c1` its height [N m]."""
    return Resistance(0.0, load.c1 * math.sin(crank.angle_rad), 0.0, 0.0)
'''
LOAD = (
    ("models/spring.py", "", SPRING),
    (
        "models/load.py",
        "    if load.model == REDUCED or",
        "    if load.model == SPRING:\n        return spring(crank, load)\n",
    ),
    (
        "models/load.py",
        "from hilplant.models.torque_network import NETWORK",
        "from hilplant.models.spring import spring\n",
    ),
    ("models/load.py", ')\n\nNONE = LOADS.index("none")', ', "spring"'),
    ("models/load.py", "\n#: Models that need the tables", 'SPRING = LOADS.index("spring")\n'),
)
#: Tests that run in the copy as they are: the documentation's table, and the rooms.
TESTS = ("tests/unit/test_bus_wiper_database.py", "tests/architecture/test_arrows.py")


def test_an_output_an_input_and_a_load_cost_two_files_each(tmp_path: Path) -> None:
    copy = tmp_path / "copy"
    for part in ("hilplant", "config", "dbc", "docs", "tests"):
        shutil.copytree(ROOT / part, copy / part, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", copy)
    for edits in (OUTPUT, INPUT, LOAD):
        assert len({file for file, _, _ in edits}) == 2
        for edit in edits:
            apply(copy / "hilplant", *edit)
    stale = run(copy, "-m", "pytest", "-q", TESTS[0])
    assert stale.returncode == 1 and "python tests/support/signal_table.py" in stale.stdout
    for compiler, *command in (
        ("off", "tests/support/signal_table.py"),
        ("off", "tests/support/extended.py", str(tmp_path)),
        ("off", "-m", "pytest", "-q", "-x", *TESTS),
        ("on", "-m", "pytest", "-q", "-x", "tests/unit/test_models_row.py"),  # packing and guard
    ):
        done = run(copy, *command, compiler=compiler)
        assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    table = (copy / "docs" / "can.md").read_text(encoding="utf-8")
    assert "| in | `drag_torque_n_m` | N m | 0 to 50 |" in table and "| out | `armature_power_w` | W |" in table


def apply(package: Path, file: str, before: str, text: str) -> None:
    """Write a new file, or put a text before the only place that is so."""
    path = package / file
    if not before:
        assert not path.exists()
        path.write_text(text)
        return
    source = path.read_text()
    assert source.count(before) == 1, f"{file} has {source.count(before)} times {before!r}"
    path.write_text(source.replace(before, text + before))


def run(copy: Path, *arguments: str, compiler: str = "off") -> subprocess.CompletedProcess[str]:
    """Run Python in the copy, with the package as it is there.

    To compile the step takes longer than all else, so it runs as plain Python; what is compiled there is what the
    compiler writes out for the changed records.
    """
    environment = os.environ | {
        "PYTHONPATH": str(copy),
        "NUMBA_CACHE_DIR": str(copy / "cache"),
        "NUMBA_DISABLE_JIT": "1" if compiler == "off" else "0",
    }
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=copy,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
