"""The step by hand in C, compiled where it is measured: the limit for the compiled Python."""

import ctypes
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilplant.perf.results import NotMeasurable

#: Contraction to fused multiply-add is off, as in the compiled Python: the digits shall be the same.
FLAGS = ("-O3", "-ffp-contract=off", "-std=c11")
WITH_OPENMP = "-fopenmp"

Rows = NDArray[np.float64]
#: State, inputs [ticks, inputs], parameters, tables, outputs [ticks, outputs].
SimulateRows = Callable[[Rows, Rows, Rows, Rows, Rows], None]

_SOURCE = Path(__file__).with_name("step.c")
_WITH_NETWORKS = Path(__file__).with_name("networks.c")
_DOUBLES = ctypes.POINTER(ctypes.c_double)


def compiler() -> str:
    """Return the name and version of the C compiler."""
    if shutil.which("gcc") is None:
        raise NotMeasurable("gcc is not here; as root: apt-get install gcc")
    said = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=False)
    return f"gcc {said.stdout.strip()}"


def compile_step(folder: Path, *more_flags: str) -> SimulateRows:
    """Compile step.c into `folder` and return its loop, which takes the same arrays as `simulate_rows`."""
    function = _library(folder, more_flags).simulate_rows

    def simulate(state: Rows, inputs: Rows, parameters: Rows, tables: Rows, outputs: Rows) -> None:
        arrays = (state, inputs, parameters, tables, outputs)
        function(*_addresses(arrays), _shape(arrays))

    return simulate


def compile_batch(folder: Path, columns: Sequence[int], *more_flags: str) -> SimulateRows:
    """Compile step.c with OpenMP and return its loop over many sets on all processors.

    It takes states [sets, states], inputs [ticks, inputs] of all sets, parameters [sets, parameters], tables of all
    sets, and outputs [sets, ticks, columns], of which it fills those outputs whose places are in `columns`.
    """
    function = _library(folder, (WITH_OPENMP, *more_flags)).simulate_batch
    places = (ctypes.c_long * len(columns))(*columns)

    def simulate(states: Rows, inputs: Rows, parameters: Rows, tables: Rows, outputs: Rows) -> None:
        arrays = (states, inputs, parameters, tables, outputs)
        function(*_addresses(arrays), _shape(arrays), places)

    return simulate


def compile_networks(folder: Path, *more_flags: str) -> SimulateRows:
    """Compile networks.c into `folder` and return its loop, for benches with a torque or a motor network."""
    function = _library(folder, more_flags, _WITH_NETWORKS).simulate_networks

    def simulate(state: Rows, inputs: Rows, parameters: Rows, tables: Rows, outputs: Rows) -> None:
        arrays = (state, inputs, parameters, tables, outputs)
        function(*_addresses(arrays), _shape(arrays))

    return simulate


def _library(folder: Path, more_flags: tuple[str, ...], source: Path = _SOURCE) -> ctypes.CDLL:
    compiler()
    library = folder / f"{source.stem}{''.join(more_flags)}.so"
    command = ["gcc", *FLAGS, *more_flags, "-shared", "-fPIC", str(source), "-o", str(library), "-lm"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise NotMeasurable(f"gcc: {(ended.stderr.strip() or 'no message').splitlines()[0]}")
    return ctypes.CDLL(str(library))


def _addresses(arrays: Sequence[Rows]) -> list[Any]:
    if not all(array.dtype == np.float64 and array.flags.c_contiguous for array in arrays):
        raise ValueError("the step in C takes contiguous arrays of 64-bit floats")
    return [array.ctypes.data_as(_DOUBLES) for array in arrays]


def _shape(arrays: Sequence[Rows]) -> Any:
    states, inputs, parameters, tables, outputs = arrays
    sets = len(parameters) if parameters.ndim > 1 else 1
    widths = (array.shape[-1] for array in (states, inputs, parameters, outputs))
    return (ctypes.c_long * 8)(sets, len(inputs), *tables.shape[:2], *widths)
