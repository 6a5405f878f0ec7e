"""Pictures of a motor network: Figures 6-15 to 6-18 of Dooner (2016), and its errors over load and supply."""

from pathlib import Path

import numpy as np

from hilplant.arrays import Floats
from hilplant.plots.picture import figure_with, save
from hilplant.train.motor_compare import Grid
from hilplant.train.motor_fit import TrainedPath


def plot_paths(paths: tuple[TrainedPath, ...], path: Path) -> None:
    """Draw current and crank speed of the test part, true and in closed loop, with the errors below."""
    figure, axes = figure_with((12, 9), 4, 2, sharex="col")
    for column, trained in enumerate(paths):
        errors, true = trained.errors(True), trained.sequence.outputs
        place = np.flatnonzero(trained.sequence.parts()[2])
        shown = slice(place[0], place[-1] + 1)
        seconds = np.arange(len(true))[shown] * 1e-3
        for row, name in enumerate(("current [A]", "crank speed [rad/s]")):
            upper, lower = axes[2 * row, column], axes[2 * row + 1, column]
            upper.plot(seconds, true[shown, row], label="physical")
            upper.plot(seconds, (true + errors)[shown, row], "--", label="network, closed loop")
            upper.set(ylabel=name, title=f"{trained.brush} brush, test part" if row == 0 else "")
            lower.plot(seconds, errors[shown, row], color="tab:red", linewidth=0.8)
            lower.set(ylabel=f"error of\n{name}")
        axes[3, column].set_xlabel("time [s]")
    axes[0, 0].legend()
    save(figure, path, 110)


def plot_grid(grid: Grid, path: Path) -> None:
    """Draw the RMS error of the current over supply and brake, a panel for each brush and screen."""
    most = max(float(np.nanmax(values)) for values in grid.current_rms_a.values())
    figure, axes = figure_with((14, 3.6), 1, len(grid.current_rms_a), sharey=True)
    for axis, (name, values) in zip(axes, grid.current_rms_a.items(), strict=True):
        places = _edges(grid.brakes_n_m), _edges(grid.supplies_v)
        shown = axis.pcolormesh(*places, 1e3 * values, vmin=0.0, vmax=1e3 * most)
        axis.set(title=name, xlabel="brake [N m]")
    axes[0].set_ylabel("supply [V]")
    figure.colorbar(shown, ax=axes, label="RMS error of the current [mA]")
    save(figure, path, 110)


def _edges(values: Floats) -> Floats:
    middles = 0.5 * (values[1:] + values[:-1])
    first, last = 2.0 * values[0] - middles[0], 2.0 * values[-1] - middles[-1]
    edges: Floats = np.concatenate([[first], middles, [last]])
    return edges
