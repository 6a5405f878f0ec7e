"""Draws a recording: what the wipers were told, and what they did, over time."""

from os import PathLike
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.plots.picture import figure_with, save
from hilplant.recording.export import signal_columns
from hilplant.recording.reader import read_recording
from hilplant.units import SECOND_NS

Columns = dict[str, Floats]

_MOST_POINTS = 100_000
_BLUE, _ORANGE, _GREEN, _RED, _GREY = "#0b5cad", "#d9730d", "#2a7f3e", "#b3261e", "#6b7280"


def plot_recording(path: str | PathLike[str], out_png: str | PathLike[str]) -> None:
    """Draw a recording's supply, current, speed, arms and switches into a picture.

    Raises
    ------
    Failure
        When the file is not a recording, holds no ticks, or the picture cannot be written.
    """
    recording = read_recording(path)
    columns, _ = signal_columns(recording)
    if not len(columns["time_s"]):
        raise Failure(f"{path}: holds no ticks to draw")
    stride = -(-len(columns["time_s"]) // _MOST_POINTS)
    columns = {name: values[::stride] for name, values in columns.items()}
    figure, panels = figure_with((10, 8.5), 5, sharex=True, height_ratios=[1.0, 1.0, 1.0, 1.2, 0.8])
    for draw, axes in zip((_voltage, _current, _speed, _arms, _switches), panels, strict=True):
        axes.grid(alpha=0.25)
        draw(axes, columns)
        axes.spines[["top", "right"]].set_visible(False)
    figure.align_ylabels(panels[:-1])
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(0.0, max(columns["time_s"][-1], recording.run.step_ns / SECOND_NS))
    sparse = f", one tick in {stride}" if stride > 1 else ""
    figure.suptitle(
        f"{recording.run.name}: {columns['time_s'][-1]:.4g} s, recorded by hilplant{sparse}", parse_math=False
    )
    save(figure, out_png, 130)


def _legend(axes: Any) -> None:
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=2, frameon=False, fontsize=9)


def _voltage(axes: Any, columns: Columns) -> None:
    axes.plot(columns["time_s"], columns["supply_v"], color=_GREY, linestyle="--", label="supply")
    axes.plot(columns["time_s"], columns["terminal_v"], color=_BLUE, label="motor terminal")
    axes.set_ylabel("voltage [V]")
    axes.set_ylim(bottom=0, top=max(16.0, 1.15 * columns["supply_v"].max()))
    _legend(axes)


def _current(axes: Any, columns: Columns) -> None:
    axes.plot(columns["time_s"], columns["current_a"], color=_RED, linewidth=1.2)
    axes.axhline(0, color=_GREY, linewidth=0.6)
    axes.set_ylabel("current [A]")


def _speed(axes: Any, columns: Columns) -> None:
    turns = columns["crank_speed_rad_s"] * 60 / (2 * np.pi)
    axes.plot(columns["time_s"], turns, color=_GREEN)
    axes.axhline(0, color=_GREY, linewidth=0.6)
    axes.set_ylabel("crank [rev/min]")


def _arms(axes: Any, columns: Columns) -> None:
    for name, color, label in (("left_arm_rad", _BLUE, "left arm"), ("right_arm_rad", _ORANGE, "right arm")):
        axes.plot(columns["time_s"], np.degrees(columns[name]), color=color, label=label)
    axes.set_ylabel("arm angle [°]")
    _legend(axes)


def _switches(axes: Any, columns: Columns) -> None:
    """Draw the switches as lanes, one above the other, filled while they are closed."""
    lanes = (
        ("park_contact", "park contact", _GREEN),
        ("in_relay_fast", "FAST/SLOW relay", _ORANGE),
        ("in_relay_on", "ON/OFF relay", _BLUE),
    )
    for height, (name, _, color) in enumerate(lanes):
        closed = columns[name] > 0.5
        axes.fill_between(
            columns["time_s"],
            height,
            height + 0.7 * closed,
            step="post",
            color=color,
            alpha=0.75,
            linewidth=0.5,
        )
        axes.axhline(height, color=color, linewidth=0.6)
    axes.set_yticks([height + 0.35 for height in range(len(lanes))], [label for _, label, _ in lanes])
    axes.tick_params(axis="y", length=0)
    axes.yaxis.grid(False)
    axes.set_ylim(-0.15, len(lanes))
