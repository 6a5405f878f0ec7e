"""The plant section of a bench, with the files it names -> the records and tables that the models run on."""

from dataclasses import dataclass

from hilplant.arrays import Floats
from hilplant.bench.electrical_sections import wiring
from hilplant.bench.load_files import PolynomialFile, TorqueFile
from hilplant.bench.motor_model import build_motor_model, row_of_networks
from hilplant.bench.parts import MotorFile
from hilplant.bench.plant_description import (
    AnyLoad,
    BladeEntry,
    BladesSection,
    ParkSwitchSection,
    PlainLoad,
    PlantSection,
    PolynomialLoad,
    WholeWiper,
)
from hilplant.bench.screen_parts import ScreenFile
from hilplant.bench.trained_load import Around, TrainedLoad, check_bounds, trained_load
from hilplant.bench.wiper import SIDES, Mechanics, Surroundings, build_mechanics
from hilplant.checked_yaml.spot import Spot
from hilplant.failure import Failure
from hilplant.mechanics.coefficients import Aerodynamics, check_aerodynamics
from hilplant.models.circuit import CIRCUITS
from hilplant.models.load import LOADS
from hilplant.models.mechanical_records import LinkageCondition, Obstacles
from hilplant.models.records import Blade, Friction, Load, Parameters, ParkSwitch, Relays, Sensors
from hilplant.models.slow_records import Heat, Water, Wear
from hilplant.models.training import load_mark, motor_mark
from hilplant.units import MILLISECOND_NS, RAD_PER_DEG, SECOND_NS

Blades = tuple[BladeEntry, BladeEntry]


@dataclass(frozen=True, slots=True)
class Plant:
    """Parameters and tables of one plant, the descriptions they come from, and the mechanics behind the tables."""

    parameters: Parameters
    tables: Floats
    motor: MotorFile
    load: AnyLoad
    screen: ScreenFile | None
    blades: Blades | None
    mechanics: Mechanics
    park_switch: ParkSwitchSection
    section: PlantSection
    load_file: TorqueFile | PolynomialFile | None = None


def build_plant(spot: Spot, plant: PlantSection, step_ns: int) -> Plant | None:
    """Build the plant; what is wrong is noted, and the other parts are checked all the same."""
    motor, load, park_switch, blades = plant.motor, plant.load, plant.park_switch, _blades(spot, plant.blades)
    complete = not isinstance(load, WholeWiper) or _has_screen_and_blades(spot, plant)
    around = _surroundings(load, plant.screen, blades)
    mechanics = build_mechanics(spot, plant.linkage, around) if plant.linkage is not None else None
    if motor is None or mechanics is None or load is None or park_switch is None or not complete:
        return None
    trained = trained_load(spot.inner("load"), load, Around(mechanics, plant.screen, blades))
    mover = build_motor_model(spot.inner("motor_model"), plant.motor_model, motor, step_ns)
    if trained is None:
        return None
    record = _load_record(load, trained, plant.screen, blades)
    parameters = Parameters(
        step_s=step_ns / SECOND_NS,
        motor=motor.record(),
        park_switch=_contact(park_switch, step_ns),
        load=record,
        left_arm=mechanics.wiper.left.arm,
        right_arm=mechanics.wiper.right.arm,
        motor_model=mover.place,
        wiring=wiring(plant.supply, plant.wires),
        relays=plant.relays.record(step_ns) if plant.relays is not None else Relays(),
        sensors=plant.current_sensor.record() if plant.current_sensor is not None else Sensors(),
        heat=plant.heat.record() if plant.heat is not None else Heat(),
        obstacles=plant.obstacles.record() if plant.obstacles is not None else Obstacles(),
        linkage=plant.backlash.record() if plant.backlash is not None else LinkageCondition(),
        wear=plant.wear.record() if plant.wear is not None else Wear(),
        water=_water(plant),
        trained_load=load_mark(record),
        trained_motor=motor_mark(motor.record()),
        networks=row_of_networks(trained.numbers, mover.numbers),
    )
    check_bounds(spot.inner("load"), trained, parameters, mechanics.table)
    return Plant(
        parameters, mechanics.table, motor, load, plant.screen, blades, mechanics, park_switch, plant, trained.file
    )


def _water(plant: PlantSection) -> Water:
    lean_rad = plant.screen.from_vertical_rad if plant.screen is not None else 0.0
    return plant.water.record(lean_rad) if plant.water is not None else Water()


def _blades(spot: Spot, section: BladesSection | None) -> Blades | None:
    if section is None or section.left is None or section.right is None:
        return None
    sound = [_has_sound_air(spot.inner("blades", side), getattr(section, side)) for side in SIDES]
    return (section.left, section.right) if all(sound) else None


def _has_sound_air(spot: Spot, entry: BladeEntry) -> bool:
    parts = {
        "area_m2": Aerodynamics(entry.area_m2),
        "drag": Aerodynamics(drag=entry.drag),
        "lift": Aerodynamics(lift=entry.lift),
    }
    sound = True
    for key, air in parts.items():
        try:
            check_aerodynamics(f"{spot.name} blade", air)
        except Failure as error:
            spot.note(key, text=str(error))
            sound = False
    return sound


def _air(entry: BladeEntry) -> Aerodynamics:
    return Aerodynamics(entry.area_m2, entry.drag, entry.lift)


def _has_screen_and_blades(spot: Spot, plant: PlantSection) -> bool:
    missing = [key for key in ("screen", "blades") if getattr(plant, key) is None]
    for key in missing:
        written = key in plant.model_fields_set
        spot.miss(key if written else "load", text=f"the {plant.load.model} load needs {key} beside it")
    return not missing


def _surroundings(load: AnyLoad | None, screen: ScreenFile | None, blades: Blades | None) -> Surroundings:
    """Return what is known; what is missing has been noted, and the linkage is checked all the same."""
    left, right = (_air(entry) for entry in blades) if blades is not None else (Aerodynamics(), Aerodynamics())
    return Surroundings(
        screen_angle_rad=screen.from_vertical_rad if screen is not None else 0.0,
        air=(left, right),
        points=load.points if isinstance(load, WholeWiper) else 1,
        needs_masses=isinstance(load, WholeWiper),
    )


def _load_record(load: AnyLoad, trained: TrainedLoad, screen: ScreenFile | None, blades: Blades | None) -> Load:
    constants = trained.file if isinstance(trained.file, PolynomialFile) else load
    left, right = (Blade(entry.force_n, entry.wear) for entry in blades) if blades is not None else (Blade(), Blade())
    return Load(
        model=float(LOADS.index(load.model)),
        c1=constants.c1 or 0.0 if isinstance(constants, PolynomialFile | PolynomialLoad | PlainLoad) else 0.0,
        c2=constants.c2 or 0.0 if isinstance(constants, PolynomialFile | PolynomialLoad | PlainLoad) else 0.0,
        points=float(load.points) if isinstance(load, WholeWiper) else 1.0,
        friction=screen.friction() if screen is not None else Friction(),
        left_blade=left,
        right_blade=right,
    )


def _contact(section: ParkSwitchSection, step_ns: int) -> ParkSwitch:
    return ParkSwitch(
        angle_rad=section.park_angle_deg * RAD_PER_DEG,
        half_window_rad=0.5 * section.window_deg * RAD_PER_DEG,
        hysteresis_rad=section.hysteresis_deg * RAD_PER_DEG,
        bounce_ticks=float(round(section.bounce_ms * MILLISECOND_NS / step_ns)),
        circuit=float(CIRCUITS.index(section.circuit)),
        reverse_angle_rad=(section.reverse_angle_deg or 0.0) * RAD_PER_DEG,
    )
