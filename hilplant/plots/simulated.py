"""Draws what `simulate` has written, or any signals of a table or a recording, over time."""

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path

from hilplant.failure import Failure
from hilplant.measurements.files import Origin, read_channels
from hilplant.measurements.measurement import Channel
from hilplant.plots.picture import plain_figure, save

#: What is drawn when nothing is asked for: a panel each, with the signals in it; absent ones are left out.
PANELS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("voltage [V]", ("supply_v", "terminal_v")),
    ("current [A]", ("current_a",)),
    ("crank [rad]", ("crank_angle_rad",)),
    ("load torque [N m]", ("load_torque_n_m",)),
    ("crank speed [rad/s]", ("crank_speed_rad_s",)),
    ("arms [rad]", ("left_arm_rad", "right_arm_rad")),
    ("contacts", ("relay_on", "relay_fast", "park_contact")),
)
_COLORS = ("#0b5cad", "#d9730d", "#2a7f3e", "#b3261e")


def plot_simulated(path: str | PathLike[str], out: str | PathLike[str], signals: Sequence[str] = ()) -> None:
    """Draw a table over time.

    Parameters
    ----------
    path
        What `simulate` or `export` has written, or a recording.
    out
        The picture.
    signals
        A panel for each of these; without any, what is usual.

    Raises
    ------
    Failure
        When the file cannot be read, a signal is not in it, or the picture cannot be written.

    """
    channels = read_channels(Origin(Path(path)))
    panels = _asked(path, channels, signals) if signals else _usual(path, channels)
    figure, drawn = plain_figure((11, 1.6 * len(panels) + 0.9), len(panels), sharex=True)
    for axes, (label, names) in zip(drawn, panels, strict=True):
        for name, color in zip(names, _COLORS * len(names), strict=False):
            channel = channels[name]
            axes.plot(channel.time_s, channel.values, color=color, linewidth=0.9, label=name)
        axes.set_ylabel(label)
        if len(names) > 1:
            axes.legend(loc="upper right", frameon=False, fontsize=8, ncols=3)
    drawn[-1].set_xlabel("time [s]")
    figure.align_ylabels(drawn)
    figure.suptitle(Path(path).name, parse_math=False)
    save(figure, out, 110)


def _usual(path: str | PathLike[str], channels: Mapping[str, Channel]) -> list[tuple[str, tuple[str, ...]]]:
    found = [(label, tuple(name for name in names if name in channels)) for label, names in PANELS]
    kept = [(label, names) for label, names in found if names]
    if not kept:
        raise Failure(f"{path}: has none of the usual signals; say --signal with one of {', '.join(channels)}")
    return kept


def _asked(
    path: str | PathLike[str], channels: Mapping[str, Channel], signals: Sequence[str]
) -> list[tuple[str, tuple[str, ...]]]:
    for name in signals:
        if name not in channels:
            raise Failure(f"{path}: has no signal '{name}'; it has {', '.join(channels)}")
    return [(name, (name,)) for name in signals]
