"""Many parameter sets in one call, on all processors: for identification, campaigns and training data.

Each set runs the very step of the server and gives the same bits as a run of its own, however many threads there
are. The threads are Python's own and the compiled code runs without its lock: nothing has to be installed for them,
several calls at a time are safe, and a program that forks may use them. numba's parallel loops promise neither
without a package of its own.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

import numpy as np

from hilplant.arrays import Floats, Whole
from hilplant.models.batch import simulate_columns
from hilplant.models.load import WHOLE_WIPER
from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX
from hilplant.models.tables import channels as channel_count
from hilplant.signals import INPUTS, OUTPUT_INDEX, OUTPUTS

#: Shares for each thread, so that one with quick sets does not wait long for the others.
_SHARES = 4


def simulate_batch(  # noqa: PLR0913, PLR0917
    state_rows: Floats,
    input_rows: Floats,
    parameter_rows: Floats,
    tables: Floats,
    columns: Sequence[str | int],
    output: Floats | None = None,
    threads: int | None = None,
) -> Floats:
    """Run every parameter set through its inputs, and return the wanted columns.

    Parameters
    ----------
    state_rows
        Array [sets, states]: where each set starts; left where it ends.
    input_rows
        Array [ticks, inputs] for all sets, or [sets, ticks, inputs].
    parameter_rows
        Array [sets, parameters], packed.
    tables
        Array [knots + 1, channels, 2] for all sets, or [sets, knots + 1, channels, 2].
    columns
        Names of ``signals.OUTPUTS``, or their places.
    output
        Array [sets, ticks, columns] to be filled; made when left out.
    threads
        As many as processors when left out.

    Returns
    -------
    ndarray of shape [sets, ticks, columns]
        `output`.

    Raises
    ------
    ValueError
        For shapes that do not fit each other: compiled code would read beyond them.

    """
    places = np.array([OUTPUT_INDEX[c] if isinstance(c, str) else c for c in columns], dtype=np.int64)
    inputs = np.ascontiguousarray(input_rows if input_rows.ndim == 3 else input_rows[np.newaxis])
    curves = np.ascontiguousarray(tables if tables.ndim == 4 else tables[np.newaxis])
    sets, ticks = len(parameter_rows), inputs.shape[1]
    if output is None:
        output = np.empty((sets, ticks, len(places)))
    _check(state_rows, inputs, parameter_rows, curves, places, output)
    threads = threads or len(os.sched_getaffinity(0))
    cuts = np.linspace(0, sets, min(sets, threads * _SHARES) + 1).astype(int)
    shares = [range(first, last) for first, last in pairwise(cuts.tolist())]
    arrays = state_rows, inputs, parameter_rows, curves, places, output
    with ThreadPoolExecutor(threads) as pool:
        for done in [pool.submit(_run, arrays, share) for share in shares]:
            done.result()
    return output


def _run(arrays: tuple[Any, ...], share: range) -> None:
    states, inputs, parameters, tables, places, output = arrays
    row = np.empty(len(OUTPUTS))
    for k in share:
        own_inputs, own_tables = inputs[k if len(inputs) > 1 else 0], tables[k if len(tables) > 1 else 0]
        simulate_columns(states[k], own_inputs, parameters[k], own_tables, places, output[k], row)


def _check(  # noqa: PLR0913, PLR0917
    states: Floats, inputs: Floats, parameters: Floats, tables: Floats, places: Whole, output: Floats
) -> None:
    """Refuse arrays that compiled code would not survive."""
    sets, ticks = len(parameters), inputs.shape[1]
    knots, channels = tables.shape[1:3]
    wanted = (
        ("state_rows", states, (sets, len(STATE_INDEX))),
        ("parameter_rows", parameters, (sets, max(len(PARAMETER_INDEX), parameters.shape[-1]))),
        ("input_rows", inputs, (len(inputs) if len(inputs) == 1 else sets, ticks, len(INPUTS))),
        ("tables", tables, (len(tables) if len(tables) == 1 else sets, knots, channels, 2)),
        ("output", output, (sets, ticks, len(places))),
    )
    for name, array, shape in wanted:
        if array.shape != shape:
            raise ValueError(f"{name} has the shape {list(array.shape)}, not {list(shape)}")
        if array.dtype != np.float64 or not array.flags.c_contiguous:
            raise ValueError(f"{name} is not a contiguous array of 64-bit floats")
    if len(places) and not (places.min() >= 0 and places.max() < len(OUTPUTS)):
        raise ValueError(f"columns are places from 0 to {len(OUTPUTS) - 1}")
    points = parameters[:, PARAMETER_INDEX["load.points"]].max(initial=1.0)
    reduced = np.isin(parameters[:, PARAMETER_INDEX["load.model"]], WHOLE_WIPER)
    if reduced.any() and channels < channel_count(int(points)):
        raise ValueError(f"tables have {channels} channels, not the {channel_count(int(points))} for {points:g} points")
