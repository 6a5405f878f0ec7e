"""Draws the three park circuits side by side: slow, fast, off, as Figures 3-17 and 3-22 of Dooner (2016) are told."""

from os import PathLike
from typing import Any

import numpy as np

from hilplant.arrays import AnyArray, Floats
from hilplant.plots.picture import figure_with, save
from hilplant.simulation.run import Result, simulate
from hilplant.units import TURN_RAD

#: Bench of each circuit, and what is written over its column.
BENCHES = {
    "default": "digital: stops where it is",
    "mechanical": "mechanical: runs to park, shorted there",
    "depressed": "depressed: turns back at park, then open",
}
SCENARIO = "slow_fast_off"
LAST_S = 6.5
#: Before and after the last switching, in the lowest row [s].
AROUND_S = (0.03, 0.22)

_BLUE, _ORANGE, _GREEN, _RED, _GREY = "#0b5cad", "#d9730d", "#2a7f3e", "#b3261e", "#6b7280"
#: Terminals from the lowest lane to the highest.
_LANES = (("31", "common", _GREY), ("53e", "park line", _GREEN), ("53b", "fast", _ORANGE), ("53", "slow", _BLUE))
_LANE_V = 22.0


def plot_park_sequences(out_png: str | PathLike[str]) -> None:
    """Simulate the shipped scenario with each circuit, and draw terminals, current, speed and crank angle.

    Raises
    ------
    Failure
        When the picture cannot be written.
    """
    figure, panels = figure_with((13, 11), 5, len(BENCHES), sharey="row", height_ratios=[1.7, 1.0, 1.0, 1.0, 1.2])
    for column, (bench, title) in zip(panels.T, BENCHES.items(), strict=True):
        _draw_circuit(column, simulate(bench, SCENARIO), title)
    for axes, label in zip(
        panels[:, 0],
        ("terminals [V]", "current [A]", "crank [rev/min]", "crank from park [°]", "at the stop"),
        strict=True,
    ):
        axes.set_ylabel(label)
    figure.align_ylabels(panels[:, 0])
    figure.suptitle("Slow at 0 s, fast at 2 s, off at 4 s; grey: the park contact is closed")
    save(figure, out_png, 110)


def _draw_circuit(column: AnyArray, result: Result, title: str) -> None:
    terminals, current, speed, angle, stop = column
    for axes in column:
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
        _shade(axes, result)
    for axes in column[:-1]:
        axes.set_xlim(0.0, LAST_S)
        for switched_s in (2.0, 4.0):
            axes.axvline(switched_s, color=_GREY, linestyle=":", linewidth=1.0)
    terminals.set_title(title)
    _terminals(terminals, result)
    current.plot(result.time_s, result["current_a"], color=_RED, linewidth=0.9)
    speed.plot(result.time_s, _turns(result), color=_GREEN)
    angle.plot(*_without_jumps(result), color=_BLUE)
    angle.set_yticks([-180, -90, 0, 90, 180])
    angle.set_xlabel("time [s]")
    _stop(stop, result)


def _shade(axes: Any, result: Result) -> None:
    """Mark where the park contact is closed."""
    closed = result["park_contact"] > 0.5
    axes.fill_between(
        result.time_s, 0, 1, where=closed, transform=axes.get_xaxis_transform(), color=_GREY, alpha=0.2, linewidth=0
    )


def _terminals(axes: Any, result: Result) -> None:
    """Draw each terminal in a lane of its own, over a line at ground."""
    for lane, (terminal, _, color) in enumerate(_LANES):
        axes.axhline(lane * _LANE_V, color=color, linewidth=0.5)
        axes.plot(result.time_s, lane * _LANE_V + result[f"terminal_{terminal}_v"], color=color)
    axes.set_yticks(
        [lane * _LANE_V + volts for lane in range(len(_LANES)) for volts in (0, 13.5)],
        [label for terminal, meaning, _ in _LANES for label in (f"{terminal} {meaning}  0", "13.5")],
    )
    axes.yaxis.grid(False)


def _turns(result: Result) -> Floats:
    return result["crank_speed_rad_s"] * 60.0 / TURN_RAD


def _without_jumps(result: Result) -> tuple[Floats, Floats]:
    """Return times and crank angles from park [deg], with a gap where the angle begins a new turn."""
    angle = (np.degrees(result["crank_angle_rad"]) + 180.0) % 360.0 - 180.0
    angle[1:][np.abs(np.diff(angle)) > 180.0] = np.nan
    return result.time_s, angle


def _stop(axes: Any, result: Result) -> None:
    """Draw current and speed around the last switching."""
    switched = result.time_s[np.flatnonzero(np.diff(result["terminal_v"])) + 1]
    last = float(switched[switched > switched[-1] - 0.2][0])
    axes.set_xlim(last - AROUND_S[0], last + AROUND_S[1])
    axes.plot(result.time_s, result["current_a"], color=_RED, label="current [A]")
    axes.plot(result.time_s, _turns(result), color=_GREEN, label="crank [rev/min]")
    axes.plot(*_without_jumps(result), color=_BLUE, label="crank from park [°]")
    axes.set_ylim(-50.0, 125.0)
    axes.set_xlabel("time [s]")
    axes.legend(loc="upper right", frameon=False, fontsize=8)
