"""Pictures of a motor network: Figures 6-15 to 6-18 of Dooner (2016), and its errors over load and supply."""

from os import PathLike
from pathlib import Path

import numpy as np

from hilplant.arrays import Floats
from hilplant.plots.picture import figure_with, save
from hilplant.train.bare_network import BareRun
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


def plot_bare_run(found: BareRun, path: str | PathLike[str]) -> None:
    """Draw the network alone, the guarded one and the physical motor, with the guard below: Figure 6-23."""
    figure, (current, speed, guard) = figure_with((11, 8), 3, sharex=True, height_ratios=(3, 3, 1))
    looks = {"physical": ("#1f2937", "-", 2.0), "guarded": ("#0b5cad", "--", 1.2), "bare": ("#b3261e", "-", 1.0)}
    for axes, curves, label in (
        (current, found.current_a, "current [A]"),
        (speed, found.speed_rad_s, "crank speed [rad/s]"),
    ):
        for name, (color, line, width) in looks.items():
            axes.plot(found.time_s, curves[name], color=color, linestyle=line, linewidth=width, label=name)
        usual = np.concatenate([curves["physical"], curves["guarded"]])
        reach = 1.5 * float(np.ptp(usual))
        axes.set_ylim(float(usual.min()) - reach, float(usual.max()) + reach)
        axes.set_ylabel(label)
        axes.grid(alpha=0.25)
    current.legend(loc="upper left", frameon=False, ncols=3)
    guard.fill_between(found.time_s, found.active, step="post", color="#0b5cad", alpha=0.5)
    guard.set(
        ylabel="network\nasked",
        yticks=[0, 1],
        xlabel="time [s]; off from 5.2 to 5.8 s, 25 V from 6.5 to 7.5 s, else 16 V",
    )
    figure.suptitle(
        "A motor network under a constant torque, off and at 25 V: alone (bare), guarded, and the physical motor"
    )
    save(figure, path, 110)
