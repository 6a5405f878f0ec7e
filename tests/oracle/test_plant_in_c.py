"""The step by hand in C and the compiled Python give the same numbers, through every branch of the step."""

import ctypes
import math
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import hilplant
from hilplant.models.plant import simulate_rows
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State, pack
from hilplant.signals import OUTPUT_INDEX, OUTPUTS

SOURCE = Path(hilplant.__file__).parent / "benchmarks" / "step.c"
DOUBLES = ctypes.POINTER(ctypes.c_double)
MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
STIFF = Motor(Brush(8.0, 9e-5, 9.55e-4), Brush(3.9, 1.2e-5, 6.88e-4), 2e-9, 2e-3, 0.0, 1.0)

Rows = NDArray[np.float64]


@pytest.fixture(scope="module")
def step_in_c(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., None]:
    compiler = shutil.which("gcc") or shutil.which("cc")
    if compiler is None:
        pytest.fail("no C compiler: as root, apt-get install gcc libc6-dev")
    library = tmp_path_factory.mktemp("c") / "step.so"
    flags = ["-O3", "-std=c99", "-ffp-contract=off", "-fno-fast-math", "-Wall", "-Wextra", "-Werror", "-shared"]
    subprocess.run([compiler, *flags, "-fPIC", str(SOURCE), "-o", str(library), "-lm"], check=True)
    function = ctypes.CDLL(str(library)).simulate_rows
    function.argtypes = [DOUBLES, DOUBLES, ctypes.c_long, DOUBLES, DOUBLES, ctypes.c_long, DOUBLES]
    function.restype = None

    def run(state: Rows, inputs: Rows, parameters: Rows, tables: Rows, outputs: Rows) -> None:
        state_p, inputs_p, parameters_p, tables_p, outputs_p = (
            array.ctypes.data_as(DOUBLES) for array in (state, inputs, parameters, tables, outputs)
        )
        function(state_p, inputs_p, len(inputs), parameters_p, tables_p, tables.shape[1], outputs_p)

    return run


def mixed_inputs(seed: int) -> Rows:
    """Relays, supply and brake in random blocks, ramps of the brake through the motor's torque, long rests."""
    random = np.random.default_rng(seed)
    blocks = []
    for _ in range(150):
        ticks = int(random.integers(1, 300))
        block = np.tile([random.random() < 0.7, random.random() < 0.5, random.uniform(0, 18), 0, 0, 0.0], (ticks, 1))
        kind = random.integers(4)
        if kind == 1:
            block[:, 5] = random.uniform(0.0, 60.0)
        if kind == 2:
            block[:, 5] = np.linspace(0.0, random.uniform(1.0, 80.0), ticks)
        blocks.append(block)
    return np.concatenate(blocks)


@pytest.mark.parametrize("load", [0.0, 1.0])
@pytest.mark.parametrize(("motor", "dry"), [(MOTOR, 0.0), (MOTOR, 0.045), (STIFF, 0.0), (STIFF, 2e-4)])
def test_both_go_through_a_mixed_scenario_alike(
    step_in_c: Callable[..., None], motor: Motor, dry: float, load: float
) -> None:
    switch = ParkSwitch(0.1, math.radians(8.0), math.radians(2.0), 5.0)
    motor = motor._replace(coulomb_torque_n_m=dry)
    arms = Arm(0.3, 0.6), Arm(-0.4, 0.5)
    parameters = pack(Parameters(1e-3, motor, switch, Load(load, 0.0035, 0.2738), *arms))
    angle = np.linspace(0.0, 2.0 * math.pi, 361)
    tables = np.ascontiguousarray([np.stack([a * np.sin(angle), a * np.cos(angle)], axis=1) for a in (0.7, 0.6)])
    inputs = mixed_inputs(seed=11)
    inputs[-20, 2] = math.nan
    ours, theirs = np.empty((2, len(inputs), len(OUTPUTS)))
    our_state, their_state = np.array([pack(State(0.0, 0.0, 6.2, 1.0, 0.0, 0.0))] * 2)
    simulate_rows(our_state, inputs, parameters, tables, ours)
    step_in_c(their_state, inputs, parameters, tables, theirs)
    assert np.ptp(ours[:, OUTPUT_INDEX["park_contact"]]) == 1.0 or motor.gear_ratio == 1.0
    assert ours[-1, OUTPUT_INDEX["guard"]] == 1.0
    # a sum in another order may move an event by a rounding, nothing more
    scale = np.abs(theirs).max(axis=0) + 1e-300
    assert np.abs((ours - theirs) / scale).max() < 1e-9
    assert our_state == pytest.approx(their_state, rel=1e-9, abs=1e-12)
