"""Pictures of the control study, as Figures 7-3 to 7-18 of Dooner (2016) show theirs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from hilplant.arrays import Floats
from hilplant.control.fuzzy_sets import GREATEST_ERROR_RAD_S, degrees_of_membership, fuzzy_gain_at, gain_shapes
from hilplant.plots.picture import save


class DrawnRun(Protocol):
    """A run as it is drawn: its columns by name, each a value a tick."""

    @property
    def time_s(self) -> Floats:
        """Time of each tick [s]."""

    @property
    def reference_rad_s(self) -> Floats:
        """Wanted crank speed [rad/s]."""

    def __getitem__(self, name: str) -> Floats:
        """Return an output or input."""


#: From when to when [s] something holds.
Spans = Sequence[tuple[float, float]]

_COLOURS = ("#0b5cad", "#d9730d", "#2a7f3e", "#b3261e")
_GREY = "#6b7280"


def _figure(rows: int, height: float) -> tuple[Any, Any]:
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to load
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.5, height))
    figure.subplots_adjust(0.07, 0.55 / height, 0.98, 1.0 - 0.45 / height, hspace=0.9 / height + 0.12)
    FigureCanvasAgg(figure)
    panels = figure.subplots(rows, 1, squeeze=False)[:, 0]
    for axes in panels:
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure, panels


def plot_runs(path: Path, title: str, runs: Mapping[str, DrawnRun], dry: Spans, gains: bool = False) -> None:
    """Draw speed and voltage of some controllers through a test with a `dry` screen at times; with `gains`, K below."""
    figure, panels = _figure(3 if gains else 2, 7.0 if gains else 5.2)
    for colour, (name, run) in zip(_COLOURS, runs.items(), strict=False):
        for axes, column in zip(panels, ("crank_speed_rad_s", "supply_v", "gain"), strict=False):
            axes.plot(run.time_s[::4], run[column][::4], color=colour, linewidth=0.9, label=name)
    first = next(iter(runs.values()))
    panels[0].plot(first.time_s, first.reference_rad_s, color="black", linewidth=0.9, linestyle="--", label="reference")
    panels[0].legend(loc="lower right", ncols=4, frameon=False, fontsize=8)
    panels[0].set_ylim(0.0, 5.6)
    for axes, label in zip(panels, ("crank speed [rad/s]", "voltage [V]", "K"), strict=False):
        axes.set_ylabel(label)
        for begin_s, end_s in dry:
            axes.axvspan(begin_s, end_s, color="#f3ead7", linewidth=0.0, zorder=0)
    panels[-1].set_xlabel("time [s]; shaded: dry screen")
    figure.suptitle(title)
    save(figure, path, 90)


def plot_fuzzy(path: Path) -> None:
    """Draw the sets of error and K, and what follows: K over the error; Figures 7-9 and 7-10."""
    figure, (inputs, outputs, result) = _figure(3, 7.5)
    errors = np.linspace(-GREATEST_ERROR_RAD_S, GREATEST_ERROR_RAD_S, 601)
    for name, degree in degrees_of_membership(errors).items():
        inputs.plot(errors, degree)
        inputs.annotate(name, (errors[np.argmax(degree)], 1.02), ha="center", fontsize=8)
    inputs.set_xlabel("error [rad/s]")
    gains = np.linspace(0.0, 1.0, 401)
    for name, shape in gain_shapes(gains).items():
        outputs.plot(gains, shape, label=name)
    outputs.set_xlabel("K")
    outputs.legend(frameon=False, fontsize=8)
    result.plot(errors, fuzzy_gain_at(errors), color=_COLOURS[0])
    result.set_xlabel("error [rad/s]")
    result.set_ylabel("K")
    figure.suptitle("Fuzzy sets of the error, of K, and K over the error (compare Figures 7-9, 7-10)")
    save(figure, path, 90)


def plot_estimates(
    path: Path, time_s: Floats, speed_rad_s: Floats, estimates: Mapping[str, Floats], nominal: str = ""
) -> None:
    """Draw the true speed, what each estimator says, and the errors; as Figures 7-16 and 7-17.

    `nominal` is the brush of a plant as the estimators believe it; without it, its resistance is 20 % off.
    """
    figure, (top, bottom) = _figure(2, 5.5)
    top.plot(time_s[::5], speed_rad_s[::5], color="black", linewidth=0.9, label="true")
    widths = (2.2, 0.9, 0.7)  # network and observer lie upon each other
    for colour, width, (name, values) in zip(_COLOURS, widths, estimates.items(), strict=False):
        top.plot(time_s[::5], values[::5], color=colour, linewidth=width, label=name)
        bottom.plot(time_s[::5], (values - speed_rad_s)[::5], color=colour, linewidth=width)
    top.legend(loc="upper center", frameon=False, fontsize=8, ncols=4)
    top.margins(y=0.18)
    top.set_ylabel("crank speed [rad/s]")
    bottom.set_ylabel("error [rad/s]")
    bottom.set_ylim(-1.0, 1.0)
    bottom.set_xlabel("time [s]" + ("" if nominal else "; the plant's resistance is 20 % above the believed one"))
    figure.suptitle(f"Speed from voltage and current, {nominal or 'slow'} brush, voltage from 3 to 20 V")
    save(figure, path, 90)


def plot_stages(path: Path, run: DrawnRun) -> None:
    """Draw the continuous speed from two brushes: reference, speed, voltage, brush; as Figure 7-18 decides."""
    figure, panels = _figure(3, 6.5)
    panels[0].plot(run.time_s, run.reference_rad_s, "k--", linewidth=0.9, label="reference")
    for axes, column, label in zip(
        panels, ("crank_speed_rad_s", "supply_v", "relay_fast"), ("crank speed [rad/s]", "voltage [V]", "fast brush"),
        strict=True,
    ):  # fmt: skip
        axes.plot(run.time_s, run[column], color=_COLOURS[0], linewidth=0.9)
        axes.set_ylabel(label)
    panels[0].legend(["reference", "cascade"], loc="lower center", ncols=2, frameon=False, fontsize=8)
    panels[1].axhline(18.0, color=_GREY, linestyle=":")
    panels[2].set_yticks([0, 1], ["no", "yes"])
    panels[-1].set_xlabel("time [s]")
    figure.suptitle("Continuous speed: slow brush, fast above 18 V and back (section 7.6)")
    save(figure, path, 90)


def plot_all(
    folder: Path, runs: Mapping[str, DrawnRun], dry: Spans, groups: Sequence[tuple[str, str, Sequence[str]]]
) -> None:
    """Draw each group (file name, title, names of runs) into the folder."""
    for name, title, members in groups:
        plot_runs(folder / f"{name}.png", title, {m: runs[m] for m in members}, dry, "fuzzy" in name)
