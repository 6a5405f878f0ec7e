"""Which models of the load there are, and which of them answers."""

from typing import Any

from hilplant.jit import compiled
from hilplant.models import tables as channel
from hilplant.models.linkage_faults import without_lost_sides
from hilplant.models.lookup import value
from hilplant.models.obstacles import obstructed
from hilplant.models.polynomial import torque_over_speed
from hilplant.models.records import Load, Parameters, State
from hilplant.models.reduced import reduced
from hilplant.models.resistance import Crank, Resistance
from hilplant.models.torque_network import NETWORK as BY_NETWORK
from hilplant.models.torque_network import NO_TANGENT, PHYSICAL, Tangent, active_load_model, network_tangent, reaches
from hilplant.signals import Inputs
from hilplant.units import TURN_RAD

#: Names of the models; ``Load.model`` is the index in this list. New ones go to the end: recordings hold the index.
LOADS = ("none", "polynomial", "reduced", "network")

NONE = LOADS.index("none")
POLYNOMIAL = LOADS.index("polynomial")
REDUCED = LOADS.index("reduced")
NETWORK = LOADS.index("network")

#: Models that need the tables of a whole wiper with its blades.
WHOLE_WIPER = (REDUCED, NETWORK)


@compiled
def without_inertia(parameters: Parameters) -> bool:
    """Return whether the load is a torque by the speed alone: then one evaluation, half-way, serves a whole step."""
    load = parameters.load
    smooth = load.model == NONE or load.model == POLYNOMIAL  # noqa: PLR1714
    return bool(smooth and parameters.obstacles.altered < 0.5)


@compiled
def resist(crank: Crank, parameters: Parameters, inputs: Inputs) -> Resistance:
    """Return the physical load where the crank is, for speeds near the one that it has.

    A model of one's own is a name in `LOADS` and a line here; it is taken in stretches, as anything that has inertia or
    friction must be.
    """
    load = parameters.load
    if load.model == REDUCED or load.model == NETWORK:  # noqa: PLR1714
        whole = reduced(crank, load, inputs)
        if parameters.linkage.altered > 0.5:
            whole = without_lost_sides(whole, crank, parameters, inputs)
        return whole
    return by_speed(crank.angle_rad, crank.speed_rad_s, load, inputs, parameters.networks)


@compiled
def network_now(parameters: Parameters, inputs: Inputs, speed_rad_s: float, state: State) -> tuple[float, Tangent]:
    """Return which model gives the torque at the crank's speed in this tick, and the network's tangent if it does."""
    if parameters.load.model != NETWORK:
        return PHYSICAL, NO_TANGENT
    mode = active_load_model(parameters, speed_rad_s, inputs, state.load_mode)
    if mode != BY_NETWORK:
        return mode, NO_TANGENT
    return mode, network_tangent(parameters.networks, state.crank_angle_rad, speed_rad_s, inputs.screen == 1.0)


@compiled
def resist_as(mode: float, tangent: Tangent, crank: Crank, parameters: Parameters, inputs: Inputs) -> Resistance:
    """Return the load from the active model; the physical one also where the network's speeds do not reach.

    The network gives the torque at even speed at the tick's start, and its tangent what it becomes within the tick:
    that is 1e-4 N m from the network itself and half as dear. The table gives the inertia. The torque is all bias: the
    network is never active at standstill or in reverse, where it matters what of the torque is friction.
    """
    if mode == BY_NETWORK and reaches(parameters.networks, crank.speed_rad_s):
        on = crank.angle_rad - tangent.angle_rad
        on = on + TURN_RAD if on < -0.5 * TURN_RAD else on
        faster = crank.speed_rad_s - tangent.speed_rad_s
        torque = tangent.torque_n_m + tangent.by_angle * on + tangent.by_speed * faster
        return Resistance(value(crank.tables, crank.place, channel.INERTIA), torque, 0.0, 0.0)
    load = resist(crank, parameters, inputs)
    return obstructed(load, crank, parameters) if parameters.obstacles.altered > 0.5 else load


@compiled
def by_speed(crank_angle_rad: float, crank_speed_rad_s: float, load: Load, inputs: Inputs, networks: Any) -> Resistance:
    """Return the loads that have no tables: none, and the polynomial as torque over speed.

    The quotient cannot become negative (footnote 16 of Dooner 2016: the load must not drive the motor), so that the
    load takes energy out at every speed, also when the step holds the quotient and lets the speed change.
    """
    slope = 0.0
    if load.model == POLYNOMIAL:
        slope = max(0.0, torque_over_speed(crank_angle_rad, crank_speed_rad_s, load, networks))
    return Resistance(0.0, 0.0, inputs.brake_torque_n_m, slope)
