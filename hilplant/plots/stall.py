"""Draws a motor that is stalled, gets hot, trips and recovers, and what the simulated ECU does meanwhile."""

from collections.abc import Sequence
from os import PathLike
from typing import Any, NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.plots.picture import plain_figure, save
from hilplant.signals import ECU_FAULTS, ECU_STATES
from hilplant.units import RAD_PER_S_PER_RPM

_BLUE, _ORANGE, _GREEN, _RED, _GREY = "#0b5cad", "#d9730d", "#2a7f3e", "#b3261e", "#6b7280"
_LABELS = ("current [A]", "winding [degC]", "crank [rev/min]", "state of the ECU", "reported")


class Stall(NamedTuple):
    """A run: signals by name, currents of a stall [A], and where the thermal switch opens and closes [degC]."""

    title: str
    step_s: float
    signals: dict[str, Floats]
    stall_a: tuple[float, float]
    switch_c: tuple[float, float]


def draw_stalls(runs: Sequence[Stall], out: str | PathLike[str]) -> None:
    """Draw runs side by side.

    Raises
    ------
    Failure
        When the picture cannot be written.

    """
    figure, panels = plain_figure((7.5 * len(runs), 11), len(_LABELS), len(runs), sharex="col",
                                  height_ratios=[1.2, 1.2, 0.8, 1.2, 0.9])  # fmt: skip
    for column, run in zip(panels.T, runs, strict=True):
        _draw(column, run)
    for axes, label in zip(panels[:, 0], _LABELS, strict=True):
        axes.set_ylabel(label)
    figure.align_ylabels(panels[:, 0])
    save(figure, out, 90)


def _draw(column: Any, run: Stall) -> None:
    current, winding, crank, state, fault = column
    time_s = run.step_s * np.arange(len(run.signals["current_a"]), dtype=np.float64)
    current.set_title(run.title)
    current.plot(time_s, run.signals["current_a"], color=_RED, linewidth=0.8)
    winding.plot(time_s, run.signals["winding_temperature_c"], color=_ORANGE)
    for axes, levels, unit in ((current, run.stall_a, "A"), (winding, run.switch_c, "degC")):
        for level in levels:
            if level <= 1.3 * max(1.0, float(np.nanmax(axes.lines[0].get_ydata()))):
                axes.axhline(level, color=_GREY, linestyle="--", linewidth=0.8)
                axes.text(time_s[-1], level, f"{level:g} {unit}", ha="right", va="bottom", fontsize=8, color=_GREY)
    opened = run.signals["thermal_switch"] > 0.5
    winding.fill_between(time_s, 0, 1, where=opened, transform=winding.get_xaxis_transform(), color=_GREY, alpha=0.25,
                         linewidth=0, label="thermal switch open")  # fmt: skip
    winding.legend(loc="lower right", frameon=False, fontsize=8)
    crank.plot(time_s, run.signals["crank_speed_rad_s"] / RAD_PER_S_PER_RPM, color=_GREEN, linewidth=0.8)
    _names(state, time_s, run.signals["EcuState"], ECU_STATES)
    _names(fault, time_s, run.signals["EcuFault"], ECU_FAULTS)
    fault.set_xlabel("time [s]")
    fault.set_xlim(0.0, time_s[-1])


def _names(axes: Any, time_s: Floats, values: Floats, names: Sequence[str]) -> None:
    """Draw numbers that stand for names, each name that occurs on a line of its own."""
    met = sorted({int(value) for value in values[np.isfinite(values)]})
    lines = np.full(len(values), np.nan)
    for line, number in enumerate(met):
        lines[values == number] = line
    axes.plot(time_s, lines, color=_BLUE, linewidth=1.0, drawstyle="steps-post")
    axes.set_yticks(range(len(met)), [names[number].replace("_", " ") for number in met])
    axes.set_ylim(-0.5, max(1, len(met)) - 0.5)
