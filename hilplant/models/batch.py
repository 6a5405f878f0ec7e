"""The step for one of many parameter sets; :mod:`hilplant.simulation.batch` shares them out among the processors."""

from typing import Any

from hilplant.jit import compiled, compiled_for_threads
from hilplant.models.guard import admitted
from hilplant.models.plant import is_plain, plain, step
from hilplant.models.records import Parameters, State
from hilplant.models.row import unpack, write
from hilplant.signals import Inputs


@compiled_for_threads
def simulate_columns(  # noqa: PLR0913, PLR0917
    state_row: Any, input_rows: Any, parameter_row: Any, tables: Any, columns: Any, output: Any, row: Any
) -> None:
    """Do as ``plant.simulate_rows``, but keep only some of the outputs.

    `columns` are their places in ``signals.OUTPUTS``, `output` an array [ticks, len(columns)]. `row` is room
    for all outputs of one tick.
    """
    parameters = unpack(Parameters, parameter_row)
    if is_plain(parameters):
        columns_with(plain(parameters), state_row, input_rows, tables, columns, output, row)
    else:
        columns_with(parameters, state_row, input_rows, tables, columns, output, row)


@compiled
def columns_with(  # noqa: PLR0913, PLR0917
    parameters: Parameters, state_row: Any, input_rows: Any, tables: Any, columns: Any, output: Any, row: Any
) -> None:
    """Do the same with these parameters."""
    state = admitted(unpack(State, state_row))
    for tick in range(input_rows.shape[0]):
        state, outputs = step(state, unpack(Inputs, input_rows[tick]), parameters, tables)
        write(outputs, row)
        for index in range(columns.shape[0]):
            output[tick, index] = row[columns[index]]
    write(state, state_row)
