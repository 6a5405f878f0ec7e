"""The step in C, compiled where it is measured: the limit for the compiled Python."""

import ctypes
import hashlib
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numba
import numpy as np
from llvmlite.binding import get_host_cpu_features, get_host_cpu_name

from hilplant.arrays import Floats
from hilplant.c_source import compiler as c_compiler
from hilplant.c_source.c_types import BOOLEAN, Array, Type
from hilplant.c_source.compiler import FLAGS, compile_library
from hilplant.c_source.plant_files import ROW, ROWS, TABLES, WRITABLE_ROW, WRITABLE_ROWS, plant_c, plant_h
from hilplant.failure import Failure
from hilplant.models.batch import simulate_columns
from hilplant.models.torque_samples import network_tangents
from hilplant.perf.results import NotMeasurable

__all__ = [
    "FLAGS",
    "SimulateRows",
    "Tangents",
    "compile_batch",
    "compile_network",
    "compile_step",
    "compiler",
    "library",
]

#: State, inputs [ticks, inputs], parameters, tables, outputs [ticks, outputs].
SimulateRows = Callable[[Floats, Floats, Floats, Floats, Floats], None]
#: Numbers of the networks, whether the screen is wet, states [n, 2], torques and derivatives [n, 3].
Tangents = Callable[[Floats, bool, Floats, Floats], None]

#: What is measured besides the step, and the arrays that it takes.
_MORE: dict[Any, tuple[Type, ...]] = {
    simulate_columns: (
        WRITABLE_ROW, ROWS, ROW, TABLES, Array((None,), of="int64_t"), WRITABLE_ROWS, WRITABLE_ROW,
    ),
    network_tangents: (ROW, BOOLEAN, ROWS, WRITABLE_ROWS),
}  # fmt: skip


class CompiledPlant(ctypes.Structure):
    """``hilplant_plant`` in plant.h."""

    _fields_ = (
        ("parameters", ctypes.c_void_p),
        ("parameter_count", ctypes.c_int64),
        ("tables", ctypes.c_void_p),
        ("knots", ctypes.c_int64),
        ("channels", ctypes.c_int64),
    )

    @classmethod
    def of(cls, parameters: Floats, tables: Floats) -> "CompiledPlant":
        """Return the plant of packed parameters and tables, which must live as long as it does."""
        return cls(_at(parameters), len(parameters), _at(tables), *tables.shape[:2])


def compiler() -> str:
    """Return the name and version of the C compiler."""
    try:
        return c_compiler.compiler()
    except Failure as error:
        raise NotMeasurable(str(error)) from error


def compile_step(*more_flags: str) -> SimulateRows:
    """Compile the step and return its loop, which takes the same arrays as `simulate_rows`."""
    function = library(*more_flags).hilplant_simulate

    def simulate(state: Floats, inputs: Floats, parameters: Floats, tables: Floats, outputs: Floats) -> None:
        plant = CompiledPlant.of(parameters, tables)
        function(ctypes.byref(plant), _at(state), ctypes.c_int64(len(inputs)), _at(inputs), _at(outputs))

    return simulate


def compile_batch(columns: Sequence[int]) -> SimulateRows:
    """Compile the step and return its loop over many sets on all processors.

    It takes states [sets, states], inputs [ticks, inputs] of all sets, parameters [sets, parameters], tables of all
    sets, and outputs [sets, ticks, columns], of which it fills those outputs whose indices are in `columns`.
    """
    function = library().simulate_batch
    indices = (ctypes.c_int64 * len(columns))(*columns)

    def simulate(states: Floats, inputs: Floats, parameters: Floats, tables: Floats, outputs: Floats) -> None:
        plants = (CompiledPlant * len(parameters))(*(CompiledPlant.of(row, tables) for row in parameters))
        sets, ticks, count = (ctypes.c_int64(each) for each in (len(parameters), len(inputs), len(columns)))
        function(plants, sets, _at(states), ticks, _at(inputs), count, indices, _at(outputs))

    return simulate


def compile_network() -> Tangents:
    """Compile the torque network; the function takes the same arrays as `network_tangents`."""
    function = library().torque_tangents

    def tangents(numbers: Floats, wet: bool, states: Floats, into: Floats) -> None:
        length, count = ctypes.c_int64(len(numbers)), ctypes.c_int64(len(states))
        function(_at(numbers), length, ctypes.c_int(wet), _at(states), count, _at(into))

    return tangents


@cache
def library(*more_flags: str) -> ctypes.CDLL:
    """Compile the step and what is measured besides it, and load it; it is kept beside what numba has compiled.

    Raises `NotMeasurable` when there is no compiler.
    """
    text = plant_c(_MORE, Path(__file__).with_name("measured.c").read_text(encoding="utf-8"))
    processor = get_host_cpu_name() + get_host_cpu_features().flatten()
    decides = "\n".join((text, plant_h(), compiler(), processor, *FLAGS, *more_flags))
    folder = Path(vars(numba.config)["CACHE_DIR"])
    kept = folder / f"plant-{hashlib.sha256(decides.encode()).hexdigest()[:16]}.so"
    try:
        if not kept.exists():
            with TemporaryDirectory(prefix="c-", dir=folder) as made:
                compile_library(text, plant_h(), Path(made), "-fopenmp", *more_flags).replace(kept)
    except Failure as error:
        raise NotMeasurable(str(error)) from error
    return ctypes.CDLL(str(kept))


def _at(array: Floats) -> ctypes.c_void_p:
    if array.dtype != np.float64 or not array.flags.c_contiguous:
        raise ValueError("the step in C takes contiguous arrays of 64-bit floats")
    return ctypes.c_void_p(array.ctypes.data)
