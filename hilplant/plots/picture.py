"""What all pictures share: a figure with its panels, without a window, and one way to write it."""

from os import PathLike
from pathlib import Path
from typing import Any

from hilplant.atomic_write import cannot_be_written


def figure_with(size: tuple[float, float], rows: int = 1, columns: int = 1, **panels: Any) -> tuple[Any, Any]:
    """Return a figure of a size [inch] and its panels; one alone is not an array."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # slow to load
    from matplotlib.figure import Figure

    figure = Figure(figsize=size, layout="constrained")
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, **panels)


def plain_figure(size: tuple[float, float], rows: int = 1, columns: int = 1, **panels: Any) -> tuple[Any, Any]:
    """Return the same with a light grid and no frame on top and right of each panel."""
    figure, made = figure_with(size, rows, columns, squeeze=False, **panels)
    for axes in made.ravel():
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure, made if columns > 1 else made[:, 0]


def save(figure: Any, path: str | PathLike[str], dpi: int) -> None:
    """Write a figure.

    Raises
    ------
    Failure
        When the file cannot be written.

    """
    try:
        figure.savefig(path, dpi=dpi)
    except OSError as error:
        raise cannot_be_written(Path(path), error) from error
