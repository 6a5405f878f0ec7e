"""The step by hand in C, compiled where it is measured: the limit for the compiled Python."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilplant.benchmarks.results import NotMeasurable

#: Contraction to fused multiply-add is off, as in the compiled Python: the digits shall be the same.
FLAGS = ("-O3", "-ffp-contract=off", "-std=c11")

Rows = NDArray[np.float64]
SimulateRows = Callable[[Rows, Rows, Rows, Rows, Rows], None]

_SOURCE = Path(__file__).with_name("step.c")
_DOUBLES = ctypes.POINTER(ctypes.c_double)


def compiler() -> str:
    """Return the name and version of the C compiler."""
    if shutil.which("gcc") is None:
        raise NotMeasurable("gcc is not here; as root: apt-get install gcc")
    said = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=False)
    return f"gcc {said.stdout.strip()}"


def compile_step(folder: Path, *more_flags: str) -> SimulateRows:
    """Compile step.c into `folder` and return its loop, which takes the same arrays as `simulate_rows`."""
    compiler()
    library = folder / f"step{''.join(more_flags)}.so"
    command = ["gcc", *FLAGS, *more_flags, "-shared", "-fPIC", str(_SOURCE), "-o", str(library), "-lm"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise NotMeasurable(f"gcc: {(ended.stderr.strip() or 'no message').splitlines()[0]}")
    return _bound(ctypes.CDLL(str(library)).simulate_rows)


def _bound(function: Any) -> SimulateRows:
    function.restype = None
    function.argtypes = [_DOUBLES, _DOUBLES, ctypes.c_long, _DOUBLES, _DOUBLES, ctypes.c_long, _DOUBLES]

    def simulate_rows(state: Rows, inputs: Rows, parameters: Rows, tables: Rows, outputs: Rows) -> None:
        state_at, inputs_at, parameters_at, tables_at, outputs_at = (
            row.ctypes.data_as(_DOUBLES) for row in (state, inputs, parameters, tables, outputs)
        )
        knots = tables.shape[1]
        function(state_at, inputs_at, len(inputs), parameters_at, tables_at, knots, outputs_at)

    return simulate_rows
