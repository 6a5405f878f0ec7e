"""Which model moves the motor of a bench: the physical one, or a network that was trained for this very motor."""

from dataclasses import dataclass, field

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.motor_network_file import MotorNetworkFile
from hilplant.bench.parameter_hash import motor_hash
from hilplant.bench.parts import MotorFile
from hilplant.bench.plant_description import NarxMotor, OdeMotor
from hilplant.checked_yaml.spot import NAMED, Spot
from hilplant.models.motor_choice import MOTORS
from hilplant.units import SECOND_NS


@dataclass(frozen=True, slots=True)
class MotorModel:
    """The place of the model in ``motor_choice.MOTORS``, and the numbers of its network, if it has one."""

    place: float = 0.0
    numbers: Floats = field(default_factory=lambda: np.zeros(0))


def row_of_networks(load_numbers: Floats, motor_numbers: Floats) -> Floats:
    """Return the row of all networks; `load_numbers` begins with how many numbers follow it, or is empty."""
    if not len(motor_numbers):
        return load_numbers
    return np.concatenate([load_numbers if len(load_numbers) else np.zeros(1), motor_numbers])


def build_motor_model(spot: Spot, choice: OdeMotor | NarxMotor | None, motor: MotorFile, step_ns: int) -> MotorModel:
    """Return what moves the motor; a network that does not fit is noted."""
    if not isinstance(choice, NarxMotor):
        return MotorModel()
    _check_fits(spot, choice.file, motor, step_ns)
    return MotorModel(float(MOTORS.index("narx")), choice.file.row())


def _check_fits(spot: Spot, network: MotorNetworkFile, motor: MotorFile, step_ns: int) -> None:
    """Note whether the network was trained for another motor or another step."""
    own, step_s = motor_hash(motor), step_ns / SECOND_NS
    if network.parameter_hash != own:
        text = (
            f"this network was trained for the motor '{network.motor}' with parameters {network.parameter_hash}, "
            f"and the bench's '{motor.name}' has {own}; hilplant train motor makes one for it"
        )
        spot.note("file", NAMED, text=text)
    elif network.step_s != step_s:
        text = f"this network was trained for steps of {network.step_s:g} s, and the bench has step_s {step_s:g}"
        spot.note("file", NAMED, text=text)
