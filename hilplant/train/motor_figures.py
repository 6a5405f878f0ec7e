"""How well a motor network does on its own data, as Table 6-3 of Dooner (2016) puts it, and how long it took."""

from dataclasses import dataclass

import numpy as np

from hilplant.train.motor_fit import TrainedPath, part_errors

PARTS = ("train", "validate", "test", "total")
#: Rows of Table 6-3: mean squared errors of the parts, and seconds.
THESIS = {
    "open loop, open results": (0.0040, 2.5e-4, 0.0049, 0.0036, 97.0),
    "open loop, closed results": (0.0784, 0.0237, 0.0591, 0.0673, None),
    "closed loop": (0.0068, 0.0038, 0.0094, 0.0068, 7 * 3600.0 + 19 * 60.0),
}
GOAL_MSE, GOAL_S = 0.003, 180.0


@dataclass(frozen=True, slots=True)
class ErrorLine:
    """One row of Table 6-3: errors by part, over current [A] and crank speed [rad/s] of both brushes alike."""

    name: str
    errors: tuple[float, float, float, float]
    seconds: float | None


def lines(paths: list[TrainedPath]) -> list[ErrorLine]:
    """Return the three rows."""
    open_s, closed_s = (sum(path.seconds[stage] for path in paths) for stage in (0, 1))
    return [
        ErrorLine("open loop, open results", _errors(paths, False, False), open_s),
        ErrorLine("open loop, closed results", _errors(paths, True, False), None),
        ErrorLine("closed loop", _errors(paths, True, True), closed_s),
    ]


def _errors(paths: list[TrainedPath], closed: bool, after_closed: bool) -> tuple[float, float, float, float]:
    """Return the mean over both outputs of both paths, in train, validate, test and all of them."""
    found = []
    for path in paths:
        errors = path.errors(closed, after_closed)
        parts = (*path.sequence.parts(), path.sequence.predicted)
        found.append([float(part_errors(errors, part).mean()) for part in parts])
    first, second, third, total = np.mean(found, axis=0).tolist()
    return first, second, third, total


def path_figures(path: TrainedPath) -> dict[str, dict[str, float]]:
    """Return what stands in the file: errors by part in closed loop, the variance beside them, and share explained.

    Only ticks that the network answers for count: where the physical model is active there is no error.
    """
    errors = path.errors(True)
    figures: dict[str, dict[str, float]] = {}
    for name, part in zip(PARTS, (*path.sequence.parts(), path.sequence.predicted), strict=True):
        squares, variances = part_errors(errors, part), path.sequence.outputs[part].var(axis=0)
        figures[name] = {
            "ticks": int(part.sum()),
            "current_mse_a2": _rounded(squares[0]),
            "current_variance_a2": _rounded(variances[0]),
            "current_explained": _rounded(1.0 - squares[0] / variances[0]),
            "current_worst_a": _rounded(np.abs(errors[part, 0]).max()),
            "crank_speed_mse_rad2_s2": _rounded(squares[1]),
            "crank_speed_variance_rad2_s2": _rounded(variances[1]),
            "crank_speed_explained": _rounded(1.0 - squares[1] / variances[1]),
            "crank_speed_worst_rad_s": _rounded(np.abs(errors[part, 1]).max()),
        }
    return figures


def table(paths: list[TrainedPath]) -> str:
    """Return the rows beside those of the thesis, with the variances that the errors are to be held against."""
    title = "mean squared error over current [A] and crank speed [rad/s] of both brushes, ours (Table 6-3)"
    rows = [title, f"{'':28}" + "".join(f"{part:>22}" for part in PARTS) + f"{'time':>22}"]
    for line in lines(paths):
        printed = THESIS[line.name]
        cells = [f"{ours:.2e} ({theirs:.4f})" for ours, theirs in zip(line.errors, printed[:4], strict=True)]
        if line.seconds is not None:
            cells.append(f"{line.seconds:.1f} s ({printed[4]:.0f} s)")
        rows.append(f"{line.name:28}" + "".join(f"{cell:>22}" for cell in cells))
    for path in paths:
        figures = path_figures(path)["total"]
        rows.append(
            f"{path.brush}: current variance {figures['current_variance_a2']:.3g} A2, explained "
            f"100 % less {100.0 * (1.0 - figures['current_explained']):.1g} %; crank speed variance "
            f"{figures['crank_speed_variance_rad2_s2']:.3g} (rad/s)2, explained "
            f"100 % less {100.0 * (1.0 - figures['crank_speed_explained']):.1g} %"
        )
    return "\n".join(rows)


def _rounded(number: float) -> float:
    return float(f"{number:.8g}")
