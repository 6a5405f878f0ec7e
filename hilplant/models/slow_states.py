"""All that changes slowly: what it makes of the parameters in a tick, and how it goes on to the next one."""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.armature import ArmatureMotion
from hilplant.models.heat import Brushes, heated, losses, warmed
from hilplant.models.linkage_faults import broken_at, without_lost_blades
from hilplant.models.lookup import find, within_turn
from hilplant.models.mechanical_records import IceState, LinkageState, Obstacles
from hilplant.models.obstacles import BothSides, Frozen, ice_after, with_ice_left
from hilplant.models.records import Blade, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.resistance import Crank
from hilplant.models.row import changed
from hilplant.models.shaft import Train
from hilplant.models.slow_records import HeatState, WaterState, WearState
from hilplant.models.water import PASS_RAD, film_after, film_gain_mm_s
from hilplant.models.wear import WornBlades, WornCam, worn_load, worn_motor, worn_switch
from hilplant.units import TURN_RAD


class Slowly(NamedTuple):
    """What of the parameters changes slowly."""

    motor: Motor
    park_switch: ParkSwitch
    load: Load
    obstacles: Obstacles


class Altered(NamedTuple):
    """The elements of these that change."""

    slow: Brush
    fast: Brush
    half_window_rad: float
    left_blade: Blade
    right_blade: Blade
    left_frozen_n_m: float
    right_frozen_n_m: float


class SlowStates(NamedTuple):
    """All slow states."""

    heat: HeatState
    ice: IceState
    linkage: LinkageState
    wear: WearState
    water: WaterState


class Reached(NamedTuple):
    """Where a tick has led: the motor's motion at both ends, and the angle of the linkage's crank then [rad]."""

    before: ArmatureMotion
    after: ArmatureMotion
    linkage_rad: float


@compiled
def nothing_slow(parameters: Parameters) -> bool:
    """Return whether no slow state is modelled."""
    altered = parameters.heat.altered + parameters.obstacles.altered + parameters.linkage.altered
    return altered + parameters.wear.altered + parameters.water.altered == 0.0


@compiled
def that_change(slowly: Slowly) -> Altered:
    """Return the elements that change."""
    motor, load, ice = slowly.motor, slowly.load, slowly.obstacles
    return Altered(
        slow=motor.slow,
        fast=motor.fast,
        half_window_rad=slowly.park_switch.half_window_rad,
        left_blade=load.left_blade,
        right_blade=load.right_blade,
        left_frozen_n_m=ice.left.frozen_n_m,
        right_frozen_n_m=ice.right.frozen_n_m,
    )


@compiled
def as_it_is(parameters: Parameters, state: State) -> Parameters:
    """Return the parameters as the slow states have made them.

    A branch chooses only the elements that may change: one between whole records copies all their elements.
    """
    motor, switch, load, ice = parameters.motor, parameters.park_switch, parameters.load, parameters.obstacles
    now = that_change(Slowly(motor, switch, load, ice))
    if not nothing_slow(parameters):
        now = slowly_altered(parameters, state)
    left, right = changed(ice.left, Frozen(now.left_frozen_n_m)), changed(ice.right, Frozen(now.right_frozen_n_m))
    slowly = Slowly(
        changed(motor, Brushes(now.slow, now.fast)),
        changed(switch, WornCam(now.half_window_rad)),
        changed(load, WornBlades(now.left_blade, now.right_blade)),
        changed(ice, BothSides(left, right)),
    )
    return changed(parameters, slowly)


@compiled
def slowly_altered(parameters: Parameters, state: State) -> Altered:
    """Return what may change as it is where something of it has been altered."""
    motor, load, obstacles = parameters.motor, parameters.load, parameters.obstacles
    switch = parameters.park_switch
    if parameters.wear.altered > 0.5:
        motor, load = worn_motor(motor, parameters.wear, state.wear), worn_load(load, parameters.wear, state.wear)
        switch = worn_switch(switch, parameters.wear, state.wear)
    if parameters.heat.altered > 0.5:
        motor = heated(motor, parameters.heat, state.heat)
    if parameters.linkage.altered > 0.5:
        load = without_lost_blades(load, parameters.linkage)
    if parameters.obstacles.altered > 0.5:
        obstacles = with_ice_left(obstacles, state.ice)
    return that_change(Slowly(motor, switch, load, obstacles))


@compiled
def slow_after(crank: Crank, reached: Reached, train: Train, state: State, told: Parameters) -> SlowStates:
    """Return the slow states a tick later; those that are not modelled stay as they are.

    `train` has the parameters as the slow states had made them in the tick, `told` as they are without that.
    """
    parameters, inputs = train.parameters, train.inputs
    heat, ice, linkage, wear, water = state.heat, IceState(0.0, 0.0), LinkageState(0.0, 0.0), state.wear, state.water
    if nothing_slow(parameters):
        return SlowStates(heat, ice, linkage, wear, water)
    turned_rad = abs(reached.after.turned - reached.before.turned) / parameters.motor.gear_ratio
    if parameters.heat.altered > 0.5:
        lost = losses(reached.before, reached.after, train.connection, parameters, inputs.ambient_temperature_c)
        heat = warmed(heat, lost, parameters.heat, parameters.step_s)
    if parameters.obstacles.altered > 0.5:
        angle = within_turn(reached.linkage_rad)
        there = Crank(crank.tables, find(crank.tables, angle), angle, crank.speed_rad_s)
        ice = ice_after(state.ice, told.obstacles, crank, there)
    if parameters.linkage.altered > 0.5:
        linkage = broken_at(crank, parameters.linkage, state.linkage)
    if parameters.wear.altered > 0.5:
        wear = WearState(wear.wipes + turned_rad / TURN_RAD)
    if parameters.water.altered > 0.5:
        gain = film_gain_mm_s(inputs, parameters.water)
        if water.film_mm > 0.0 or gain > 0.0:
            thinned = parameters.water.runoff_per_s * parameters.step_s + parameters.water.wiped * turned_rad / PASS_RAD
            water = film_after(water, gain * parameters.step_s, thinned)
    return SlowStates(heat, ice, linkage, wear, water)
