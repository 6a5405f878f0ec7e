"""The step of the server as fast as it goes: a bench and a scenario in, one row for each tick out."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench, initial_state, load_bench
from hilplant.failure import Failure
from hilplant.faults.player import FaultPlayer, signal_row
from hilplant.faults.written import inserted, refuse_faults_of_the_bus
from hilplant.models.plant import simulate_rows
from hilplant.recording.tables import check_ending, write_table
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, OUTPUTS
from hilplant.simulation.scenario import Scenario, load_scenario
from hilplant.units import SECOND_NS


@dataclass(frozen=True, slots=True)
class Result:
    """Time and signals of a simulation; row k is the tick at time k * step."""

    time_s: Floats
    inputs: Floats
    outputs: Floats

    def __getitem__(self, name: str) -> Floats:
        """Return the column of one signal of ``signals.OUTPUTS`` or ``signals.INPUTS``, or `time_s`."""
        if name == "time_s":
            return self.time_s
        return self.outputs[:, OUTPUT_INDEX[name]] if name in OUTPUT_INDEX else self.inputs[:, INPUT_INDEX[name]]

    def columns(self) -> dict[str, Floats]:
        """Return time, all outputs in their order, then those inputs that are not outputs as well."""
        return {name: self[name] for name in dict.fromkeys(("time_s", *OUTPUT_INDEX, *INPUT_INDEX))}

    def write(self, path: str | Path) -> None:
        """Write all columns as .csv, .parquet or .mf4, by the ending of `path`."""
        units = {signal.name: signal.unit for signal in (*INPUTS, *OUTPUTS)}
        write_table(path, self.columns(), {"time_s": "s"} | units)


def simulate(bench: Bench | str | Path = "default", scenario: Scenario | str | Path = "slow_fast_park") -> Result:
    """Run a bench through a scenario without a bus and without waiting.

    Parameters
    ----------
    bench, scenario
        As loaded, as a path, or as the name of a shipped one.

    """
    bench = bench if isinstance(bench, Bench) else load_bench(bench)
    scenario = scenario if isinstance(scenario, Scenario) else load_scenario(scenario)
    inputs = scenario.input_rows(bench.input_row, bench.step_ns)
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    state = initial_state(bench.parameters, bench.initial | scenario.initial)
    if scenario.faults:
        _simulate_with_faults(bench, scenario, state, (inputs, outputs))
    else:
        simulate_rows(state, inputs, bench.parameter_row, bench.tables, outputs)
    return Result(np.arange(len(inputs)) * bench.step_ns / SECOND_NS, inputs, outputs)


def _simulate_with_faults(bench: Bench, scenario: Scenario, state: Floats, rows: tuple[Floats, Floats]) -> None:
    """Run the inputs of every tick into the outputs, in pieces in which no fault changes."""
    refuse_faults_of_the_bus(scenario.faults)
    inputs, outputs = rows
    step_s = bench.step_ns / SECOND_NS
    player = FaultPlayer(inserted(scenario.faults, step_s), bench.parameter_row, step_s)
    parameter_row, tick, seen = bench.parameter_row.copy(), 0, None
    while tick < len(inputs):
        if tick and player.watches:
            seen = signal_row(INPUTS, inputs[tick - 1]) | signal_row(OUTPUTS, outputs[tick - 1])
        for index, value in player.changes(tick, seen).items():
            parameter_row[index] = value
        end = int(min(player.next_change(tick), len(inputs)))
        simulate_rows(state, inputs[tick:end], parameter_row, bench.tables, outputs[tick:end])
        tick = end


def simulate_to_file(bench: str | Path, scenario: str | Path, out: str | Path) -> str:
    """Simulate, write the result, and return a line that says what was written.

    Raises
    ------
    Failure
        BenchError for mistakes in either file; when `out` cannot be written or memory runs out.

    """
    check_ending(out)
    try:
        result = simulate(bench, scenario)
        result.write(out)
    except MemoryError as error:
        raise Failure(f"{scenario}: its length does not fit into memory, at some 300 bytes a tick") from error
    return f"{out}: {len(result.time_s)} rows, {len(result.columns())} columns"
