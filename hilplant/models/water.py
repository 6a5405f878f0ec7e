"""Water on the screen: a film that rain and washer feed, that wipes, runoff and evaporation thin, and its rain sensor.

The film's mean thickness h follows

    dh/dt = q - (d + w |da/dt|/pi) h,    q = rain (sin g + V cos g/U) + washer - evaporation,

rain [mm/s] on the ground, g the screen's lean from the vertical, V the vehicle's speed, U the speed of falling drops:
a leaning screen catches sin g of what falls and cos g of what the vehicle runs into. da/dt is the crank's speed; a
turn is two passes, each of which leaves exp(-w) of the film. Within a tick all but h is constant, and h exact; it is
never below 0. The screen is dry below one thickness, tacky at a second, wet above a third, in between in proportion.

The rain sensor shows 1 - exp(-h/s): light that the glass reflects inside is lost where water touches it.
"""

import math
from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.friction import TACKY
from hilplant.models.records import Parameters
from hilplant.models.row import changed
from hilplant.models.slow_records import Water, WaterState
from hilplant.signals import Inputs
from hilplant.units import TURN_RAD

SECONDS_PER_HOUR = 3600.0
#: Turn of the crank in which each blade passes once over the screen.
PASS_RAD = 0.5 * TURN_RAD


class WetScreen(NamedTuple):
    """The screen as wet as its film makes it."""

    screen: float


@compiled
def wetted(inputs: Inputs, parameters: Parameters, now: WaterState) -> Inputs:
    """Return the inputs with the screen at least as wet as its film makes it."""
    if parameters.water.altered < 0.5:
        return inputs
    return changed(inputs, WetScreen(max(inputs.screen, wetness(now.film_mm, parameters.water))))


@compiled
def wetness(film_mm: float, water: Water) -> float:
    """Return the wetness of a film: 0 dry, 0.5 tacky, 1 wet."""
    if film_mm <= water.dry_mm:
        return 0.0
    if film_mm <= water.tacky_mm:
        return TACKY * (film_mm - water.dry_mm) / (water.tacky_mm - water.dry_mm)
    return min(1.0, TACKY + (1.0 - TACKY) * (film_mm - water.tacky_mm) / (water.wet_mm - water.tacky_mm))


@compiled
def film_gain_mm_s(inputs: Inputs, water: Water) -> float:
    """Return what rain and washer bring, less what evaporates [mm/s]."""
    caught = inputs.rain_mm_h / SECONDS_PER_HOUR * (water.catch + water.catch_s_m * inputs.vehicle_speed_m_s)
    gain = caught - water.evaporation_mm_s
    return gain + water.washer_mm_s if inputs.washer_pump > 0.5 else gain


@compiled
def film_after(now: WaterState, gained_mm: float, thinned: float) -> WaterState:
    """Return the film a tick later, in which it gains `gained_mm` and loses the part 1 - exp(-`thinned`) of itself."""
    lost = -math.expm1(-thinned)
    share = lost / thinned if thinned > 0.0 else 1.0
    return WaterState(max(0.0, now.film_mm * (1.0 - lost) + gained_mm * share))


@compiled
def rain_signal(now: WaterState, water: Water) -> float:
    """Return what the rain sensor shows, 0 dry to 1; 0 where water is not modelled."""
    if water.altered < 0.5 or now.film_mm == 0.0:
        return 0.0
    return -math.expm1(-now.film_mm / water.sensor_mm)
