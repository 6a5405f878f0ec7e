"""A console of any code page shows everything that a command has to say."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

COUNT = 3000
#: The library of the command line takes an ASCII console as one that was set up wrongly, and writes UTF-8.
WRITTEN = {"ascii": "utf-8"}


@pytest.fixture
def table(tmp_path: Path) -> Path:
    """A recording whose names no old code page has, and which says much before it is refused."""
    time_s = np.arange(COUNT) * 1e-3
    volts = np.where(time_s < 0.5, 0.0, 12.0)
    rows = [
        f"{1e6 * t:.0f},{v},{0.2 * v + 1e-9 * t:.3f},{int(t % 1.0 < 0.05)}" for t, v in zip(time_s, volts, strict=True)
    ]
    path = tmp_path / "Prüfstand Ω 試験.csv"
    path.write_text("\n".join(["time [\u03bcs],Spannung Ü [V],Strom µ [A],Endlage Tür", *rows]), "utf-8")
    return path


def run(encoding: str, *arguments: str) -> subprocess.CompletedProcess[bytes]:
    environment = os.environ | {"PYTHONIOENCODING": encoding, "NUMBA_DISABLE_JIT": "1", "PYTHONUTF8": "0"}
    return subprocess.run(
        [sys.executable, "-m", "hilplant", *arguments], check=False, capture_output=True, env=environment, timeout=300
    )


@pytest.mark.parametrize("encoding", ["ascii", "iso-8859-1", "cp437", "utf-8"])
def test_inspect_says_all_on_any_console(table: Path, encoding: str) -> None:
    done = run(
        encoding,
        "inspect",
        str(table),
        "--columns",
        "voltage=Spannung Ü,current=Strom µ,park=Endlage Tür",
        "--mode",
        "slow",
    )
    shown = (done.stdout + done.stderr).decode(WRITTEN.get(encoding, encoding))
    assert done.returncode in (0, 1), shown
    assert "UnicodeEncodeError" not in shown
    assert "Traceback" not in shown
    assert "park contact: closed above" in shown
    assert "Endlage Tür" in shown


@pytest.mark.parametrize("encoding", ["ascii", "iso-8859-1"])
def test_check_says_all_on_any_console(tmp_path: Path, encoding: str) -> None:
    bench = tmp_path / "Prüfstand 試験.yaml"
    bench.write_text("name: Tür Ω\nextends: default.yaml\nplant: {Größe: 3}\n", "utf-8")
    done = run(encoding, "check", str(bench))
    shown = (done.stdout + done.stderr).decode(WRITTEN.get(encoding, encoding))
    assert done.returncode == 1, shown
    assert "UnicodeEncodeError" not in shown
    assert "Traceback" not in shown
    assert ":3" in shown
