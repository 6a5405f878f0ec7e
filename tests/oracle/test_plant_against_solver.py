"""The whole plant at 1 ms against an adaptive solver at tight tolerance, for every published motor.

The reference shares no code with the plant: it writes (3.30), (3.31) and (6.3) down once more, and treats dry
friction as a switched system whose switching instants are located by the solver's events.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from hilplant.models.plant import simulate_rows, tick
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State, pack
from hilplant.signals import OUTPUT_INDEX, OUTPUTS

MOTORS = Path(__file__).parents[2] / "config" / "motors"
STEP_S = 1e-3
TOLERANCE = {"rtol": 1e-10, "atol": 1e-12}
LIMIT_PERCENT = 0.5

#: Motor, dry friction at its shaft [N m], load model. Table 3-1 has the ratio 1, so its load is the stiffest.
CASES = [
    ("table_3_1", 0.0, "none"),
    ("table_3_1", 0.0, "polynomial"),
    ("table_3_1", 2e-4, "polynomial"),
    ("table_5_6", 0.0, "polynomial"),
    ("table_5_6", 0.045, "polynomial"),
    ("table_5_8", 0.0, "polynomial"),
    ("table_5_8", 0.045, "polynomial"),
    ("table_5_9", 0.0, "polynomial"),
    ("table_5_9", 0.045, "polynomial"),
    ("figure_8_3", 0.0, "polynomial"),
    ("figure_8_3", 2e-4, "polynomial"),
]

#: The reference breaks away this much late, so that its rounding does not stop it again at once.
HAIR = 1e-6

Row = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    motor: Motor
    load: str

    def row(self) -> Row:
        load = Load(1.0 if self.load == "polynomial" else 0.0, 0.0035, 0.2738)
        switch = ParkSwitch(0.0, math.radians(5.0), math.radians(1.0), 3.0)
        return pack(Parameters(STEP_S, self.motor, switch, load, Arm(0.1, 0.6), Arm(-0.2, 0.5)))


def case_of(name: str, dry: float, load: str) -> Case:
    text = yaml.safe_load((MOTORS / f"{name}.yaml").read_text())
    brushes = Brush(**text["slow"]), Brush(**text["fast"])
    numbers = text["inertia_kg_m2"], text["damping_n_m_s"], dry, text["gear_ratio"]
    return Case(Motor(*brushes, *numbers), load)


def tables() -> Row:
    angle = np.linspace(0.0, 2.0 * math.pi, 361)
    return np.ascontiguousarray([np.stack([0.7 * np.sin(angle), 0.7 * np.cos(angle)], axis=1)] * 2)


def plant_run(case: Case, inputs: Row) -> Row:
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    simulate_rows(pack(State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)), inputs, case.row(), tables(), outputs)
    return outputs


def polynomial_torque(angle: float, speed: float) -> float:
    x = math.sin(angle)
    f = np.polyval([-0.19224, 0.021769, -0.15435, 0.077812, 0.68626], x)
    g = np.polyval([0.4184, -0.30315, -0.42441, 0.12634, 0.21484, -0.10093, -0.29859, 0.63276], x)
    return float(speed * 0.2738 * ((f if x >= 0.0 else g) + speed * 0.0035))


@dataclass(frozen=True)
class Reference:
    """Right side of the switched system while the inputs of one stretch of ticks hold; sliding +1, -1, or stuck 0."""

    case: Case
    inputs: Row

    @property
    def brush(self) -> Brush:
        return self.case.motor.fast if self.inputs[1] else self.case.motor.slow

    @property
    def dry(self) -> float:
        return float(self.case.motor.coulomb_torque_n_m + self.inputs[5] / self.case.motor.gear_ratio)

    def right_side(self, sliding: float) -> Callable[[float, Row], list[float]]:
        brush, motor = self.brush, self.case.motor
        voltage = self.inputs[2] if self.inputs[0] else 0.0
        ratio = motor.gear_ratio

        def rates(_: float, x: Row) -> list[float]:
            current, speed, angle = x
            rise = (voltage - brush.resistance_ohm * current - brush.constant_v_s * speed) / brush.inductance_henry
            if self.dry and not sliding:
                return [(voltage - brush.resistance_ohm * current) / brush.inductance_henry, 0.0, 0.0]
            load = polynomial_torque(angle, speed / ratio) if self.case.load == "polynomial" else 0.0
            torque = brush.constant_v_s * current - motor.damping_n_m_s * speed - load / ratio - sliding * self.dry
            return [rise, torque / motor.inertia_kg_m2, speed / ratio]

        return rates

    def direction(self, x: Row) -> float:
        """+1 or -1 when sliding, 0 when stuck or without dry friction."""
        if not self.dry:
            return 0.0
        if x[1] != 0.0:
            return math.copysign(1.0, x[1])
        torque = self.brush.constant_v_s * x[0]
        return math.copysign(1.0, torque) if abs(torque) > self.dry * (1.0 + 0.9 * HAIR) else 0.0

    def end_of(self, sliding: float) -> Callable[[float, Row], float]:
        """Return what falls through zero where sliding ends, or where sticking ends."""

        def stops(_: float, x: Row) -> float:
            return float(sliding * x[1])

        def breaks_away(_: float, x: Row) -> float:
            return float(self.dry * (1.0 + HAIR) - abs(self.brush.constant_v_s * x[0]))

        event = stops if sliding else breaks_away
        event.terminal = bool(self.dry)  # type: ignore[attr-defined]
        event.direction = -1.0  # type: ignore[attr-defined]
        return event


def integrate(reference: Reference, x: Row, grid: Row) -> Iterator[Row]:
    """Yield the state at grid[1:], going from event to event; the last one is where the next stretch starts."""
    time = grid[0]
    while time < grid[-1]:
        sliding = reference.direction(x)
        if sliding and x[1] == 0.0:
            x[1] = sliding * 1e-9  # else the solver's rounding may call the start of the motion its end
        wanted = grid[grid > time]
        run = solve_ivp(
            reference.right_side(sliding),
            (time, grid[-1]),
            x,
            method="Radau" if reference.case.motor.inertia_kg_m2 < 1e-6 else "DOP853",
            t_eval=wanted,
            events=reference.end_of(sliding),
            **TOLERANCE,
        )
        yield from np.asarray(run.y).T
        if run.status != 1 or not reference.dry:
            return
        time, x = run.t_events[0][0], run.y_events[0][0]
        x[1] = 0.0


def reference_run(case: Case, inputs: Row) -> Row:
    """Return current, motor speed and crank angle (not wrapped) at each tick."""
    changes = np.flatnonzero(np.any(np.diff(inputs, axis=0) != 0.0, axis=1)) + 1
    edges = [0, *changes, len(inputs) - 1]
    rows = [np.zeros(3)]
    for first, last in pairwise(edges):
        if last > first:
            grid = np.arange(first, last + 1) * STEP_S
            rows.extend(integrate(Reference(case, inputs[first]), rows[-1].copy(), grid))
    return np.array(rows)


def scenario() -> Row:
    """Slow, a voltage step, fast, stall and release by the brake, slow again, off."""
    inputs = np.tile([0.0, 0.0, 13.5, 0.0, 0.0, 0.0], (620, 1))
    inputs[10:560, 0] = 1.0
    inputs[130:220, 2] = 10.0
    inputs[220:480, 1] = 1.0
    inputs[320:400, 5] = 60.0
    return inputs


def errors_percent(plant: Row, truth: Row) -> dict[str, float]:
    """RMS of the difference in percent of the range, for current and motor speed."""
    found = {}
    for column, name in enumerate(("current_a", "motor_speed_rad_s")):
        difference = plant[:, OUTPUT_INDEX[name]] - truth[:, column]
        found[name] = float(100.0 * np.sqrt(np.mean(difference**2)) / np.ptp(truth[:, column]))
    return found


@pytest.mark.parametrize(("name", "dry", "load"), CASES)
def test_switching_and_stall_agree_with_the_adaptive_solver(name: str, dry: float, load: str) -> None:
    case = case_of(name, dry, load)
    plant, truth = plant_run(case, scenario()), reference_run(case, scenario())
    assert len(truth) == len(plant)
    errors = errors_percent(plant, truth)
    print(f"\n{name:<11} dry {dry:<6} {load:<11} RMS of range: "
          f"current {errors['current_a']:.1e} %, speed {errors['motor_speed_rad_s']:.1e} %", end="")  # fmt: skip
    assert max(errors.values()) < LIMIT_PERCENT / 10.0
    turned = (plant[-1, OUTPUT_INDEX["crank_angle_rad"]] - truth[-1, 2] + math.pi) % (2.0 * math.pi) - math.pi
    assert abs(turned) < 2e-4


def park_inputs(case: Case) -> Row:
    """Run slow for a turn and switch off at the tick after the park contact closes, as an ECU does."""
    rows, state, output = [], pack(State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)), np.empty(len(OUTPUTS))
    parameters, table = case.row(), tables()
    on, left_window = 1.0, False
    for _ in range(1900):
        rows.append([on, 0.0, 13.5, 0.0, 0.0, 0.0])
        tick(state, np.array(rows[-1]), parameters, table, output)
        left_window |= output[OUTPUT_INDEX["crank_angle_rad"]] > 1.0
        if left_window and output[OUTPUT_INDEX["park_contact"]]:
            on = 0.0
    return np.array(rows)


@pytest.mark.parametrize(("name", "dry"), [("table_5_6", 0.0), ("table_5_9", 0.0), ("table_5_9", 0.045)])
def test_a_park_stop_agrees_with_the_adaptive_solver(name: str, dry: float) -> None:
    case = case_of(name, dry, "polynomial")
    inputs = park_inputs(case)
    plant, truth = plant_run(case, inputs), reference_run(case, inputs)
    errors = errors_percent(plant, truth)
    stop = plant[-1, OUTPUT_INDEX["crank_angle_rad"]]
    print(f"\n{name:<11} dry {dry:<6} park: current {errors['current_a']:.1e} %, "
          f"speed {errors['motor_speed_rad_s']:.1e} %, stops at {math.degrees(stop):.3f} deg", end="")  # fmt: skip
    assert inputs[-1, 0] == 0.0
    assert max(errors.values()) < LIMIT_PERCENT / 10.0
    assert abs(stop - (truth[-1, 2] % (2.0 * math.pi))) < 2e-4
    assert plant[-1, OUTPUT_INDEX["park_contact"]] == 1.0
