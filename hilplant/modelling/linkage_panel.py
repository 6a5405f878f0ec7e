"""What the linkage's panel shows: the wiper drawn over a turn, lengths and inertias, and the motion in time."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.bench.summary import summarise
from hilplant.mechanics.inverse_dynamics import CrankMotion, inverse_dynamics
from hilplant.mechanics.motion import Motion, motion
from hilplant.mechanics.planar import Body, Pin, Revolute
from hilplant.mechanics.solved_motion import SolvedMotion, solve_motion
from hilplant.mechanics.transmission import closest_places
from hilplant.mechanics.wiper import Wiper
from hilplant.modelling.linkage_rules import LinkageRule, linkage_rules
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Crank angles of a turn that are drawn, even steps from park.
FRAMES = 180


@dataclass(frozen=True, slots=True)
class DrawnBody:
    """A body as it is drawn: its points in its own coordinates [m], in the order of its line."""

    name: str
    part: str
    points: list[tuple[str, float, float]]


@dataclass(frozen=True, slots=True)
class WiperDrawing:
    """Bodies, and their coordinates x, y, angle at each crank angle [frames, bodies, 3]; the fixed pivots."""

    bodies: list[DrawnBody]
    crank_rad: Floats
    coordinates: Floats
    pivots: dict[str, tuple[float, float]]


def wiper_drawing(bench: Bench, frames: int = FRAMES) -> WiperDrawing:
    """Return the wiper of a bench as it is drawn over a turn."""
    wiper, linkage = bench.plant.mechanics.wiper, bench.plant.mechanics.linkage
    moving = motion(wiper, np.linspace(0.0, TURN_RAD, frames, endpoint=False))
    drawn = [_drawn(bench, body) for body in wiper.bodies if body.name != "ground"]
    places = [wiper.mechanism.bodies[body.name] for body in drawn]
    stacked = moving.coordinates.reshape(len(moving.crank_rad), -1, 3)[:, places]
    pivots = {name: linkage.points[name] for name in linkage.body_points["ground"]}
    return WiperDrawing(drawn, moving.crank_rad, stacked, pivots)


def _drawn(bench: Bench, body: Body) -> DrawnBody:
    wiper, linkage = bench.plant.mechanics.wiper, bench.plant.mechanics.linkage
    ends = [("", *body.first_end[1]), ("", *body.second_end[1])]
    if body.name not in linkage.body_points:
        return DrawnBody(body.name, "blade" if "_blade_" in body.name else "arm", ends)
    names = linkage.body_points[body.name]
    inner = [(name, *_joint_of(wiper, linkage.points[name], body)) for name in names]
    return DrawnBody(body.name, "crank" if body.name == linkage.crank else "link", inner)


def _joint_of(wiper: Wiper, point: tuple[float, float], body: Body) -> tuple[float, float]:
    """Return a design point in a body's own coordinates, as its joint has it: rounded points do not meet exactly."""
    wanted = body.local(point)
    pins: list[Pin] = [
        pin for joint in wiper.joints if isinstance(joint, Revolute) for pin in (joint.first, joint.second)
    ]
    own = [pin[1] for pin in pins if pin[0] == body.name]
    near = min(own, key=lambda place: abs(complex(*place) - complex(*wanted)), default=wanted)
    return near if abs(complex(*near) - complex(*wanted)) < 1e-3 else wanted


def body_table(bench: Bench) -> list[dict[str, Any]]:
    """Return length, mass and inertia of every moving body, (4.43)."""
    wiper = bench.plant.mechanics.wiper
    rows = zip(wiper.bodies, wiper.masses_kg, wiper.inertias_kg_m2, strict=True)
    return [
        {"body": body.name, "length_m": body.length_m, "mass_kg": float(mass), "inertia_kg_m2": float(inertia)}
        for body, mass, inertia in rows
        if body.name != "ground"
    ]


def readings(bench: Bench) -> dict[str, Any]:
    """Return sweeps, transmission angles, clearance and moving mass of a wiper."""
    made = summarise(bench)
    places = closest_places(bench.plant.mechanics.linkage)
    return {
        "left_sweep_deg": made.left_sweep_deg,
        "right_sweep_deg": made.right_sweep_deg,
        "blade_clearance_m": made.blade_clearance_m,
        "moving_mass_kg": made.moving_mass_kg,
        "dead_points": [
            {"where": place.where, "crank_deg": place.crank_angle_rad / RAD_PER_DEG,
             "transmission_deg": place.transmission_angle_rad / RAD_PER_DEG}
            for place in places
        ],
        "least_transmission_deg": bench.plant.mechanics.written.least_transmission_deg,
    }  # fmt: skip


def rules_of(values: dict[str, Any]) -> list[LinkageRule]:
    """Return the rules of the linkage among a model's values, whatever else is wrong with it."""
    linkage = values.get("plant", {}).get("linkage") or {}
    return linkage_rules(linkage.get("kind", ""), linkage.get("points_m") or {})


def solve(
    bench: Bench, crank_speed_rad_s: float, seconds: float, step_s: float
) -> tuple[SolvedMotion, dict[str, Floats]]:
    """Return every body's motion over time at an even crank speed, and the force in each joint [N], without friction.

    Raises
    ------
    Failure
        For a duration or a step that cannot be.

    """
    wiper = bench.plant.mechanics.wiper
    solved = solve_motion(wiper, crank_speed_rad_s, seconds, step_s)
    moving: Motion = motion(wiper, solved.crank_rad)
    loads = inverse_dynamics(wiper, moving, CrankMotion(crank_speed_rad_s, 0.0))
    forces = {f"{joint.first} - {joint.second}": np.linalg.norm(joint.force_n, axis=1) for joint in loads.joints}
    return solved, forces | {"crank torque": loads.crank_torque_n_m}
