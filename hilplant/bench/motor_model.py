"""Which model moves the motor of a bench: the physical one, or a network that was trained for this very motor."""

from dataclasses import dataclass, field
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from hilplant.bench.motor_network_file import FORMAT, Floats, MotorNetworkFile
from hilplant.bench.parameter_hash import motor_hash
from hilplant.bench.parts import MotorFile
from hilplant.checked_yaml.checked import Checked, Name
from hilplant.checked_yaml.checksummed import sealed_file
from hilplant.checked_yaml.place import Place
from hilplant.models.motor_choice import MOTORS
from hilplant.units import SECOND_NS


class OdeMotor(Checked):
    """The physical model, (3.30) to (3.35)."""

    model: Literal["ode"]


class NarxMotor(Checked):
    """A network with feedback, section 6.4.3; the physical model stands by."""

    model: Literal["narx"]
    file: Name


class MotorModelChoice(Checked):
    """The model of the motor, chosen by its name."""

    motor_model: Annotated[OdeMotor | NarxMotor, Field(discriminator="model")]


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


def motor_model(plant: Place, motor: MotorFile, step_ns: int) -> MotorModel | None:
    """Return what moves the motor; None when something is wrong, which has been noted then."""
    place = plant.inner("motor_model")
    if place.data() is None:
        return MotorModel()
    choice = place.reading.check(place.document, plant.location, {"motor_model": place.data()}, MotorModelChoice)
    if choice is None:
        return None
    if isinstance(choice.motor_model, OdeMotor):
        return MotorModel()
    network = _network(place.inner("file"))
    if network is None or not _fits(place, network, motor, step_ns):
        return None
    return MotorModel(float(MOTORS.index("narx")), network.row())


def _network(file: Place) -> MotorNetworkFile | None:
    sealed = sealed_file(file, FORMAT)
    return sealed.take(MotorNetworkFile) if sealed is not None else None


def _fits(place: Place, network: MotorNetworkFile, motor: MotorFile, step_ns: int) -> bool:
    """Note whether the network was trained for another motor or another step."""
    own, step_s = motor_hash(motor), step_ns / SECOND_NS
    if network.parameter_hash != own:
        text = (
            f"this network was trained for the motor '{network.motor}' with parameters {network.parameter_hash}, "
            f"and the bench's '{motor.name}' has {own}; hilplant train motor makes one for it"
        )
        place.note("file", text=text)
    elif network.step_s != step_s:
        text = f"this network was trained for steps of {network.step_s:g} s, and the bench has step_s {step_s:g}"
        place.note("file", text=text)
    return network.parameter_hash == own and network.step_s == step_s
