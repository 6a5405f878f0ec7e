"""Draws what each model of load and motor costs, and how far its current is off."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from hilplant.plots.picture import figure_with, save

#: Offsets of labels, in points from the mark, that would lie on each other otherwise.
_LABELS = {"none": (-14, -18), "own polynomial": (8, -14), "torque network": (-70, 10), "all networks": (-20, -18)}
#: Shape of the mark by what a name contains; a circle for the others.
_MARKS = {"polynomial": "s", "network": "D"}


class Mark(NamedTuple):
    """A model: what a step costs [ns], and the RMS error of its current over a minute [A]."""

    name: str
    step_ns: float
    current_rms_a: float


def plot_surrogates(marks: Sequence[Mark], goal_a: float, path: Path) -> None:
    """Draw accuracy against cost; `goal_a` is 3 % of the current's range [A]."""
    figure, axis = figure_with((8, 5))
    for one in marks:
        kind = next((word for word in _MARKS if word in one.name), "")
        axis.plot(one.step_ns, one.current_rms_a, _MARKS.get(kind, "o"), markersize=8, label=one.name)
        at, offset = (one.step_ns, one.current_rms_a), _LABELS.get(one.name, (8, 4))
        axis.annotate(one.name, at, xytext=offset, textcoords="offset points")
    axis.axhline(goal_a, color="grey", linestyle="--", linewidth=1.0)
    axis.annotate("3 % of the range", (0.98, goal_a), xycoords=("axes fraction", "data"), ha="right", va="bottom")
    axis.set(yscale="log", xlabel="cost of a step [ns]", ylabel="RMS error of the current over a minute [A]")
    axis.set_xlim(0.0, 1.2 * max(one.step_ns for one in marks))
    axis.grid(visible=True, which="both", alpha=0.3)
    axis.set_title("Lower left is better: circles are physics, squares polynomials, diamonds networks")
    save(figure, path, 120)
