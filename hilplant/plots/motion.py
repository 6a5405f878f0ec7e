"""Draws how the bodies of a wiper move over time, and what its joints carry: 4.2.4 and 4.3."""

from os import PathLike
from typing import Any

import numpy as np

from hilplant.mechanics.solved_motion import SolvedMotion
from hilplant.plots.picture import plain_figure, save
from hilplant.simulation.joint_loads import JointLoads
from hilplant.units import RAD_PER_DEG


def plot_motion(solved: SolvedMotion, bodies: tuple[str, ...], out: str | PathLike[str], title: str) -> None:
    """Draw x, y and angle of some bodies: position, velocity and acceleration, a column each.

    Raises
    ------
    Failure
        For a body that there is not, or when the picture cannot be written.

    """
    tracks = [solved.track(name) for name in bodies]
    turning = any("angle_rad" in track.position for track in tracks)
    figure, panels = plain_figure((13, 9 if turning else 6.5), 3 if turning else 2, 3, sharex=True)
    for column, (word, part) in enumerate(
        (("position", "position"), ("velocity", "velocity"), ("acceleration", "acceleration"))
    ):
        panels[0, column].set_title(word, fontsize=10)
        for track in tracks:
            for row, (name, values) in enumerate(getattr(track, part).items()):
                panels[row, column].plot(solved.time_s, values, label=track.name)
                panels[row, column].set_ylabel(_with_unit(name))
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    panels[0, 0].legend(frameon=False, fontsize=8)
    figure.suptitle(title, parse_math=False)
    save(figure, out, 110)


def _with_unit(name: str) -> str:
    axis, _, unit = name.partition("_")
    power = {"m": "m", "rad": "rad", "m_s": "m/s", "rad_s": "rad/s", "m_s2": "m/s2", "rad_s2": "rad/s2"}
    return f"{axis} [{power[unit]}]"


def plot_joint_loads(found: JointLoads, out: str | PathLike[str], title: str) -> None:
    """Draw the force of every joint over the crank angle, those of the linkage and of the arms apart, and moments."""
    figure, (linkage, arms, moments) = plain_figure((11, 11), 3, sharex=True)
    degrees = found.moving.crank_rad / RAD_PER_DEG
    for name, size, joint in zip(found.names(), found.sizes_n(), found.loads.joints, strict=True):
        axes = arms if "_arm_" in name or "_blade_" in name else linkage
        axes.plot(degrees, size, label=f"{name}: {size.max():.4g} N at {degrees[size.argmax()]:.0f}°")
        if np.abs(joint.moment_n_m).max() > 1e-9 and not name.startswith("ground - car"):
            moments.plot(degrees, joint.moment_n_m, label=f"{name}: {np.abs(joint.moment_n_m).max():.3g} N m")
    torque = found.loads.crank_torque_n_m
    moments.plot(degrees, torque, color="black", label=f"crank, driving: {np.abs(torque).max():.3g} N m")
    for axes, label in ((linkage, "linkage [N]"), (arms, "arms and blades [N]"), (moments, "moment [N m]")):
        axes.set_ylabel(label)
        _legend(axes)
    moments.set_xlabel("crank angle from park [°]; the numbers are the largest of the turn")
    moments.set_xticks(range(0, 361, 45))
    moments.set_xlim(0, 360)
    figure.suptitle(title, parse_math=False)
    save(figure, out, 110)


def _legend(axes: Any) -> None:
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=8)
