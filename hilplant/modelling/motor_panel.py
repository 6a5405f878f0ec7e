"""The motor alone: current and speed, slow then fast, at a torque and a voltage (8.3.1, Appendix A)."""

from dataclasses import dataclass
from typing import Any, NamedTuple

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.bench.parts import MotorFile
from hilplant.bench.plant_description import NoLoad, PlantSection
from hilplant.failure import Failure
from hilplant.models.records import Brush
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.entries import Entry
from hilplant.simulation.run import simulate
from hilplant.simulation.scenario import Scenario

#: Longest simulation [s].
LONGEST_S = 60.0


@dataclass(frozen=True, slots=True)
class MotorTest:
    """What the motor is put through; the torque is at the gear's output.

    It runs slow from `on_s`, fast from `fast_s`, and is off from `off_s` on. With `switching` the bench's park switch,
    supply, wires and relays stand between; without, the voltage is at its terminals.
    """

    torque_n_m: float = 0.05
    voltage_v: float = 13.5
    on_s: float = 1.0
    fast_s: float = 2.0
    off_s: float = 3.0
    end_s: float = 4.0
    switching: bool = False

    def __post_init__(self) -> None:
        """Refuse times and values that are none."""
        if not 0.0 <= self.on_s < self.fast_s < self.off_s < self.end_s <= LONGEST_S:
            raise Failure(f"times must rise: on, fast, off, end, up to {LONGEST_S:g} s")
        if not (self.torque_n_m >= 0.0 and 0.0 <= self.voltage_v <= 40.0):
            raise Failure("the torque must not be below 0, and the voltage must lie within 0 and 40 V")


class SteadyPoint(NamedTuple):
    """Where a motor settles: armature current, speed of its shaft, speed of the gear's output."""

    current_a: float
    motor_speed_rad_s: float
    output_speed_rad_s: float


class MotorCurves(NamedTuple):
    """Time, current and speed of the gear's output; where each mode settled, and where it settles in closed form."""

    time_s: Floats
    current_a: Floats
    output_speed_rad_s: Floats
    settled: dict[str, SteadyPoint]
    closed_form: dict[str, SteadyPoint]


def run_motor(motor: MotorFile, test: MotorTest, section: PlantSection | None = None) -> MotorCurves:
    """Simulate the motor against a constant torque, with the step of the server; `section` has what switches it.

    The torque is a brake, so that it holds a motor at rest where a torque would turn it back.

    Raises
    ------
    Failure
        When the parameters make no motor that can be simulated.

    """
    description = load_bench("default").description
    update: dict[str, Any] = {"motor": motor, "load": NoLoad(model="none")}
    if test.switching and section is not None:
        update |= {key: getattr(section, key) for key in ("park_switch", "supply", "wires", "relays")}
    plant = description.plant.model_copy(update=update)
    bench = load_bench(description.model_copy(update={"plant": plant}))
    result = simulate(bench, _scenario(test))
    ends = {"slow": test.fast_s, "fast": test.off_s}
    rows = {mode: round(end * 1e9 / bench.step_ns) - 1 for mode, end in ends.items()}
    columns = [result[name] for name in ("current_a", "motor_speed_rad_s", "crank_speed_rad_s")]
    settled = {mode: SteadyPoint(*(float(column[row]) for column in columns)) for mode, row in rows.items()}
    return MotorCurves(result.time_s, columns[0], columns[2], settled, steady_points(motor, test))


def steady_points(motor: MotorFile, test: MotorTest) -> dict[str, SteadyPoint]:
    """Return where both modes settle by (3.33): V = R i + K w, K i = b w + T; 0 where the motor stalls.

    T is the torque at the shaft, that at the output through the gear while the motor drives, and the dry friction.
    """
    at_shaft = test.torque_n_m / (motor.gear_ratio * motor.gear_efficiency) + motor.coulomb_torque_n_m
    brushes = {"slow": motor.slow.record(), "fast": motor.fast.record()}
    return {mode: _steady(brush, motor, test.voltage_v, at_shaft) for mode, brush in brushes.items()}


def _steady(brush: Brush, motor: MotorFile, voltage_v: float, torque_n_m: float) -> SteadyPoint:
    resistance, constant, damping = brush.resistance_ohm, brush.constant_v_s, motor.damping_n_m_s
    speed = (constant * voltage_v - resistance * torque_n_m) / (constant**2 + resistance * damping)
    if speed <= 0.0:
        return SteadyPoint(voltage_v / resistance, 0.0, 0.0)
    return SteadyPoint((voltage_v - constant * speed) / resistance, speed, speed / motor.gear_ratio)


def ratios(motor: MotorFile) -> dict[str, float | bool]:
    """Return fast over slow of R, L and K, and whether each keeps (3.32): the fast winding has fewer turns."""
    found: dict[str, float | bool] = {}
    for key in ("resistance_ohm", "inductance_henry", "constant_v_s"):
        fast, slow = getattr(motor.fast, key), getattr(motor.slow, key)
        found |= {f"{key}_ratio": fast / slow, f"{key}_in_order": fast < slow}
    return found


def _scenario(test: MotorTest) -> Scenario:
    entries = {
        "relay_on": ((0.0, 0.0), (test.on_s, 1.0), (test.off_s, 0.0)),
        "relay_fast": ((0.0, 0.0), (test.fast_s, 1.0)),
        "supply_v": ((0.0, test.voltage_v),),
        "brake_torque_n_m": ((0.0, test.torque_n_m),),
    }
    written = {INPUT_INDEX[name]: tuple(Entry(*pair) for pair in pairs) for name, pairs in entries.items()}
    return Scenario(test.end_s, {}, written)
