"""A moving picture of the wiper, as a GIF: from a recording, or from what `simulate` has written (Figure 4-33)."""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.atomic_write import cannot_be_written
from hilplant.failure import Failure
from hilplant.measurements.files import Origin, read_channels
from hilplant.mechanics.motion import motion
from hilplant.mechanics.wiper import Wiper
from hilplant.plots.picture import figure_with
from hilplant.plots.positions import draw_area, draw_wiper
from hilplant.progress import OnProgress, ProgressReport, unseen
from hilplant.units import TURN_RAD

MOST_FRAMES = 3000


class Film(NamedTuple):
    """What part of a run is shown [s], None to its end; frames a second, and how much faster than real."""

    from_s: float = 0.0
    to_s: float | None = None
    frames_a_second: float = 20.0
    times_faster: float = 1.0


def crank_angles(path: Path, film: Film) -> tuple[Floats, Floats]:
    """Return the time [s] and the crank angle [rad] of each frame.

    Raises
    ------
    Failure
        When the file has no crank angle, or nothing or too much of it would be shown.

    """
    channels = read_channels(Origin(path))
    if "crank_angle_rad" not in channels:
        raise Failure(f"{path}: has no crank_angle_rad; a recording or what simulate has written is wanted")
    angle = channels["crank_angle_rad"]
    last_s = float(angle.time_s[-1]) if film.to_s is None else min(film.to_s, float(angle.time_s[-1]))
    count = int((last_s - film.from_s) * film.frames_a_second / film.times_faster + 1e-9) + 1
    if last_s <= film.from_s:
        raise Failure(f"{path}: nothing between {film.from_s:g} and {last_s:g} s")
    if count > MOST_FRAMES:
        raise Failure(f"{path}: {count} frames are more than {MOST_FRAMES}; show less of it, or faster")
    time_s = film.from_s + np.arange(count, dtype=np.float64) * film.times_faster / film.frames_a_second
    whole = np.interp(time_s, angle.time_s, np.unwrap(angle.values, period=TURN_RAD))
    return time_s, np.asarray(np.remainder(whole, TURN_RAD), dtype=np.float64)


def write_animation(path: Path, wiper: Wiper, out: Path, film: Film, on_progress: OnProgress = unseen) -> int:
    """Write the moving picture; return how many frames it has.

    Raises
    ------
    Failure
        As :func:`crank_angles`, and when the picture cannot be written.

    """
    from matplotlib.animation import PillowWriter

    time_s, crank_rad = crank_angles(path, film)
    turn = motion(wiper, np.linspace(0.0, TURN_RAD, 181))
    moving = motion(wiper, crank_rad)
    figure, axes = figure_with((7.0, 4.6))
    draw_area(axes, wiper, turn)
    draw_wiper(axes, wiper, moving.coordinates[0])
    limits = axes.get_xlim(), axes.get_ylim()
    writer = PillowWriter(fps=film.frames_a_second)  # type: ignore[arg-type]  # frames a second need not be whole
    try:
        with writer.saving(figure, str(out), 80):
            for index, coordinates in enumerate(moving.coordinates):
                for line in [line for line in axes.lines if line.get_zorder() > 2.5]:
                    line.remove()
                draw_wiper(axes, wiper, coordinates)
                axes.set(xlim=limits[0], ylim=limits[1], xlabel="x [cm]", ylabel="y [cm]")
                axes.set_title(f"{path.name}: {time_s[index]:.2f} s, crank {np.degrees(crank_rad[index]):.0f}°")
                writer.grab_frame()
                on_progress(ProgressReport("frames", index + 1, len(time_s)))
    except OSError as error:
        raise cannot_be_written(out, error) from error
    return len(time_s)
