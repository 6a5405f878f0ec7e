"""Torque of a wiper without arms and blades as two polynomials, (6.1)-(6.3) of Dooner (2016)."""

import math
from typing import Any

from hilplant.jit import compiled
from hilplant.models.records import Load

#: Constants of (6.3) as identified in section 6.3.
C1 = 0.0035
C2 = 0.2738


@compiled
def forward_shape(x: float) -> float:
    """Return f(x) of (6.1), the shape of the forward wipe, x the sine of the crank angle."""
    return (((-0.19224 * x + 0.021769) * x - 0.15435) * x + 0.077812) * x + 0.68626


@compiled
def reverse_shape(x: float) -> float:
    """Return g(x) of (6.2), the shape of the reverse wipe."""
    high = ((0.4184 * x - 0.30315) * x - 0.42441) * x + 0.12634
    return (((high * x + 0.21484) * x - 0.10093) * x - 0.29859) * x + 0.63276


#: Numbers of both polynomials, from the constant upwards: five of the forward wipe, eight of the reverse wipe.
COEFFICIENTS = 13


@compiled
def fitted_shape(x: float, forward: bool, numbers: Any) -> float:
    """Return f(x) or g(x) of a linkage other than the published one; `numbers` are how many there are, then they."""
    first, last = (1, 5) if forward else (6, 13)
    shape = numbers[last]
    for index in range(last - 1, first - 1, -1):
        shape = shape * x + numbers[index]
    return float(shape)


@compiled
def torque_over_speed(crank_angle_rad: float, crank_speed_rad_s: float, load: Load, numbers: Any) -> float:
    """Return the torque of (6.3) at the crank divided by the crank's speed [N m s/rad].

    (6.3) has the speed v as a factor, so the quotient also exists at rest. It is taken as printed for both signs
    of v. Where the sine is 0, which (6.3) leaves open, the forward shape holds; there the torque jumps, from
    f(0) = 0.68626 to g(0) = 0.63276. `numbers` hold the polynomials of another linkage, or are empty.
    """
    x = math.sin(crank_angle_rad)
    if numbers.shape[0] > COEFFICIENTS and numbers[0] == COEFFICIENTS:
        shape = fitted_shape(x, x >= 0.0, numbers)
    else:
        shape = forward_shape(x) if x >= 0.0 else reverse_shape(x)
    return load.c2 * (shape + crank_speed_rad_s * load.c1)
