"""What the motor network learns from: the physical plant under a supply, a load and relays that change at random.

Appendix F of Dooner (2016) shows the thesis' signals in figures only. What its text asks for is here: all that the
motor does must happen in the first 70 % of the time, up to 18 V.
"""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.bench import Bench
from hilplant.models.load import NETWORK, REDUCED
from hilplant.models.plant import simulate_rows
from hilplant.models.records import Brush, Parameters
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
from hilplant.units import TURN_RAD

#: Length of each brush's data [s]; 70 % of it are the 11.2 s that section 6.4.3 names.
LENGTH_S = 16.0
#: A little above the 18 V that section 6.4.4 names, so that 18 V are well within.
MOST_V = 18.5
MOST_BRAKE_N_M = 12.0
#: The network begins above this speed of the crank [rad/s]: below it static friction rules, which is no function of
#: what the network knows.
LEAST_RAD_S = 0.2
SHARES = (0.70, 0.85)


@dataclass(frozen=True, slots=True)
class DrivenSequence:
    """One brush's data by tick: inputs [n, 2] voltage and torque, outputs [n, 2] current and speed, both at the crank.

    `known[k]` says that the network is to predict tick k + 1 from tick k; elsewhere the physical model is active.
    """

    inputs: Floats
    outputs: Floats
    known: Flags

    @property
    def predicted(self) -> Flags:
        """Which ticks the network answers for."""
        return np.concatenate([[False], self.known[:-1]])

    def parts(self) -> tuple[Flags, Flags, Flags]:
        """Return which ticks belong to training, validation and test: split by time, as section 6.4.3 does."""
        first, second = (int(share * len(self.known)) for share in SHARES)
        place = np.arange(len(self.known))
        hit = self.predicted
        return hit & (place < first), hit & (place >= first) & (place < second), hit & (place >= second)


def physical(parameters: Parameters) -> Parameters:
    """Return the same plant without networks: the physical motor, and the reduced load for a torque network."""
    load = parameters.load
    if load.model == NETWORK:
        load = load._replace(model=float(REDUCED))
    return parameters._replace(load=load, motor_model=0.0, networks=np.zeros(0))


def excitation(bench: Bench, brush: str, seconds: float, random: np.random.Generator) -> Floats:
    """Return rows of inputs: relay, supply, screen and brake, each held or on a ramp for 20 to 400 ms.

    Every other time it is 1 to 15 ms, as of a relay that chatters: the motor then meets pairs of current and voltage
    that it never has when it is left to settle.
    """
    count = round(seconds / bench.parameters.step_s)
    rows = np.tile(bench.input_row, (count, 1))
    rows[:, INPUT_INDEX["relay_fast"]] = float(brush == "fast")
    first = 0
    while first < count:
        held_s = random.uniform(0.02, 0.4) if random.random() < 0.4 else random.uniform(0.001, 0.015)
        last = min(count, first + max(1, round(held_s / bench.parameters.step_s)))
        block = rows[first:last]
        block[:, INPUT_INDEX["relay_on"]] = float(random.random() < (0.85 if held_s > 0.015 else 0.6))
        begin_v, end_v = random.uniform(6.0 if random.random() < 0.85 else 0.0, MOST_V, 2)
        held = random.random() < 0.7
        block[:, INPUT_INDEX["supply_v"]] = begin_v if held else np.linspace(begin_v, end_v, last - first)
        block[:, INPUT_INDEX["screen"]] = random.uniform(0.0, 1.0)
        braked = random.random() < 0.5
        block[:, INPUT_INDEX["brake_torque_n_m"]] = random.uniform(0.0, MOST_BRAKE_N_M) if braked else 0.0
        first = last
    return rows


def recorded(bench: Bench, brush: str, seconds: float, random: np.random.Generator) -> DrivenSequence:
    """Run the physical plant and return what the network is to learn from it.

    The torque is the mean one through the gear in each tick, from the integrals of (3.30) and (3.31) over the tick.
    """
    parameters = physical(bench.parameters)
    parameters = parameters._replace(park_switch=parameters.park_switch._replace(circuit=0.0))
    rows = excitation(bench, brush, seconds, random)
    outputs = np.empty((len(rows), len(OUTPUTS)))
    simulate_rows(bench.state_row.copy(), rows, pack(parameters), bench.tables, outputs)
    voltage, current, speed, angle = (
        outputs[:, OUTPUT_INDEX[name]] for name in ("terminal_v", "current_a", "crank_speed_rad_s", "crank_angle_rad")
    )
    ends = parameters.motor.slow if brush == "slow" else parameters.motor.fast
    torque = mean_torque(voltage, current, np.unwrap(angle, period=TURN_RAD), speed, (parameters, ends))
    known = np.zeros(len(speed) - 1, dtype=bool)
    known[1:-1] = (speed[1:-2] > LEAST_RAD_S) & (speed[2:-1] > LEAST_RAD_S)
    return DrivenSequence(np.stack([voltage[:-1], torque], axis=1), np.stack([current, speed], axis=1)[:-1], known)


def mean_torque(
    voltage: Floats, current: Floats, crank_rad: Floats, crank_speed: Floats, motor_and_brush: tuple[Parameters, Brush]
) -> Floats:
    """Return the mean torque through the gear in each tick, at the crank [N m]: what the motor's balance leaves."""
    parameters, brush = motor_and_brush
    motor, step_s, ratio = parameters.motor, parameters.step_s, parameters.motor.gear_ratio
    turned, change = np.diff(crank_rad) * ratio, np.diff(crank_speed) * ratio
    flux = brush.inductance_henry * np.diff(current)
    charge = (voltage[:-1] * step_s - brush.constant_v_s * turned - flux) / brush.resistance_ohm
    impulse = brush.constant_v_s * charge - motor.damping_n_m_s * turned - motor.inertia_kg_m2 * change
    dry = motor.coulomb_torque_n_m * np.sign(crank_speed[1:])
    torque: Floats = (impulse / step_s - dry) * ratio
    return np.where(np.abs(torque) < 1e-9, 0.0, torque)
