"""The torque of the whole wiper as a network, section 6.4.2 of Dooner (2016), and the guard that knows its limits.

Crank angle and speed go in; the torque at the crank that a turn at this speed needs comes out, on a dry and on a wet
screen. One layer of tanh neurons, linear outputs. The angle enters as such, as in the thesis, or as sines and cosines
of it and of its double, which makes the torque come back after a turn.

All numbers stand in the row of networks: how many there are, then `HEAD` of them about the network as a whole, then
`NEURON` for each neuron: its weights of angle, sine, cosine, sine and cosine of the double angle and speed, its bias,
its weights in the dry and in the wet torque. Scaling is contained in the weights: they take and give SI units.
"""

import math
from typing import Any, NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import Parameters
from hilplant.models.training import load_altered
from hilplant.signals import Inputs

#: Places of the head: neurons, lowest and highest speed of the crank in the training [rad/s], what must be left of
#: this range at both ends before the network is trusted again [rad/s], what the dry and the wet torque begin with.
NEURONS, LOWEST, HIGHEST, MARGIN, DRY, WET = 1, 2, 3, 4, 5, 6
FIRST, NEURON = 7, 9

#: Who gives the torque, as ``signals.ACTIVE_MODELS``: the physical load of a bench without network; the network; the
#: physical load because the crank is slower than the training; the same because something else is not in it.
PHYSICAL, NETWORK, STANDSTILL, OUTSIDE = 0.0, 1.0, 2.0, 3.0


class Tangent(NamedTuple):
    """The torque at one angle and speed [N m], and its derivatives by both."""

    angle_rad: float
    speed_rad_s: float
    torque_n_m: float
    by_angle: float
    by_speed: float


#: Of a plant whose network is not active.
NO_TANGENT = Tangent(0.0, 0.0, 0.0, 0.0, 0.0)


@compiled
def network_tangent(networks: Any, crank_angle_rad: float, crank_speed_rad_s: float, wet: bool) -> Tangent:
    """Return the torque at the crank at even speed, positive when it opposes positive speed, and how it goes on.

    tanh c is written as 1 - 2/(1 + exp(2c)), whose error is that of rounding at 1; the sum of the ones and the factors
    2 are contained in the numbers.
    """
    sine, cosine = math.sin(crank_angle_rad), math.cos(crank_angle_rad)
    sine_2, cosine_2 = 2.0 * sine * cosine, 1.0 - 2.0 * sine * sine
    torque = networks[WET] if wet else networks[DRY]
    by_angle, by_speed = 0.0, 0.0
    column = 8 if wet else 7
    at = FIRST
    for _ in range(int(networks[NEURONS])):
        bent = networks[at] * crank_angle_rad + networks[at + 5] * crank_speed_rad_s + networks[at + 6]
        bent += networks[at + 1] * sine + networks[at + 2] * cosine
        bent += networks[at + 3] * sine_2 + networks[at + 4] * cosine_2
        turned = networks[at] + networks[at + 1] * cosine - networks[at + 2] * sine
        turned += 2.0 * (networks[at + 3] * cosine_2 - networks[at + 4] * sine_2)
        share = 1.0 / (1.0 + math.exp(bent))
        part = networks[at + column] * share
        slope = part * (share - 1.0)
        torque += part
        by_angle += slope * turned
        by_speed += slope * networks[at + 5]
        at += NEURON
    return Tangent(crank_angle_rad, crank_speed_rad_s, torque, by_angle, by_speed)


@compiled
def active_load_model(parameters: Parameters, crank_speed_rad_s: float, inputs: Inputs, before: float) -> float:
    """Return who gives the torque in this tick; `before` is who did in the last one.

    The training knows forward speeds within its range, a dry or a wet screen under both blades, and no brake, wind,
    wear or change of the arms' forces, nothing in the way of the arms, none lost, and no other friction or blades.
    Between dry and wet the physical load passes through the tacky screen, which the network does not know.
    """
    networks = parameters.networks
    if networks.shape[0] == 0 or networks[0] == 0.0:
        return PHYSICAL
    margin = 0.0 if before == NETWORK else networks[MARGIN]
    if load_altered(parameters) or not trained(inputs):
        return OUTSIDE
    if not crank_speed_rad_s >= networks[LOWEST] + margin:
        return STANDSTILL
    return NETWORK if crank_speed_rad_s <= networks[HIGHEST] - margin else OUTSIDE


@compiled
def reaches(networks: Any, crank_speed_rad_s: float) -> bool:
    """Return whether a speed lies within the training."""
    return bool(networks[LOWEST] <= crank_speed_rad_s <= networks[HIGHEST])


@compiled
def trained(inputs: Inputs) -> bool:
    """Return whether what surrounds the wiper is part of the training."""
    screen, left, right = inputs.screen, inputs.left_screen, inputs.right_screen
    known = (screen in (0.0, 1.0)) and (left < 0.0 or left == screen) and (right < 0.0 or right == screen)
    calm = inputs.brake_torque_n_m == 0.0 and inputs.vehicle_speed_m_s == 0.0
    new = inputs.left_wear == 1.0 and inputs.right_wear == 1.0
    return known and calm and new and inputs.left_force == 1.0 and inputs.right_force == 1.0
