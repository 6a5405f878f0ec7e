"""Torques at many angles and speeds at once, by the physical load and by its network: for training and for checks."""

from typing import Any, NamedTuple

from hilplant.jit import compiled
from hilplant.models.lookup import derivative, find, value
from hilplant.models.records import Load
from hilplant.models.reduced import reduced
from hilplant.models.resistance import Crank
from hilplant.models.row import changed
from hilplant.models.torque_network import network_tangent
from hilplant.signals import Inputs

#: Neither wind nor brake, blades and arms as they are.
UNDISTURBED = Inputs()


class Wetness(NamedTuple):
    """The only input that matters here."""

    screen: float


@compiled
def physical_torques(tables: Any, load: Load, wetness: float, states: Any, torques: Any) -> None:
    """Fill `torques` [N m] with those of the reduced load at even speed in still air.

    `states` is an array [m, 2] of crank angles in [0, 2 pi) and positive speeds [rad/s].
    """
    inputs = changed(UNDISTURBED, Wetness(wetness))
    for row in range(states.shape[0]):
        angle, speed = states[row, 0], states[row, 1]
        found = reduced(Crank(tables, find(tables, angle), angle, speed), load, inputs)
        torques[row] = found.bias + found.dry + found.slope * speed


@compiled
def network_torques(networks: Any, wet: bool, states: Any, torques: Any) -> None:
    """Fill `torques` [N m] with those of the network."""
    for row in range(states.shape[0]):
        torques[row] = network_tangent(networks, states[row, 0], states[row, 1], wet).torque_n_m


@compiled
def look_ups(tables: Any, crank_rad: Any, read: Any) -> None:
    """Fill `read` [m, channels, 2] with the values and derivatives of all channels at crank angles in [0, 2 pi)."""
    for row in range(crank_rad.shape[0]):
        place = find(tables, crank_rad[row])
        for column in range(tables.shape[1]):
            read[row, column, 0] = value(tables, place, column)
            read[row, column, 1] = derivative(tables, place, column)


@compiled
def network_tangents(networks: Any, wet: bool, states: Any, tangents: Any) -> None:
    """Fill `tangents` [m, 3] with the network's torque [N m] and its derivatives by angle and speed."""
    for row in range(states.shape[0]):
        at = network_tangent(networks, states[row, 0], states[row, 1], wet)
        tangents[row, 0], tangents[row, 1], tangents[row, 2] = at.torque_n_m, at.by_angle, at.by_speed
