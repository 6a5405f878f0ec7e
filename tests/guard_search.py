"""A search for a tick in which a network is active outside its training: all inputs, faults, and what a bench can add.

::

    python tests/guard_search.py 10000            # so many scenarios of 300 ticks; exit code 1 when one is found

Each tick is taken from the same state by the networks, by the physical motor, and by the physical motor and load; the
difference counts where the network is active, against the bounds that the networks' files state.
"""

import sys
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
import yaml

from hilplant.arrays import Floats
from hilplant.bench import Bench, load_bench
from hilplant.bench.load_files import TorqueFile
from hilplant.bench.motor_network_file import MotorNetworkFile
from hilplant.faults.catalogue import FAULTS
from hilplant.faults.player import FaultPlayer
from hilplant.faults.timing import Inserted
from hilplant.jit import compiled_for_threads
from hilplant.models.load import REDUCED
from hilplant.models.narx import NETWORK
from hilplant.models.plant import step
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack, unpack
from hilplant.resources import shipped
from hilplant.signals import INPUT_INDEX, INPUTS, Inputs
from hilplant.train.motor_search import TICKS, wild_scenario

#: What a bench can add to the plant, as sections of YAML.
ADDITIONS = (
    "supply: {resistance_ohm: 0.15}",
    "wires: {terminal_53_ohm: 0.1, terminal_31_ohm: 0.05}",
    "heat: {winding_j_k: 150, case_j_k: 450, winding_to_case_w_k: 0.6, case_to_ambient_w_k: 0.4}",
    "wear: {blades_percent: 5, brushes_ohm: 0.001, cam_deg: 0.1, start_wipes: 10000}",
    "water: {washer_mm_s: 0.1, runoff_percent_s: 4, evaporation_mm_h: 0.5, wiped_percent: 60, dry_mm: 0.0005,"
    " tacky_mm: 0.001, wet_mm: 0.003, sensor_mm: 0.05}",
    "backlash: {angle_deg: 2}",
    "obstacles: {left: {above: {angle_deg: 60, stiffness_n_m_rad: 60}}}",
)


class Worst(NamedTuple):
    """The largest differences where a network was active, as parts of its bounds, and ticks in which one was."""

    current: float
    speed: float
    torque: float
    motor_ticks: float
    load_ticks: float
    scenario: int


@compiled_for_threads
def differences(state_row: Any, input_rows: Any, parameter_rows: Any, tables: Any, found: Any) -> None:
    """Run a scenario by the networks; `parameter_rows`: networks, motor physical, all physical, the same changed.

    `found` takes the largest differences in current, crank speed and torque of the load, and the ticks of motor and
    load network; `found[5]` is the tick from which on the changed parameters hold.
    """
    state = unpack(State, state_row)
    for tick in range(input_rows.shape[0]):
        first = 3 if tick >= found[5] else 0
        inputs, before = unpack(Inputs, input_rows[tick]), state
        parameters = unpack(Parameters, parameter_rows[first])
        state, seen = step(before, inputs, parameters, tables)
        motor, _ = step(before, inputs, unpack(Parameters, parameter_rows[first + 1]), tables)
        _, truth = step(before, inputs, unpack(Parameters, parameter_rows[first + 2]), tables)
        if state.memory.mode == NETWORK:
            ratio = parameters.motor.gear_ratio
            found[0] = max(found[0], abs(state.current_a - motor.current_a))
            found[1] = max(found[1], abs(state.motor_speed_rad_s - motor.motor_speed_rad_s) / ratio)
            found[3] += 1.0
        if state.load_mode == NETWORK:
            found[2] = max(found[2], abs(seen.load_torque_n_m - truth.load_torque_n_m))
            found[4] += 1.0


def scenario(bench: Bench, benches: list[Bench], seed: int, k: int) -> tuple[Floats, Floats, Floats, float]:
    """Return state, inputs, six rows of parameters, and the tick from which on the last three hold."""
    state, rows = wild_scenario(bench, np.random.default_rng([seed, k]))
    random = np.random.default_rng([seed, k, 1])
    for signal in INPUTS:
        if random.random() < 0.3 and signal.name not in ("relay_on", "relay_fast", "supply_v"):
            first = int(random.integers(TICKS))
            last = first + int(random.integers(1, TICKS))
            rows[first:last, INPUT_INDEX[signal.name]] = random.uniform(signal.minimum, min(signal.maximum, 200.0))
    own = benches[int(random.integers(len(benches)))] if random.random() < 0.3 else bench
    physical_motor = own.parameters._replace(motor_model=0.0)
    physical = physical_motor._replace(load=own.parameters.load._replace(model=float(REDUCED)))
    plain = [pack(each) for each in (own.parameters, physical_motor, physical)]
    changed = [row.copy() for row in plain]
    if random.random() < 0.6:
        fault = FAULTS[int(random.integers(len(FAULTS)))]
        values = {q.name: float(random.uniform(q.minimum, min(q.maximum, q.minimum + 100.0))) for q in fault.quantities}
        for row in changed:
            for index, value in FaultPlayer([Inserted(fault, fault.complete(values))], row, 1e-3).changes(0).items():
                row[index] = value
    return state, rows, np.stack([*plain, *changed]), float(random.integers(TICKS))


def bounds(bench: Bench) -> tuple[float, float, float]:
    """Return what the files of both networks promise: current [A], speed of the crank [rad/s], torque [N m]."""
    file = bench.plant.load_file
    assert isinstance(file, TorqueFile)
    text = (shipped("config", "surrogates") / "motor_default.yaml").read_text(encoding="utf-8")
    motor = MotorNetworkFile.model_validate(yaml.safe_load(text)).bound
    return motor.current_a, motor.crank_speed_rad_s, max(file.bounds.dry_n_m, file.bounds.wet_n_m)


def search(scenarios: int, seed: int = 1, bench: Bench | None = None, threads: int = 1) -> Worst:
    """Try that many scenarios; each has its own random numbers."""
    bench = bench or load_bench("networks")
    benches = [load_bench(f"extends: networks.yaml\nname: more\nplant: {{{each}}}\n") for each in ADDITIONS]
    limits = bounds(bench)

    def tried(k: int) -> Worst:
        state, rows, parameters, from_tick = scenario(bench, benches, seed, k)
        found = np.array([0.0, 0.0, 0.0, 0.0, 0.0, from_tick])
        differences(state, rows, parameters, bench.tables, found)
        return Worst(*(found[:3] / limits).tolist(), *found[3:5].tolist(), k)

    with ThreadPoolExecutor(threads) as pool:
        done = list(pool.map(tried, range(scenarios)))
    worst = max(done, key=lambda each: max(each[:3]))
    columns = list(zip(*done, strict=True))
    return Worst(max(columns[0]), max(columns[1]), max(columns[2]), sum(columns[3]), sum(columns[4]), worst.scenario)


if __name__ == "__main__":
    wanted = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    result = search(wanted)
    print(f"{wanted} scenarios of {TICKS} ticks: motor network active in {result.motor_ticks:.0f}, torque network")
    print(f"{result.load_ticks:.0f}; of their bounds: current {result.current:.3f}, crank speed {result.speed:.3f}")
    print(f"torque {result.torque:.3f}; scenario {result.scenario} is the worst")
    raise SystemExit(0 if max(result[:3]) <= 1.0 else 1)
