"""What can be built and is yet doubtful: numbers that no wiper has, and settings that take a protection away."""

import math
import re
from collections.abc import Iterable

from hilplant.bench.description import BenchDescription
from hilplant.bench.mapping import MappedMessage
from hilplant.bench.parts import MotorFile
from hilplant.bench.plant import Plant
from hilplant.bench.screen_parts import ScreenFile
from hilplant.bench.wiper import SIDES
from hilplant.checked_yaml.spot import Spot
from hilplant.units import RAD_PER_DEG

#: Beyond these nobody has built a wiper: mass of all that moves [kg], force of an arm [N], motor constant [V s],
#: resistance [ohm], and below this a step is nothing but slow [s].
MOST_MASS_KG = 100.0
MOST_FORCE_N = 200.0
MOST_CONSTANT_V_S = 5.0
MOST_RESISTANCE_OHM = 100.0
LEAST_STEP_S = 1e-5
#: Below this lean [rad] an angle looks like one from the horizontal.
LEAST_LEAN_RAD = math.pi / 4.0

_RELAYS = ("relay_on", "relay_fast")


def note_doubts(spot: Spot, description: BenchDescription, plant: Plant) -> None:
    """Note as warnings what is doubtful about a bench that can be built."""
    if description.step_s < LEAST_STEP_S:
        spot.warn("step_s", text=f"step_s {description.step_s:g} is so short that no loop keeps it; 0.001 is usual")
    _doubt_motor(spot.inner("plant", "motor"), plant.motor)
    _doubt_wiper(spot.inner("plant"), plant)
    _doubt_screen(spot.inner("plant", "screen"), plant.screen)
    _doubt_safety(spot.inner("bus"), description)


def _doubt_motor(spot: Spot, motor: MotorFile) -> None:
    for name in ("slow", "fast"):
        brush = getattr(motor, name)
        for key, most in (("resistance_ohm", MOST_RESISTANCE_OHM), ("constant_v_s", MOST_CONSTANT_V_S)):
            if getattr(brush, key) > most:
                text = f"{key} is {getattr(brush, key):g}, and no wiper motor's is above {most:g}; which unit is it in?"
                spot.warn(name, key, text=text)
    for key, symbol in (("constant_v_s", "K"), ("inductance_henry", "L")):
        slow, fast = getattr(motor.slow, key), getattr(motor.fast, key)
        if fast > slow:
            text = f"{key} of the fast brush, {fast:g}, is above the slow one's, {slow:g}"
            text += f": fewer turns give less {symbol}, (3.32)"
            spot.warn("fast", key, text=text)


def _doubt_wiper(spot: Spot, plant: Plant) -> None:
    mass_kg = float(plant.mechanics.wiper.masses_kg.sum())
    if mass_kg > MOST_MASS_KG:
        spot.warn(
            "linkage", "masses_kg", text=f"{mass_kg:g} kg move, and no wiper weighs more than {MOST_MASS_KG:g} kg"
        )
    for side, blade in zip(SIDES, plant.blades or (), strict=False):
        if blade.force_n > MOST_FORCE_N:
            text = f"force_n is {blade.force_n:g}, and no arm presses with more than {MOST_FORCE_N:g} N"
            spot.warn("blades", side, "force_n", text=text)
    if plant.mechanics.clearance_m == 0.0:
        spot.warn("linkage", "points_m", text="the blades cross on the screen")


def _doubt_screen(spot: Spot, screen: ScreenFile | None) -> None:
    """Warn of an angle that may have been told from the horizontal, unless it is said from which axis it is."""
    if screen is None or "angle_from" in screen.model_fields_set or abs(screen.angle_rad) >= LEAST_LEAN_RAD:
        return
    degrees = abs(screen.angle_rad) / RAD_PER_DEG
    text = f"angle_rad is from the vertical, and the screen of a car leans 50 to 70 deg back, not {degrees:.3g}; "
    text += "if this is the rake from the horizontal, write 'angle_from: horizontal', else 'angle_from: vertical'"
    spot.warn("angle_rad", text=text)


def _doubt_safety(spot: Spot, description: BenchDescription) -> None:
    if description.bus.safe.get("relay_on") is True:
        spot.warn("safe", "relay_on", text="relay_on: true keeps the motor running while commands are lost")
    for name, written in description.bus.receive.items():
        relays = sorted({name for name, _ in written.targets()} & {*_RELAYS})
        if written.timeout_ms == 0 and relays:
            text = f"{name} commands {' and '.join(relays)} and may stay away for ever; give it a timeout_ms above 0"
            spot.warn("receive", name, "timeout_ms", text=text)


def offer_protection(spot: Spot, commands: Iterable[MappedMessage], reports: Iterable[MappedMessage]) -> None:
    """Note as warnings at the bus's spot which messages the database calls protected, and the bench does not."""
    for direction, messages in (("receive", commands), ("send", reports)):
        for mapped in messages:
            e2e = getattr(mapped.message.autosar, "e2e", None)
            if e2e is None or mapped.protection is not None:
                continue
            number = re.search(r"([0-9]+)[A-Z]*$", e2e.category or "")
            profile = f"profile: {int(number[1])}" if number else f"profile: ... ('{e2e.category}' in the file)"
            ids = e2e.data_ids or []
            data_id = f"data_id: {ids[0]}" if len(ids) == 1 else f"data_id_list: {ids}"
            text = f"the database protects it end to end: 'protection: {{{profile}, {data_id}}}' would do it too"
            spot.warn(direction, mapped.message.name, text=f"{mapped.message.name}: {text}")
