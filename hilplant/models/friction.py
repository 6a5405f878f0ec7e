"""Coefficient of friction between a blade and a dry, tacky or wet screen, section 4.4 of Dooner (2016).

Velocities are in mm/s: only then do (4.49) and (4.50) level off where the text says (20 mm/s dry, 100 mm/s wet).
Every curve comes with its derivative, which costs nothing more: that of tanh is 1 - tanh^2.
"""

import math

from hilplant.jit import compiled
from hilplant.models.records import Friction

#: Argument from which tanh is 1 to the last bit.
SATURATED = 20.0

#: Wetness of a tacky screen; a dry one has 0, a wet one 1.
TACKY = 0.5


@compiled
def bend(rate: float, velocity: float) -> tuple[float, float]:
    """Return tanh(rate x velocity) and its derivative by the velocity; `rate` and `velocity` are not negative.

    Written with exp, which costs a third of tanh. The error is that of rounding at 1, also where tanh is small.
    """
    x = rate * velocity
    if x > SATURATED:
        return 1.0, 0.0
    e = math.exp(-2.0 * x)
    t = (1.0 - e) / (1.0 + e)
    return t, rate * (1.0 - t * t)


@compiled
def dry(velocity_mm_s: float, curve: Friction) -> tuple[float, float]:
    """Return the coefficient of (4.49) and its derivative by the velocity [s/mm]."""
    knee, knee_slope = bend(curve.dry_2, velocity_mm_s)
    step, step_slope = bend(curve.dry_4, velocity_mm_s)
    return curve.dry_1 * knee + curve.dry_3 * step, curve.dry_1 * knee_slope + curve.dry_3 * step_slope


@compiled
def tacky(velocity_mm_s: float, curve: Friction) -> tuple[float, float]:
    """Return the coefficient on a screen with little water left, and its derivative by the velocity [s/mm].

    The thesis names this state and leaves it out. The form is that of the Stribeck term in (4.50),

        mu = tacky_1 tanh(tacky_2 v) + tacky_3 [tanh(tacky_2 v) - tanh(tacky_4 v)]:

    it rises with rate `tacky_2` to about tacky_1 + tacky_3 and falls with the slower rate `tacky_4` to `tacky_1`.
    """
    rise, rise_slope = bend(curve.tacky_2, velocity_mm_s)
    fall, fall_slope = bend(curve.tacky_4, velocity_mm_s)
    both = curve.tacky_1 + curve.tacky_3
    return both * rise - curve.tacky_3 * fall, both * rise_slope - curve.tacky_3 * fall_slope


@compiled
def wet(velocity_mm_s: float, force_n: float, curve: Friction) -> tuple[float, float]:
    """Return the coefficient of (4.50) as printed and its derivative by the velocity [s/mm]; never below 0.

    Far outside its data (4.50) falls below 0, which would be a source of energy; there both are 0.
    """
    rise, rise_slope = bend(curve.wet_2, velocity_mm_s)
    fall, fall_slope = bend(curve.wet_3, velocity_mm_s)
    step, step_slope = bend(curve.wet_5, velocity_mm_s)
    by_force = curve.wet_7 * force_n + curve.wet_4
    shape = curve.wet_1 * (rise - fall) + curve.wet_4 * step - curve.wet_6 * velocity_mm_s
    slope = curve.wet_1 * (rise_slope - fall_slope) + curve.wet_4 * step_slope - curve.wet_6
    if by_force <= 0.0 or shape <= 0.0:  # two negative factors would rub again
        return 0.0, 0.0
    return by_force * shape, by_force * slope


@compiled
def coefficient(velocity_mm_s: float, wetness: float, force_n: float, curve: Friction) -> tuple[float, float]:
    """Return the coefficient of friction and its derivative by the velocity [s/mm].

    Parameters
    ----------
    velocity_mm_s
        Not negative. Beyond `velocity_limit_mm_s` the coefficient keeps its value there.
    wetness
        0 dry, 0.5 tacky, 1 wet; in between the coefficients of the two neighbours are mixed in proportion.
    force_n
        With which the whole blade is pressed on the screen.

    """
    moving = min(velocity_mm_s, curve.velocity_limit_mm_s)
    water = min(1.0, max(0.0, wetness))
    share = 1.0 - abs(water - TACKY) / TACKY  # of the tacky curve
    mu, slope = 0.0, 0.0
    if share > 0.0:
        mu, slope = tacky(moving, curve)
        mu, slope = share * mu, share * slope
    if share < 1.0:
        other = wet(moving, force_n, curve) if water > TACKY else dry(moving, curve)
        mu, slope = mu + (1.0 - share) * other[0], slope + (1.0 - share) * other[1]
    if velocity_mm_s > curve.velocity_limit_mm_s:
        slope = 0.0
    return mu, slope
