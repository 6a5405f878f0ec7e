"""What a sound bench amounts to, for those who wrote it: sweeps, masses, closeness to a dead point, assumptions."""

import math
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from hilplant.bench.assembly import Bench
from hilplant.bench.parts import assumed_in
from hilplant.bench.plant import Plant
from hilplant.bench.plant_description import NetworkLoad, WholeWiper
from hilplant.bench.wiper import SIDES
from hilplant.checked_yaml.checked import Checked
from hilplant.mechanics.design_points import projection_loss
from hilplant.models.circuit import CIRCUITS
from hilplant.models.motor_choice import NARX
from hilplant.models.tables import LEFT_ROCKER, RIGHT_ROCKER
from hilplant.units import RAD_PER_DEG, SECOND_NS

#: Losses below this are the rounding of the arithmetic [m].
NO_LOSS_M = 1e-12


@dataclass(frozen=True, slots=True)
class BenchSummary:
    """Figures of a bench; keys and units as `check --json` writes them.

    `transmission_angle_deg` is None for a linkage without any two bodies that settle each other.
    """

    left_sweep_deg: float
    right_sweep_deg: float
    transmission_angle_deg: float | None
    blade_clearance_m: float
    moving_mass_kg: float
    projection_loss_m: float
    sent_frames_per_s: float
    sent_bits_per_s: float
    assumed: list[str]


def summarise(bench: Bench) -> BenchSummary:
    """Return the figures of a bench."""
    mechanics = bench.plant.mechanics
    left, right = (np.ptp(mechanics.table[:, channel, 0]) / RAD_PER_DEG for channel in (LEFT_ROCKER, RIGHT_ROCKER))
    angle_rad = mechanics.closest.transmission_angle_rad
    frames, bits = _traffic(bench)
    return BenchSummary(
        left_sweep_deg=float(left),
        right_sweep_deg=float(right),
        transmission_angle_deg=angle_rad / RAD_PER_DEG if math.isfinite(angle_rad) else None,
        blade_clearance_m=mechanics.clearance_m,
        moving_mass_kg=float(mechanics.wiper.masses_kg.sum()),
        projection_loss_m=_worst_loss(bench.plant)[1],
        sent_frames_per_s=frames,
        sent_bits_per_s=bits,
        assumed=_assumed(bench.plant),
    )


def summary_lines(bench: Bench) -> list[str]:
    """Return the figures of a bench as lines for people."""
    made, plant = summarise(bench), bench.plant
    names = [
        ("motor", _motor(plant)),
        ("linkage", f"{plant.mechanics.written.name} ({plant.mechanics.written.status})"),
        ("sweep", f"left {made.left_sweep_deg:.3f} deg, right {made.right_sweep_deg:.3f} deg"),
        ("dead point", _closeness(plant)),
        (
            "blades",
            f"at least {made.blade_clearance_m:.3f} m apart" if made.blade_clearance_m else "cross on the screen",
        ),
        ("mass", f"{made.moving_mass_kg:.4g} kg moves" if made.moving_mass_kg else "none given"),
        *_projection(plant),
        *_lean(plant),
        ("load", _load(plant)),
        ("park switch", CIRCUITS[int(bench.parameters.park_switch.circuit)]),
        ("bus", f"{len(bench.receive)} messages in, {len(bench.send)} out; {_rate(made)}"),
        ("assumed", "; ".join(_grouped(made.assumed)) or "nothing"),
    ]
    wrapped = textwrap.TextWrapper(110, initial_indent="  ", subsequent_indent=" " * 14)
    return [line for name, text in names for line in wrapped.wrap(f"{name:<12}{text}")]


def _closeness(plant: Plant) -> str:
    closest = plant.mechanics.closest
    at = f"at crank angle {closest.crank_angle_rad / RAD_PER_DEG:.1f} deg"
    return f"nearest {at}, transmission angle {closest.transmission_angle_rad / RAD_PER_DEG:.1f} deg at {closest.where}"


def _lean(plant: Plant) -> list[tuple[str, str]]:
    """Return how far the screen leans, where there is one."""
    if plant.screen is None:
        return []
    degrees = abs(plant.screen.from_vertical_rad) / RAD_PER_DEG
    return [("screen", f"leans {degrees:.1f} deg from the vertical, {90.0 - degrees:.1f} deg from the horizontal")]


def _projection(plant: Plant) -> list[tuple[str, str]]:
    body, loss = _worst_loss(plant)
    if loss < NO_LOSS_M:
        return []
    return [("projection", f"{body} is up to {1000.0 * loss:.3g} mm longer in space than in the plane")]


def _worst_loss(plant: Plant) -> tuple[str, float]:
    """Return the body that loses most when its design points are laid into the plane, and how much [m]."""
    written, linkage = plant.mechanics.written, plant.mechanics.linkage
    losses = projection_loss(written.points_m, linkage.body_points)
    for side in SIDES:
        for part in (f"{side}_arm", f"{side}_blade"):
            points = getattr(written, part).points_m
            losses |= projection_loss(points, {part: tuple(points)})
    return max(losses.items(), key=lambda item: item[1])


def _motor(plant: Plant) -> str:
    network = ", a network where it reaches" if plant.parameters.motor_model == NARX else ""
    return f"{plant.motor.name} ({plant.motor.status}), gear {plant.motor.gear_ratio:g}{network}"


def _load(plant: Plant) -> str:
    if not isinstance(plant.load, WholeWiper) or plant.blades is None or plant.screen is None:
        return plant.load.model
    left, right = (entry.force_n for entry in plant.blades)
    points = f"{plant.load.points} point{'s' if plant.load.points > 1 else ''}"
    model = "network, where it does not reach reduced" if isinstance(plant.load, NetworkLoad) else plant.load.model
    return f"{model}, screen {plant.screen.name}, {left:g} N left and {right:g} N right at {points} of each blade"


def _rate(made: BenchSummary) -> str:
    return f"sends {made.sent_frames_per_s:.0f} frames/s, at most {made.sent_bits_per_s / 1000.0:.1f} kbit/s"


def _traffic(bench: Bench) -> tuple[float, float]:
    """Return frames and bits a second that the plant sends without any change, with the most stuffing.

    A classic frame of n bytes has 47 + 8 n bits, 13 of which are never stuffed, with an identifier of 11 bits, and
    67 + 8 n with one of 29; one bit follows at most every four of the others. FD frames are counted as classic ones.
    """
    frames, bits = 0.0, 0.0
    for message in bench.send:
        if message.period_ns:
            rate = SECOND_NS / message.period_ns
            whole = (67 if message.extended else 47) + 8 * message.length
            frames, bits = frames + rate, bits + rate * (whole + (whole - 14) // 4)
    return frames, bits


def _assumed(plant: Plant) -> list[str]:
    left, right = plant.blades or (None, None)
    named: list[tuple[str, Checked | None]] = [
        ("motor.", plant.motor),
        ("linkage.", plant.mechanics.written),
        ("screen.", plant.screen),
        ("blades.left.", left),
        ("blades.right.", right),
        ("park_switch.", plant.park_switch),
        *(
            (f"{key}.", getattr(plant.section, key))
            for key in ("supply", "wires", "relays", "current_sensor", "heat", "obstacles", "backlash", "wear", "water")
        ),
    ]
    return [name for prefix, part in named if part is not None for name in assumed_in(part, prefix)]


def _grouped(names: list[str]) -> Iterator[str]:
    """Return names with a common group as one: `group: name, name`."""
    groups: dict[str, list[str]] = {}
    for name in names:
        group, _, last = name.rpartition(".")
        groups.setdefault(group, []).append("all of it" if last == "*" else last)
    for group, members in groups.items():
        yield f"{group}: {', '.join(members)}"
