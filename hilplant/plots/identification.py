"""The pictures of the report, as PNG in a data URI."""

import base64
import io
from typing import Any

import numpy as np

from hilplant.identify.genetic import Outcome
from hilplant.identify.three_stages import Identified
from hilplant.identify.uncertainty import correlation
from hilplant.identify.validation import Comparison
from hilplant.plots.picture import figure_with

_MEASURED, _SIMULATED, _RESIDUAL = "#9aa5b1", "#c2410c", "#1d4ed8"


def _uri(figure: Any) -> str:
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=110)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode("ascii")


def run_picture(comparison: Comparison) -> str:
    """Draw measured and simulated current, what is left between them, and the park steps."""
    run = comparison.run
    figure, (current, residual, steps) = figure_with((10.0, 6.2), 3, sharex=True, height_ratios=(3, 1.4, 1.1))
    time_s = run.time_s
    current.plot(time_s, np.where(run.valid, run.current_a, np.nan), color=_MEASURED, lw=1.6, label="measured")
    current.plot(time_s, comparison.simulated_a, color=_SIMULATED, lw=0.9, label="simulated")
    current.set_ylabel("current [A]")
    current.legend(loc="upper right", frameon=False)
    errors = np.where(run.valid, run.current_a - comparison.simulated_a, np.nan)
    residual.plot(time_s, errors, color=_RESIDUAL, lw=0.6)
    residual.axhline(0.0, color="black", lw=0.6)
    residual.set_ylabel("difference [A]")
    steps.plot(time_s, run.park_steps, color=_MEASURED, lw=2.0, drawstyle="steps-post")
    steps.plot(time_s, comparison.park_steps, color=_SIMULATED, lw=1.0, ls="--", drawstyle="steps-post")
    steps.set_ylabel("park steps")
    steps.yaxis.get_major_locator().set_params(integer=True)
    steps.set_xlabel("time [s]")
    for axes in (current, residual, steps):
        axes.grid(alpha=0.25)
    return _uri(figure)


def convergence_picture(outcome: Outcome) -> str:
    """Draw the lowest and the mean cost of the search over its evaluations."""
    figure, axes = figure_with((10.0, 3.0))
    evaluations = [seen.evaluations for seen in outcome.history]
    axes.semilogy(evaluations, [seen.mean for seen in outcome.history], color=_MEASURED, lw=1.2, label="mean")
    axes.semilogy(evaluations, [seen.best for seen in outcome.history], color=_SIMULATED, lw=1.6, label="lowest")
    axes.set_xlabel("evaluations")
    axes.set_ylabel("cost (5.26)")
    axes.legend(frameon=False)
    axes.grid(alpha=0.25, which="both")
    return _uri(figure)


def correlation_picture(found: Identified) -> str:
    """Draw the correlation of the parameters."""
    figure, axes = figure_with((8.2, 6.4))
    names = [verdict.name for verdict in found.verdicts]
    image = axes.imshow(correlation(found.solution, found.known), vmin=-1.0, vmax=1.0, cmap="RdBu_r")
    axes.set_xticks(range(len(names)), names, rotation=60, ha="right", fontsize=8)
    axes.set_yticks(range(len(names)), names, fontsize=8)
    figure.colorbar(image, ax=axes, shrink=0.8, label="correlation")
    return _uri(figure)
