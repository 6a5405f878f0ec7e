"""The faults of linkage, arms and blades, and what stands in their way."""

import math

from hilplant.faults.fault import Change, FaultDefinition, Quantity

_ANGLE = Quantity("angle_deg", -360.0, 360.0, "arm angle at which it begins, as `left_arm_rad` shows it [deg]")
_STIFFNESS = Quantity("stiffness_n_m_rad", 0.0, 1e4, "torque at the arm by arm angle [N m/rad]", 100.0)
_SIDES = ("left", "right")
#: Which way an arm pushes against something, and the elements that say where it begins and how stiff it is.
_WAYS = {"above": ("high_rad", "high_n_m_rad"), "below": ("low_rad", "low_n_m_rad")}


def _plain(element: str, quantity: str) -> Change:
    return Change(element, "add", lambda values, step_s: values[quantity])


def _set(element: str, quantity: str, factor: float = 1.0) -> Change:
    return Change(element, "set", lambda values, step_s: factor * values[quantity])


def _at_end(side: str, way: str) -> list[FaultDefinition]:
    begin, stiffness = (f"obstacles.{side}.{element}" for element in _WAYS[way])
    here = (_set(begin, "angle_deg", math.radians(1.0)), _plain(stiffness, "stiffness_n_m_rad"))
    springy = Change(f"obstacles.{side}.rebound", "set", lambda values, step_s: 1.0)
    beyond = f"k (p - p0) at the arm {way} p0"
    return [
        FaultDefinition(f"{side}_snow_{way}", "mechanical", f"snow in the {side} arm's way {way} an angle",
              f"{beyond} on the way there, nothing on the way back", here, (_ANGLE, _STIFFNESS)),
        FaultDefinition(f"{side}_stop_{way}", "mechanical", f"the {side} arm meets a stop {way} an angle",
              f"{beyond}, which pushes back as a spring", (*here, springy), (_ANGLE, _STIFFNESS)),
    ]  # fmt: skip


def _at_side(side: str) -> list[FaultDefinition]:
    obstacle = f"obstacles.{side}"
    return [
        FaultDefinition(f"{side}_blade_worn", "mechanical", f"{side} blade hardened or worn",
              "friction coefficient times the factor",
              (Change(f"load.{side}_blade.wear", "scale", lambda values, step_s: values["factor"]),),
              (Quantity("factor", 0.0, 10.0, "on the coefficient of friction"),)),
        FaultDefinition(f"{side}_blade_off", "mechanical", f"{side} blade lifted off the screen, or its rubber lost",
              "no force on the screen; the masses stay",
              (Change(f"load.{side}_blade.force_n", "scale", lambda values, step_s: 0.0),)),
        FaultDefinition(f"{side}_blade_frozen", "mechanical", f"{side} blade frozen to the screen",
              "holds with the torque at the arm until the arm has turned by slip_deg in all; then it is free",
              (_plain(f"{obstacle}.frozen_n_m", "torque_n_m"),
               _set("obstacles.slip_rad", "slip_deg", math.radians(1.0))),
              (Quantity("torque_n_m", 0.0, 1000.0, "torque at the arm with which the ice holds [N m]"),
               Quantity("slip_deg", 0.01, 90.0, "how far the arm turns until the blade is free [deg]", 2.0))),
        FaultDefinition(f"{side}_arm_lost", "mechanical", f"{side} arm lost with its blade",
              "inertia, weight, drag and friction of arm and blade gone; the arm's angle shown is the rocker's",
              (Change(f"linkage.{side}", "set", lambda values, step_s: 1.0),)),
        FaultDefinition(f"{side}_link_broken", "mechanical", f"link to the {side} rocker broken",
              "as the arm lost; the arm is shown where it was, and on its rocker again once it is whole",
              (Change(f"linkage.{side}", "set", lambda values, step_s: 2.0),)),
        *(fault for way in _WAYS for fault in _at_end(side, way)),
    ]  # fmt: skip


#: Every mechanical fault.
MECHANICAL_FAULTS: tuple[FaultDefinition, ...] = (
    *(fault for side in _SIDES for fault in _at_side(side)),
    FaultDefinition("backlash", "mechanical", "play between crank and linkage",
          "the linkage moves by itself between the two flanks; where they meet both have one speed, without rebound",
          (Change("linkage.backlash_rad", "add", lambda values, step_s: math.radians(values["angle_deg"])),),
          (Quantity("angle_deg", 0.0, 30.0, "play as angle of the crank [deg]"),)),
    FaultDefinition("jam", "mechanical", "something is jammed in linkage or gear at a crank angle",
          "a dry friction torque at the crank, in both directions, within width_deg about angle_deg",
          (_set("obstacles.jam_rad", "angle_deg", math.radians(1.0)),
           _set("obstacles.jam_half_rad", "width_deg", math.radians(0.5)),
           _plain("obstacles.jam_n_m", "torque_n_m")),
          (Quantity("angle_deg", 0.0, 360.0, "crank angle from park [deg]"),
           Quantity("width_deg", 0.1, 360.0, "how wide it is [deg]", 10.0),
           Quantity("torque_n_m", 0.0, 1000.0, "torque at the crank; a large one blocks it [N m]", 1000.0))),
)  # fmt: skip
