"""Draws what the mechanics ask of the motor: torque over the crank angle, and the test of section 4.6."""

from os import PathLike
from typing import Any

import numpy as np

from hilplant.bench.assembly import Bench
from hilplant.plots.picture import figure_with, save
from hilplant.simulation.crank_torque import WETNESS, Conditions, crank_torque
from hilplant.simulation.five_wipes import CRANK_SPEED_RAD_S, Wipe, five_wipes
from hilplant.units import RAD_PER_DEG, TURN_RAD

#: Crank speeds that are drawn [rev/min].
SPEEDS_REV_MIN = (20.0, 40.0, 60.0)
ANGLES = 721

_COLORS = {"dry": "#b3261e", "tacky": "#d9730d", "wet": "#0b5cad"}
_GREY = "#6b7280"


def plot_torque(bench: Bench, out_png: str | PathLike[str]) -> None:
    """Draw the torque over one turn of the crank, dry, tacky and wet, at three speeds.

    Raises
    ------
    Failure
        When the picture cannot be written.

    """
    figure, panels = _figure((11, 7.5), len(SPEEDS_REV_MIN))
    crank = np.linspace(0.0, TURN_RAD, ANGLES)[:-1]
    for axes, speed in zip(panels, SPEEDS_REV_MIN, strict=True):
        for name, color in _COLORS.items():
            torque = crank_torque(bench, crank, speed * TURN_RAD / 60.0, Conditions(WETNESS[name]))
            axes.plot(crank / RAD_PER_DEG, torque, color=color, label=f"{name}, mean {torque.mean():.2f} N m")
        axes.axhline(0.0, color=_GREY, linewidth=0.8)
        axes.set_title(f"{speed:g} turns a minute", fontsize=10, loc="left")
        axes.set_ylabel("torque [N m]")
        axes.legend(loc="upper right", frameon=False, fontsize=9, ncols=3)
    panels[-1].set_xlabel("crank angle from park [°]")
    panels[-1].set_xticks(range(0, 361, 45))
    panels[-1].set_xlim(0, 360)
    low, high = panels[0].get_ylim()
    panels[0].set_ylim(low, high + 0.18 * (high - low))
    figure.suptitle(f"{bench.name}: torque at the crank, positive when it opposes motion", parse_math=False)
    save(figure, out_png, 110)


def plot_conditions(bench: Bench, out_png: str | PathLike[str]) -> None:
    """Draw the test of section 4.6, which the thesis shows in Figure 4-32.

    Raises
    ------
    Failure
        When the picture cannot be written.

    """
    figure, (axes,) = _figure((11, 5.0), 1)
    for second, wipe in enumerate(five_wipes(bench)):
        _draw_wipe(axes, second, wipe)
    axes.axhline(0.0, color=_GREY, linewidth=0.8)
    axes.set_xlim(0, 5)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.25 * (high - low))
    axes.set_xlabel("time [s]; tinted: the forward wipe")
    axes.set_ylabel("torque [N m]")
    turns = CRANK_SPEED_RAD_S * 60.0 / TURN_RAD
    figure.suptitle(
        f"{bench.name}: torque at the crank at an even {turns:g} turns a minute, section 4.6", parse_math=False
    )
    save(figure, out_png, 110)


def _draw_wipe(axes: Any, second: int, wipe: Wipe) -> None:
    name = "dry" if wipe.conditions.wetness == WETNESS["dry"] else "wet"
    time = second + wipe.crank_rad / TURN_RAD
    axes.plot(time, wipe.torque_n_m, color=_COLORS[name])
    ends = time[wipe.forward][[0, -1]]
    axes.axvspan(*ends, color=_GREY, alpha=0.1, linewidth=0)
    text = f"{name}, {wipe.conditions.vehicle_speed_m_s:g} m/s\nmean {wipe.mean_n_m:.2f} N m"
    axes.text(second + 0.5, 0.98, text, transform=axes.get_xaxis_transform(), ha="center", va="top", fontsize=9)


def _figure(size: tuple[float, float], rows: int) -> tuple[Any, Any]:
    figure, panels = figure_with(size, rows, squeeze=False, sharex=True, sharey=True)
    for axes in panels[:, 0]:
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure, panels[:, 0]
