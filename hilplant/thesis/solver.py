"""The step at 1 ms beside the adaptive solver: scenarios that reach every branch, and the errors in percent."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats
from hilplant.models.plant import simulate_rows
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, OUTPUTS
from hilplant.thesis.reference import Reference
from hilplant.thesis.reference_equations import Channels

#: Wetness of the screen.
DRY, TACKY, WET = 0.0, 0.5, 1.0


class Rows:
    """Rows of inputs with their defaults, one for each tick; `set` changes some of them."""

    def __init__(self, ticks: int, **values: float) -> None:
        self.rows = np.tile([signal.default for signal in INPUTS], (ticks, 1))
        self.set(0, ticks, **values)

    def set(self, first: int, last: int, **values: float | Floats) -> "Rows":
        """Set signals in the ticks from `first` up to but not including `last`."""
        for name, value in values.items():
            self.rows[first:last, INPUT_INDEX[name]] = value
        return self


def start_and_run() -> Floats:
    """From rest, slow, then fast, on a wet screen."""
    return Rows(900, screen=WET).set(10, 900, relay_on=1).set(450, 900, relay_fast=1).rows


def wet_and_dry() -> Floats:
    """The screen changes while the wiper runs: wet, dry at once, tacky, and slowly wet again; then one side only."""
    rows = Rows(1500, screen=WET, relay_on=1).set(300, 600, screen=DRY).set(600, 800, screen=TACKY)
    return rows.set(800, 1000, screen=np.linspace(TACKY, WET, 200)).set(1200, 1500, left_screen=DRY).rows


def brown_out() -> Floats:
    """The supply falls to 6 V, stays and comes back, on a dry screen: the wiper crawls and may stand."""
    fall, rise = np.linspace(13.5, 6.0, 100), np.linspace(6.0, 13.5, 100)
    rows = Rows(1600, screen=DRY, relay_on=1).set(400, 500, supply_v=fall).set(500, 1000, supply_v=6.0)
    return rows.set(1000, 1100, supply_v=rise).rows


def stall_and_release() -> Floats:
    """A brake of 60 N m at the crank stalls the running wiper; then it is let go."""
    return Rows(1000, screen=WET, relay_on=1).set(400, 600, brake_torque_n_m=60.0).rows


def reverse() -> Floats:
    """The supply turns round at full speed, so that the motor stops hard and wipes backwards."""
    return Rows(1200, screen=WET, relay_on=1).set(400, 900, supply_v=-13.5).rows


def park() -> Floats:
    """Switched off, the motor brakes through its grounded brush and stands; later it starts again."""
    return Rows(1000, screen=WET, relay_on=1).set(500, 800, relay_on=0).rows


def wind() -> Floats:
    """Wind of 40 m/s helps one wipe and hinders the other, with a worn blade and a weak arm."""
    rows = Rows(1500, screen=WET, relay_on=1, left_wear=1.5, right_force=0.6)
    return rows.set(200, 1200, vehicle_speed_m_s=40.0).set(1200, 1500, relay_on=0).rows


SCENARIOS: dict[str, Callable[[], Floats]] = {
    "start and run": start_and_run,
    "wet and dry": wet_and_dry,
    "brown-out to 6 V": brown_out,
    "stall and release": stall_and_release,
    "reverse": reverse,
    "park": park,
    "wind": wind,
}


@dataclass(frozen=True)
class SolverErrors:
    """RMS of the difference between step and reference in percent of the signal's range, and both runs."""

    current_percent: float
    speed_percent: float
    angle_percent: float
    outputs: Floats
    truth: Floats

    @property
    def worst_percent(self) -> float:
        """The largest of the three."""
        return max(self.current_percent, self.speed_percent, self.angle_percent)


def run_step(parameters: Parameters, tables: Floats, input_rows: Floats, state: State | None = None) -> Floats:
    """Return the outputs of the plant at each tick, from rest at park if nothing else is said."""
    outputs = np.empty((len(input_rows), len(OUTPUTS)))
    start = pack(state or State(park_contact=1.0))
    simulate_rows(start, input_rows, pack(parameters), tables, outputs)
    return outputs


def compare(
    parameters: Parameters, tables: Floats, channels: Channels, input_rows: Floats, slowest_rad_s: float = 0.005
) -> SolverErrors:
    """Return the errors of the step on `tables` against the reference on `channels`, from rest at park."""
    outputs = run_step(parameters, tables, input_rows)
    truth = Reference(parameters, channels, slowest_rad_s).run(input_rows)
    return SolverErrors(*errors_percent(outputs, truth), outputs, truth)


def errors_percent(outputs: Floats, truth: Floats) -> tuple[float, float, float]:
    """Return the RMS errors of current, motor speed and crank angle in percent of their ranges."""
    angle = np.unwrap(outputs[:, OUTPUT_INDEX["crank_angle_rad"]])
    columns = outputs[:, OUTPUT_INDEX["current_a"]], outputs[:, OUTPUT_INDEX["motor_speed_rad_s"]], angle
    found = []
    for ours, theirs in zip(columns, truth.T, strict=True):
        found.append(float(100.0 * np.sqrt(np.mean((ours - theirs) ** 2)) / np.ptp(theirs)))
    return found[0], found[1], found[2]
