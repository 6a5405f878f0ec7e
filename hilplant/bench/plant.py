"""The plant section of a bench, with the files it names -> the records and tables that the models run on."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from hilplant.bench.description import LoadChoice, NoLoad, ParkSwitchSection, PlantSection
from hilplant.bench.parts import LinkageFile, MotorFile
from hilplant.bench.place import Place
from hilplant.mechanics.arms import arm, arm_points
from hilplant.mechanics.design_points import GeometryError
from hilplant.mechanics.linkage import SlaveDrivenLinkage, rocker_tables
from hilplant.mechanics.newton_raphson import SolutionError
from hilplant.models.load import LOADS
from hilplant.models.records import Arm, Load, Motor, Parameters, ParkSwitch
from hilplant.units import MILLISECOND_NS, RAD_PER_DEG, SECOND_NS

Built = TypeVar("Built")


@dataclass(frozen=True, slots=True)
class Plant:
    """Parameters and tables of one plant."""

    parameters: Parameters
    tables: NDArray[np.float64]


def assemble_plant(place: Place, step_ns: int) -> Plant | None:
    """Build the plant; a part that is wrong is noted, and the others are checked all the same."""
    place.take(PlantSection)
    motor = _motor(place.inner("motor"))
    linkage = _linkage(place.inner("linkage"))
    load = _load(place)
    park_switch = _park_switch(place.inner("park_switch"), step_ns)
    if motor is None or linkage is None or load is None or park_switch is None:
        return None
    tables, left_arm, right_arm = linkage
    return Plant(Parameters(step_ns / SECOND_NS, motor, park_switch, load, left_arm, right_arm), tables)


def _motor(place: Place) -> Motor | None:
    file = place.referred_file()
    description = file.take(MotorFile) if file is not None else None
    return description.record() if description is not None else None


def _linkage(place: Place) -> tuple[NDArray[np.float64], Arm, Arm] | None:
    """Return the rockers' tables and both arms, all from one file."""
    file = place.referred_file()
    description = file.take(LinkageFile) if file is not None else None
    if file is None or description is None:
        return None
    tables = _attempt(file.inner("points_m"), lambda: _tables(description))
    points = [
        _attempt(file.inner(side, "points_m"), partial(arm_points, section.kind, section.points_m))
        for side, section in (("left_arm", description.left_arm), ("right_arm", description.right_arm))
    ]
    if tables is None or points[0] is None or points[1] is None:
        return None
    return tables, arm(points[0], tables[0, 0, 0]), arm(points[1], tables[1, 0, 0])


def _tables(description: LinkageFile) -> NDArray[np.float64]:
    return rocker_tables(SlaveDrivenLinkage.from_points(description.points_m))


def _attempt(place: Place, build: Callable[[], Built]) -> Built | None:
    try:
        return build()
    except (GeometryError, SolutionError) as error:
        place.note(text=str(error))
        return None


def _load(plant: Place) -> Load | None:
    data = plant.inner("load").data()
    if not isinstance(data, dict):
        return None
    choice = plant.reading.check(plant.document, plant.location, {"load": data}, LoadChoice)
    if choice is None:
        return None
    load = choice.load
    model = float(LOADS.index(load.model))
    return Load(model, 0.0, 0.0) if isinstance(load, NoLoad) else Load(model, load.c1, load.c2)


def _park_switch(place: Place, step_ns: int) -> ParkSwitch | None:
    if not isinstance(place.data(), dict):
        return None
    section = place.take(ParkSwitchSection)
    if section is None:
        return None
    return ParkSwitch(
        section.park_angle_deg * RAD_PER_DEG,
        0.5 * section.window_deg * RAD_PER_DEG,
        section.hysteresis_deg * RAD_PER_DEG,
        float(round(section.bounce_ms * MILLISECOND_NS / step_ns)),
    )
