"""The step in C and the compiled Python give the same bits, through every branch of the step."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from support.closed_form import ClosedFormWiper

from hilplant.models.circuit import CIRCUITS
from hilplant.models.plant import simulate_rows
from hilplant.models.records import STATE_INDEX, Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.perf.c_step import SimulateRows, compile_batch, compile_step
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, OUTPUTS
from hilplant.simulation.batch import simulate_batch

Rows = NDArray[np.float64]
Random = np.random.Generator

#: Loads without networks, by the number that ``Load.model`` gives them.
LOADS = {"none": 0.0, "polynomial": 1.0, "reduced": 2.0}
TABLES = {
    points: ClosedFormWiper(points=points, pivot_damping_n_m_s=damping).tables(256)
    for points, damping in ((1, 0.0), (3, 0.1))
}
FRICTION = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02, 900.0
)
STIFF = Motor(Brush(8.0, 9e-5, 9.55e-4), Brush(3.9, 1.2e-5, 6.88e-4), 2e-9, 2e-3, 0.0, 1.0)
BLOCKS = 120


@pytest.fixture(scope="module")
def step_in_c() -> SimulateRows:
    return compile_step()


def any_motor(random: Random) -> Motor:
    """A motor about that of Table 5-9, frictionless or not, with a gear that the load can drive or not."""
    slow, fast = (
        Brush(*np.array(brush) * random.uniform(0.6, 1.6, 3))
        for brush in ((1.237, 3.148e-3, 4.579e-2), (1.026, 2.571e-3, 3.412e-2))
    )
    dry = random.choice([0.0, 0.02, 0.045])
    gear = (random.uniform(40.0, 80.0), random.uniform(0.4, 1.0), random.choice([0.0, 0.0, 0.5]))
    return Motor(slow, fast, random.uniform(1e-5, 1e-4), random.choice([0.0, 1.582e-4]), dry, *gear)


def any_plant(random: Random, load: str, circuit: str, motor: Motor | None = None) -> Parameters:
    switch = ParkSwitch(
        random.uniform(0.0, 6.2), random.uniform(0.02, 0.3), random.uniform(0.0, 0.1), float(random.integers(0, 9)),
        float(CIRCUITS.index(circuit)), random.uniform(0.0, 0.6),
    )  # fmt: skip
    blades = [Blade(random.choice([0.0, 4.0, 7.615, 15.0]), random.uniform(0.5, 2.0)) for _ in range(2)]
    carried = Load(LOADS[load], 0.0035, 0.2738, random.choice(list(TABLES)), FRICTION, *blades)
    return Parameters(1e-3, motor or any_motor(random), switch, carried, Arm(0.3, 0.69), Arm(-0.4, 0.54))


def any_inputs(random: Random, blocks: int = BLOCKS) -> Rows:
    """Blocks of everything that drives the plant, ramps of the brake through the motor's torque, long rests."""
    rows = []
    for _ in range(blocks):
        ticks = int(random.integers(1, 300))
        block = np.tile([signal.default for signal in INPUTS], (ticks, 1))
        drawn = {
            "relay_on": random.random() < 0.7,
            "relay_fast": random.random() < 0.5,
            "supply_v": random.choice([random.uniform(0.0, 18.0), 13.5, -12.0]),
            "screen": random.choice([0.0, 0.5, 1.0, random.random()]),
            "vehicle_speed_m_s": random.choice([0.0, 0.0, random.uniform(0.0, 70.0)]),
            "brake_torque_n_m": random.choice([0.0, 0.0, random.uniform(0.0, 60.0)]),
            "left_screen": random.choice([-1.0, -1.0, random.random()]),
            "right_screen": random.choice([-1.0, -1.0, random.random()]),
            **{name: random.choice([1.0, 1.0, random.uniform(0.0, 3.0)])
               for name in ("left_wear", "right_wear", "left_force", "right_force")},
        }  # fmt: skip
        for name, value in drawn.items():
            block[:, INPUT_INDEX[name]] = value
        if random.random() < 0.25:
            block[:, INPUT_INDEX["brake_torque_n_m"]] = np.linspace(0.0, random.uniform(1.0, 80.0), ticks)
        rows.append(block)
    return np.concatenate(rows)


def run_both(step_in_c: SimulateRows, plant: Parameters, inputs: Rows, start: State) -> Rows:
    """Run both, compare every bit of outputs and of the state at the end, and return the outputs."""
    tables, parameters = TABLES[int(plant.load.points)], pack(plant)
    ours, theirs = np.full((2, len(inputs), len(OUTPUTS)), math.nan)
    our_state, their_state = np.array([pack(start)] * 2)
    simulate_rows(our_state, inputs, parameters, tables, ours)
    step_in_c(their_state, inputs, parameters, tables, theirs)
    differing = np.flatnonzero((ours.view(np.int64) != theirs.view(np.int64)).any(axis=1))
    assert not differing.size, f"tick {differing[0]}: {ours[differing[0]]} and in C {theirs[differing[0]]}"
    assert our_state.tobytes() == their_state.tobytes()
    return ours


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("circuit", CIRCUITS)
@pytest.mark.parametrize("load", LOADS)
def test_both_go_through_a_random_scenario_alike(step_in_c: SimulateRows, load: str, circuit: str, seed: int) -> None:
    random = np.random.default_rng([seed, list(LOADS).index(load), CIRCUITS.index(circuit)])
    plant, inputs = any_plant(random, load, circuit), any_inputs(random)
    inputs[-20, random.integers(len(INPUTS))] = random.choice([math.nan, math.inf])
    outputs = run_both(step_in_c, plant, inputs, State(0.0, 0.0, random.uniform(0.0, 6.28), 0.0, 0.0, 0.0))
    assert np.isfinite(outputs).all()
    assert outputs[-1, OUTPUT_INDEX["guard"]] == 1.0
    speed = outputs[:, OUTPUT_INDEX["motor_speed_rad_s"]]
    assert (speed == 0.0).any()
    assert (speed != 0.0).any()


@pytest.mark.parametrize("dry", [0.0, 2e-4])
@pytest.mark.parametrize("load", ["none", "polynomial"])
def test_the_motor_with_a_time_constant_of_microseconds_is_the_same(
    step_in_c: SimulateRows, load: str, dry: float
) -> None:
    random = np.random.default_rng(11)
    plant = any_plant(random, load, "digital", STIFF._replace(coulomb_torque_n_m=dry))
    run_both(step_in_c, plant, any_inputs(random), State(0.0, 0.0, 6.2, 1.0, 0.0, 0.0))


def test_the_random_scenarios_reach_every_branch(step_in_c: SimulateRows) -> None:
    """What the comparison above is worth: rest, both directions, bouncing, the parked phases, lifted blades."""
    seen: list[Rows] = []
    phases = set()
    for seed in range(6):
        random = np.random.default_rng(seed)
        plant, inputs = any_plant(random, "reduced", "depressed"), any_inputs(random)
        state, outputs = pack(State(0.0, 0.0, 1.0, 0.0, 0.0, 0.0)), np.empty((len(inputs), len(OUTPUTS)))
        parameters, tables = pack(plant), TABLES[int(plant.load.points)]
        for tick in range(len(inputs)):
            row = slice(tick, tick + 1)
            step_in_c(state, inputs[row], parameters, tables, outputs[row])
            phases.add(float(state[STATE_INDEX["park_phase"]]))
        seen.append(outputs)
    column = {name: np.concatenate([rows[:, place] for rows in seen]) for name, place in OUTPUT_INDEX.items()}
    assert phases == {0.0, 1.0, 2.0}
    speed, current = column["motor_speed_rad_s"], column["current_a"]
    assert (speed > 1.0).any()
    assert (speed < -1.0).any()
    assert ((speed == 0.0) & (np.abs(current) > 1.0)).any()
    assert ((column["left_force_n"] == 0.0) & (speed != 0.0)).any()
    assert set(np.unique(column["park_contact"])) == {0.0, 1.0}


def test_the_batch_in_c_is_the_batch() -> None:
    """The batch in C does the same work: the same columns of the same sets, bit for bit."""
    random = np.random.default_rng(3)
    plants = [any_plant(random, load, "digital") for load in LOADS for _ in range(4)]
    plants = [plant._replace(load=plant.load._replace(points=1.0)) for plant in plants]
    parameters, inputs = np.array([pack(plant) for plant in plants]), any_inputs(random, 10)
    columns = [OUTPUT_INDEX[name] for name in ("crank_angle_rad", "load_torque_n_m", "current_a")]
    ours, theirs = np.full((2, len(plants), len(inputs), len(columns)), math.nan)
    our_states, their_states = np.array([[pack(State(0.0, 0.0, 1.0, 0.0, 0.0, 0.0))] * len(plants)] * 2)
    simulate_batch(our_states, inputs, parameters, TABLES[1], columns, ours)
    compile_batch(columns)(their_states, inputs, parameters, TABLES[1], theirs)
    assert ours.tobytes() == theirs.tobytes()
    assert our_states.tobytes() == their_states.tobytes()
    assert np.ptp(ours[:, :, 0]) > 0.1
