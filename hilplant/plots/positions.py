"""Draws a wiper in four positions, as Figure 4-9 of the thesis is described: linkage, arms and blades, in cm."""

from os import PathLike
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.mechanics.motion import Motion, motion
from hilplant.mechanics.planar import Revolute
from hilplant.mechanics.wiper import Wiper, WiperSide
from hilplant.plots.picture import figure_with, save
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Crank angles that are drawn when none are asked for [deg].
FOUR_DEG = (0.0, 60.0, 120.0, 180.0)
MOST_POSITIONS = 16
_CM = 100.0
_SWEEP_STEPS = 181
_BLUE, _ORANGE, _GREY, _BLACK, _RED = "#0b5cad", "#d9730d", "#6b7280", "#1f2937", "#b3261e"


def plot_positions(
    wiper: Wiper, out_png: str | PathLike[str], title: str, crank_deg: tuple[float, ...] = FOUR_DEG
) -> None:
    """Draw the wiper at some crank angles [deg] into a picture, 0 being park, 180 and more the way back.

    The tinted areas are what the blades sweep in a turn, the dotted lines the ways of the blades' joints.

    Raises
    ------
    Failure
        For no angles, for more than 16, or when the picture cannot be written.
    """
    if not 1 <= len(crank_deg) <= MOST_POSITIONS:
        raise Failure(f"1 to {MOST_POSITIONS} positions are drawn, not {len(crank_deg)}")
    turn = motion(wiper, np.linspace(0.0, TURN_RAD, _SWEEP_STEPS))
    moving = motion(wiper, np.array(crank_deg) * RAD_PER_DEG)
    columns = min(len(crank_deg), 2 if len(crank_deg) <= 4 else 4)
    rows = -(-len(crank_deg) // columns)
    size = (6.0 * columns, 4.0 * rows + 0.6) if columns < 3 else (4.0 * columns, 2.9 * rows + 0.6)
    figure, panels = figure_with(size, rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes in panels.ravel()[len(crank_deg) :]:
        axes.set_visible(False)
    for index, axes in enumerate(panels.ravel()[: len(crank_deg)]):
        draw_area(axes, wiper, turn)
        draw_wiper(axes, wiper, moving.coordinates[index])
        axes.set_title(f"crank {crank_deg[index]:g}°{_arm_angles(wiper, moving, index)}", fontsize=10)
    for axes in panels[-1]:
        axes.set_xlabel("x [cm]")
    for axes in panels[:, 0]:
        axes.set_ylabel("y [cm]")
    lines, labels = panels[0, 0].get_legend_handles_labels()
    once = dict(zip(labels, lines, strict=True))  # all links but the crank look alike
    figure.legend(once.values(), once.keys(), loc="outside lower center", ncols=len(once), frameon=False)
    figure.suptitle(title, parse_math=False)
    save(figure, out_png, 110)


def draw_wiper(axes: Any, wiper: Wiper, coordinates: Floats) -> None:
    """Draw linkage, arms and blades at one position."""
    _linkage(axes, wiper, coordinates)
    for side, color in zip(wiper.sides, (_BLUE, _ORANGE), strict=True):
        _arm_and_blade(axes, wiper, side, (coordinates, color))
    axes.set_aspect("equal")
    axes.grid(alpha=0.25)


def _arm_angles(wiper: Wiper, moving: Motion, index: int) -> str:
    angles = [
        (moving.coordinates[index, wiper.mechanism.angle(side.rocker)] + side.arm.offset_rad) / RAD_PER_DEG
        for side in wiper.sides
    ]
    return f": left arm {angles[0]:.1f}°, right arm {angles[1]:.1f}°"


def _linkage(axes: Any, wiper: Wiper, coordinates: Floats) -> None:
    """Draw each body of the linkage between its joints; fixed pivots are triangles."""
    carried = {name for side in wiper.sides for name in side.bodies}
    for body in wiper.bodies:
        if body.name in carried or body.name == "ground":
            continue
        joints = np.array([wiper.mechanism.point(coordinates, pin) for pin in _pins(wiper, body.name)]) * _CM
        ends = [wiper.mechanism.point(coordinates, pin) * _CM for pin in (body.first_end, body.second_end)]
        driven = body.name == wiper.mechanism.driven
        color, label, height = (_RED, "crank", 7) if driven else (_BLACK, "other links", 4)
        axes.plot(*np.array(ends).T, color=color, linewidth=3.5 if driven else 2.0, label=label, zorder=height)
        axes.plot(*joints.T, "o", color="white", markeredgecolor=color, markersize=4, zorder=height + 1)
    fixed = np.array([wiper.mechanism.point(coordinates, pin) for pin in _pins(wiper, "ground")]) * _CM
    axes.plot(*fixed.T, "^", color=_GREY, markersize=11, zorder=3, label="fixed pivots")


def _pins(wiper: Wiper, body: str) -> list[tuple[str, tuple[float, float]]]:
    """Return the places of a body at which it is joined to others by a pivot."""
    turning = [joint for joint in wiper.joints if isinstance(joint, Revolute)]
    return [pin for joint in turning for pin in (joint.first, joint.second) if pin[0] == body]


def _arm_and_blade(axes: Any, wiper: Wiper, side: WiperSide, look: tuple[Floats, str]) -> None:
    coordinates, color = look
    bodies = {body.name: body for body in wiper.bodies}
    rods = [bodies[name] for name in side.bodies if "_arm_" in name]
    pins = [rods[0].first_end, *(rod.second_end for rod in rods)]
    arm = np.array([wiper.mechanism.point(coordinates, pin) for pin in pins]) * _CM
    axes.plot(*arm.T, color=color, linewidth=2.0, marker=".", markersize=5, label=f"{side.name} arm", zorder=6)
    if side.tips:
        blade = [side.tips[0], side.centre, side.tips[1]]
        places = np.array([wiper.mechanism.point(coordinates, pin) for pin in blade]) * _CM
        look_of_blade = {"color": color, "linewidth": 4.5, "alpha": 0.75, "solid_capstyle": "round", "zorder": 6}
        axes.plot(*places.T, **look_of_blade, label=f"{side.name} blade")


def draw_area(axes: Any, wiper: Wiper, turn: Motion) -> None:
    """Tint what each blade sweeps, from tip to tip, and dot the way of its joint."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    for side, color in zip(wiper.sides, (_BLUE, _ORANGE), strict=True):
        way = wiper.mechanism.point(turn.coordinates, side.centre) * _CM
        axes.plot(*way.T, color=color, linewidth=0.9, linestyle=":", zorder=2)
        if side.tips:
            first, second = (wiper.mechanism.point(turn.coordinates, pin) * _CM for pin in side.tips)
            corners = np.stack([first[:-1], first[1:], second[1:], second[:-1], first[:-1]], axis=1)
            pieces = [Path(piece if _anticlockwise(piece) else piece[::-1]) for piece in corners]
            axes.add_patch(PathPatch(Path.make_compound_path(*pieces), color=color, alpha=0.1, linewidth=0, zorder=1))


def _anticlockwise(closed: Floats) -> bool:
    """Say which way round a closed line goes: pieces that lie on each other are one area if all go the same way."""
    x, y = closed.T
    return bool((x[:-1] * y[1:] - x[1:] * y[:-1]).sum() > 0.0)
