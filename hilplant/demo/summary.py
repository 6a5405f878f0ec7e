"""The last words of the demonstration: what the wiper did, how punctual the loop was, what to try next."""

import math
from pathlib import Path

from hilplant.demo.figures import Figures, SpeedFigures, Stop, figures
from hilplant.extras import missing, remedy
from hilplant.plots.recording import plot_recording
from hilplant.recording.export import signal_columns
from hilplant.recording.reader import read_recording
from hilplant.runtime.server import Summary

_NEXT = (
    ("hilplant replay {recording}", "the same inputs again, compared bit for bit"),
    ("hilplant export {recording} demo.blf", "as .blf, .asc, .csv, .parquet or .mf4, by the ending"),
    ("hilplant doctor", "what would make this machine more punctual"),
    ("hilplant run --channel vcan0", "the plant on SocketCAN, for an ECU of your own"),
    ("hilplant ecu --channel vcan0", "a stand-in for an ECU, in a second terminal"),
)


def summarise(run: Summary, recording: Path, plot: Path) -> list[str]:
    """Draw the recording, where that is possible, and return lines that say what it shows."""
    columns, _ = signal_columns(read_recording(recording))
    drawn = str(plot)
    if missing("plot"):
        drawn = f"none without matplotlib: {remedy('plot')}"
    else:
        plot_recording(recording, plot)
    lines = [*wiping_lines(figures(columns)), *loop_lines(run)]
    lines += [f"recording     {recording}", f"plot          {drawn}", "", "next:"]
    return lines + [
        line for command, what in _NEXT for line in (f"  # {what}", f"  {command.format(recording=recording)}")
    ]


def wiping_lines(found: Figures) -> list[str]:
    """Say what the wiper did."""
    lines = [f"wipes         {found.wipes}"]
    lines += [
        _speed_line(name, speed)
        for name, speed in (("slow", found.slow), ("fast", found.fast))
        if not math.isnan(speed.peak_current_a)
    ]
    return lines + [_stop_line(stop) for stop in found.stops]


def loop_lines(run: Summary) -> list[str]:
    """Say how the loop fared."""
    return [
        f"loop          {run.ticks} ticks, {run.overruns} overruns",
        f"ticks late by {run.latency_p50_us:.0f} us (median), {run.latency_p99_us:.0f} us (p99), "
        f"{run.latency_max_us:.0f} us (worst)",
    ]


def _speed_line(name: str, speed: SpeedFigures) -> str:
    return (
        f"{name:<14}{speed.cycles_per_min:.1f} cycles/min, current {speed.mean_current_a:.2f} A mean, "
        f"{speed.peak_current_a:.2f} A peak"
    )


def _stop_line(stop: Stop) -> str:
    where = "contact closed" if stop.in_park else "contact open"
    return f"park stop     at {stop.time_s:6.2f} s, {stop.angle_deg:+.1f} deg from park, {where}"
