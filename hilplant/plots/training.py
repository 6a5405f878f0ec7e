"""Pictures of the fits to the load: a torque network and its errors, its number of neurons, the polynomials."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hilplant.plots.picture import figure_with, save
from hilplant.train.no_load import SPEEDS_RAD_S, Polynomials, Shape
from hilplant.train.torque_file import Dense
from hilplant.train.torque_study import Studied
from hilplant.train.torque_thesis import TABLE_6_1


def plot_errors(dense: Dense, path: Path) -> None:
    """Draw torques and errors over angle and speed, dry above, wet below."""
    speeds = np.unique(dense.states[:, 1])
    angles = np.degrees(dense.states[: len(dense.states) // len(speeds), 0])
    shape = (len(speeds), len(angles))
    figure, axes = figure_with((11, 7), 2, 2, sharex=True)
    for row, screen in enumerate(("dry", "wet")):
        physical, errors = (values[:, row].reshape(shape) for values in (dense.physical, dense.errors))
        for index in np.linspace(0, len(speeds) - 1, 4).astype(int):
            line = axes[row, 0].plot(angles, physical[index], label=f"{speeds[index]:.2g} rad/s")[0]
            axes[row, 0].plot(angles, (physical + errors)[index], "--", color=line.get_color())
        axes[row, 0].set(ylabel=f"{screen} torque [N m]", title="physical, and network dashed" if row == 0 else "")
        most = np.abs(errors).max()
        shown = axes[row, 1].pcolormesh(angles, speeds, errors, cmap="RdBu_r", vmin=-most, vmax=most)
        axes[row, 1].set(ylabel="crank speed [rad/s]", title="error of the network [N m]" if row == 0 else "")
        figure.colorbar(shown, ax=axes[row, 1])
        axes[1, row].set_xlabel("crank angle [deg]")
    axes[0, 0].legend(loc="upper right", fontsize=8)
    save(figure, path, 120)


def plot_study(studied: Sequence[Studied], path: Path) -> None:
    """Draw what Figure 6-7 shows: errors over the number of neurons, ours and those of Table 6-1."""
    figure, axis = figure_with((9, 5))
    neurons = sorted(TABLE_6_1)
    axis.semilogy(neurons, [TABLE_6_1[n][3] for n in neurons], "k.-", label="thesis, training data")
    axis.semilogy(neurons, [TABLE_6_1[n][4] for n in neurons], "k.--", label="thesis, separate validation")
    for color, harmonics in zip(("C0", "C1", "C2"), sorted({one.harmonics for one in studied}), strict=False):
        of_kind = [one for one in studied if one.harmonics == harmonics]
        inputs = f"sines up to {harmonics} angle" if harmonics else "angle"
        own = [one.neurons for one in of_kind]
        axis.semilogy(own, [one.total for one in of_kind], f"{color}.-", label=f"ours, {inputs}, training data")
        axis.semilogy(own, [one.validation for one in of_kind], f"{color}.--", label=f"ours, {inputs}, validation")
    axis.set(xlabel="neurons", ylabel="mean squared error [(N m)2]", xticks=neurons)
    axis.legend(fontsize=8)
    axis.grid(alpha=0.3)
    save(figure, path, 120)


def plot_shape(shape: Shape, fitted: Polynomials, path: Path) -> None:
    """Draw the no-load torque of a linkage and its polynomials, dashed, at the five speeds."""
    figure, axis = figure_with((9, 5))
    for speed in SPEEDS_RAD_S:
        line = axis.plot(np.degrees(shape.angles), shape.torque(speed), label=f"{speed:g} rad/s")[0]
        axis.plot(np.degrees(shape.angles), fitted.torque(shape.angles, speed), "--", color=line.get_color())
    axis.set(xlabel="crank angle [deg]", ylabel="torque without arms and blades [N m]")
    axis.legend(fontsize=8)
    axis.grid(alpha=0.3)
    save(figure, path, 120)
