"""The plant section of a bench, with the files it names -> the records and tables that the models run on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hilplant.bench.load_files import PolynomialFile, TorqueFile
from hilplant.bench.motor_model import motor_model, row_of_networks
from hilplant.bench.parts import MotorFile
from hilplant.bench.plant_description import (
    AnyLoad,
    BladeEntry,
    BladesSection,
    LoadChoice,
    ParkSwitchSection,
    PlantSection,
    PolynomialLoad,
    WholeWiper,
)
from hilplant.bench.screen_parts import ScreenFile
from hilplant.bench.trained_load import Around, TrainedLoad, keeps_its_bounds, read_trained_load
from hilplant.bench.wiper import SIDES, Mechanics, Surroundings, read_mechanics
from hilplant.checked_yaml.place import Place
from hilplant.failure import Failure
from hilplant.mechanics.coefficients import Aerodynamics, check_aerodynamics
from hilplant.models.circuit import CIRCUITS
from hilplant.models.load import LOADS
from hilplant.models.records import Blade, Friction, Load, Parameters, ParkSwitch
from hilplant.units import MILLISECOND_NS, RAD_PER_DEG, SECOND_NS

Blades = tuple[BladeEntry, BladeEntry]


@dataclass(frozen=True, slots=True)
class Plant:
    """Parameters and tables of one plant, the descriptions they come from, and the mechanics behind the tables."""

    parameters: Parameters
    tables: NDArray[np.float64]
    motor: MotorFile
    load: AnyLoad
    screen: ScreenFile | None
    blades: Blades | None
    mechanics: Mechanics
    park_switch: ParkSwitchSection
    load_file: TorqueFile | PolynomialFile | None = None


def assemble_plant(place: Place, step_ns: int) -> Plant | None:
    """Build the plant; a part that is wrong is noted, and the others are checked all the same."""
    place.take(PlantSection)
    motor = _motor(place.inner("motor"))
    load = _load(place)
    screen, blades = _screen(place.inner("screen")), _blades(place.inner("blades"))
    park_switch = _park_switch(place.inner("park_switch"))
    complete = not isinstance(load, WholeWiper) or _has_screen_and_blades(place)
    mechanics = read_mechanics(place.inner("linkage"), _surroundings(place, load, screen, blades))
    if motor is None or mechanics is None or load is None or park_switch is None or not complete:
        return None
    trained = read_trained_load(place.inner("load"), load, Around(mechanics, screen, blades))
    mover = motor_model(place, motor, step_ns)
    if trained is None or mover is None:
        return None
    record = _load_record(load, trained, screen, blades)
    left, right = mechanics.wiper.left.arm, mechanics.wiper.right.arm
    networks = row_of_networks(trained.numbers, mover.numbers)
    parameters = Parameters(
        step_ns / SECOND_NS, motor.record(), _contact(park_switch, step_ns), record, left, right, mover.place, networks
    )
    if not keeps_its_bounds(place.inner("load"), trained, parameters, mechanics.table):
        return None
    return Plant(parameters, mechanics.table, motor, load, screen, blades, mechanics, park_switch, trained.file)


def _motor(place: Place) -> MotorFile | None:
    file = place.referred_file()
    return file.take(MotorFile) if file is not None else None


def _screen(place: Place) -> ScreenFile | None:
    file = place.referred_file()
    return file.take(ScreenFile) if file is not None else None


def _blades(place: Place) -> Blades | None:
    if not isinstance(place.data(), dict) or place.take(BladesSection) is None:
        return None
    left, right = (_blade(place.inner(side)) for side in SIDES)
    return (left, right) if left is not None and right is not None else None


def _blade(place: Place) -> BladeEntry | None:
    entry = place.take(BladeEntry)
    if entry is None:
        return None
    try:
        check_aerodynamics(f"{place.name} blade", _air(entry))
    except Failure as error:
        place.note(text=str(error))
        return None
    return entry


def _air(entry: BladeEntry) -> Aerodynamics:
    return Aerodynamics(entry.area_m2, entry.drag, entry.lift)


def _load(plant: Place) -> AnyLoad | None:
    data = plant.inner("load").data()
    if not isinstance(data, dict):
        return None
    choice = plant.reading.check(plant.document, plant.location, {"load": data}, LoadChoice)
    return choice.load if choice is not None else None


def _has_screen_and_blades(plant: Place) -> bool:
    kind = plant.inner("load", "model").data()
    missing = [key for key in ("screen", "blades") if plant.inner(key).data() is None]
    for key in missing:
        written = (*plant.location, key) in plant.document.places
        plant.note(key if written else "load", text=f"the {kind} load needs {key} beside it")
    return not missing


def _surroundings(plant: Place, load: AnyLoad | None, screen: ScreenFile | None, blades: Blades | None) -> Surroundings:
    """Return what is known; what is missing is noted, and the linkage is checked all the same."""
    left, right = (_air(entry) for entry in blades) if blades is not None else (Aerodynamics(), Aerodynamics())
    return Surroundings(
        blades=plant.inner("blades"),
        screen_angle_rad=screen.angle_rad if screen is not None else 0.0,
        air=(left, right),
        points=load.points if isinstance(load, WholeWiper) else 1,
        needs_masses=isinstance(load, WholeWiper),
    )


def _load_record(load: AnyLoad, trained: TrainedLoad, screen: ScreenFile | None, blades: Blades | None) -> Load:
    constants = trained.file if isinstance(trained.file, PolynomialFile) else load
    left, right = (Blade(entry.force_n, entry.wear) for entry in blades) if blades is not None else (Blade(), Blade())
    return Load(
        float(LOADS.index(load.model)),
        c1=constants.c1 or 0.0 if isinstance(constants, PolynomialFile | PolynomialLoad) else 0.0,
        c2=constants.c2 or 0.0 if isinstance(constants, PolynomialFile | PolynomialLoad) else 0.0,
        points=float(load.points) if isinstance(load, WholeWiper) else 1.0,
        friction=screen.friction() if screen is not None else Friction(),
        left_blade=left,
        right_blade=right,
    )


def _park_switch(place: Place) -> ParkSwitchSection | None:
    return place.take(ParkSwitchSection) if isinstance(place.data(), dict) else None


def _contact(section: ParkSwitchSection, step_ns: int) -> ParkSwitch:
    return ParkSwitch(
        section.park_angle_deg * RAD_PER_DEG,
        0.5 * section.window_deg * RAD_PER_DEG,
        section.hysteresis_deg * RAD_PER_DEG,
        float(round(section.bounce_ms * MILLISECOND_NS / step_ns)),
        float(CIRCUITS.index(section.circuit)),
        (section.reverse_angle_deg or 0.0) * RAD_PER_DEG,
    )
