"""Draws what a network learns from, as Figures F-1 to F-9 of Dooner (2016), and how well the torque network has."""

from collections.abc import Sequence
from os import PathLike

import numpy as np

from hilplant.plots.picture import plain_figure, save
from hilplant.train.drawn_data import TrainingData
from hilplant.train.torque import Data, TrainedTorque

_LABELS = {
    "crank_angle_rad": "crank angle [rad]",
    "crank_speed_rad_s": "crank speed\n[rad/s]",
    "dry_torque_n_m": "dry torque [N m]",
    "wet_torque_n_m": "wet torque [N m]",
    "terminal_v": "voltage [V]",
    "torque_n_m": "torque [N m]",
    "current_a": "current [A]",
    "known": "network asked",
}
_BLUE, _ORANGE, _RED = "#0b5cad", "#d9730d", "#b3261e"


def plot_training_data(sets: Sequence[TrainingData], out: str | PathLike[str], title: str) -> None:
    """Draw every column of every set, a set a column, over sample or time."""
    names = list(sets[0].columns)
    figure, panels = plain_figure((6.5 * len(sets), 1.9 * (len(names) - 1) + 1.0), len(names) - 1, len(sets))
    for column, each in zip(np.atleast_2d(panels).T, sets, strict=True):
        (over, along), *rest = each.columns.items()
        for axes, (name, values) in zip(column, rest, strict=True):
            axes.plot(along, values, color=_BLUE, linewidth=0.6)
            axes.set_ylabel(_LABELS[name])
        column[0].set_title(f"{each.name} (compare Figure {each.figure})", fontsize=10)
        column[-1].set_xlabel("time [s]" if over == "time_s" else over)
    figure.suptitle(title, parse_math=False)
    save(figure, out, 100)


def plot_torque_fit(data: Data, trained: TrainedTorque, folder: str | PathLike[str]) -> list[str]:
    """Draw network and target with their errors, dry and wet; return the names of the files: Figures 6-9 to 6-12."""
    written = []
    sets = (("training", "6-9, 6-10", data.training), ("validation", "6-11, 6-12", data.validation))
    for name, number, wipes in sets:
        figure, panels = plain_figure((12, 7), 2, 2, sharex=True)
        ours, samples = trained.torques(wipes.states), np.arange(len(wipes.states))
        for column, screen in enumerate(("dry", "wet")):
            target, network = wipes.torques[:, column], ours[:, column]
            panels[0, column].plot(samples, target, color=_BLUE, label="physical plant")
            panels[0, column].plot(samples, network, color=_ORANGE, linewidth=0.9, linestyle="--", label="network")
            panels[0, column].set(ylabel=f"{screen} torque [N m]")
            panels[1, column].plot(samples, network - target, color=_RED, linewidth=0.7)
            rms = float(np.sqrt(np.mean((network - target) ** 2)))
            panels[1, column].set(ylabel=f"error [N m], {rms:.3g} rms", xlabel="sample")
        lines, labels = panels[0, 0].get_legend_handles_labels()
        figure.legend(lines, labels, loc="outside lower center", ncols=len(labels), frameon=False)
        figure.suptitle(f"Torque network, {name} data (compare Figures {number})")
        save(figure, f"{folder}/torque_{name}.png", 100)
        written.append(f"torque_{name}.png")
    return written
