"""Draws measurements: the data of Figure 5-5, park pulses and stairs (5-2, 5-3), stage 1 (5-7 to 5-11)."""

from collections.abc import Sequence
from os import PathLike

import numpy as np

from hilplant.identify.stage_one_signals import ModeSignals
from hilplant.identify.transfer_answers import TransferAnswer
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.park import turn_speeds
from hilplant.measurements.park_cases import NEVER, SLOWER, ParkCase
from hilplant.plots.picture import plain_figure, save

_BLUE, _ORANGE, _GREEN, _RED, _GREY = "#0b5cad", "#d9730d", "#2a7f3e", "#b3261e", "#6b7280"


def plot_measurement(data: Measurement, out: str | PathLike[str]) -> None:
    """Draw voltage, current, park contact with its stairs, mode, and the speed of each turn: Figure 5-5."""
    figure, (voltage, current, park, speed) = plain_figure((11, 8.5), 4, sharex=True)
    voltage.plot(data.time_s, data.voltage_v, color=_BLUE)
    voltage.set_ylabel("voltage [V]")
    current.plot(data.time_s, np.where(data.valid, data.current_a, np.nan), color=_RED, linewidth=0.8)
    current.set_ylabel("current [A]")
    park.plot(data.time_s, data.park_steps, color=_GREEN, drawstyle="steps-post", label="park steps")
    park.plot(data.time_s, data.park, color=_GREY, drawstyle="steps-post", linewidth=0.9, label="park contact")
    if not np.all(np.isnan(data.fast)):
        park.plot(data.time_s, data.fast, color=_ORANGE, drawstyle="steps-post", label="fast")
    park.legend(loc="upper left", frameon=False, ncols=3, fontsize=8)
    park.set_ylabel("contacts")
    middles, speeds = turn_speeds(data.park, data.time_s)
    speed.plot(middles, speeds, "o-", color=_GREEN, markersize=3)
    speed.set_ylabel("crank, mean of\neach turn [rad/s]")
    speed.set_ylim(0.0, 1.1 * max(speeds, default=1.0))
    speed.set_xlabel("time [s]")
    figure.align_ylabels()
    figure.suptitle(f"{data.source}: {data.time_s[-1]:.4g} s, {1.0 / data.period_s:.4g} Hz", parse_math=False)
    save(figure, out, 110)


def plot_staircase(data: Measurement, cases: Sequence[ParkCase], out: str | PathLike[str]) -> None:
    """Draw pulses and stairs of the measurement and of each case, with the errors of both."""
    figure, panels = plain_figure((12, 8), len(cases), 2, sharex=True)
    for (pulses, stairs), case in zip(panels, cases, strict=True):
        told = "at rest" if case.name == NEVER else f"{100.0 * SLOWER[case.name]:g} % slower"
        for axes, measured, simulated, error in (
            (pulses, data.park, case.pulses, case.pulse_error),
            (stairs, data.park_steps, case.stairs, case.stair_error),
        ):
            axes.plot(data.time_s, measured, color=_BLUE, drawstyle="steps-post", label="measured")
            axes.plot(data.time_s, simulated, color=_ORANGE, linestyle="--", drawstyle="steps-post", label="simulated")
            axes.set_title(f"case {case.name}, {told}: mean error {error:.3g}", fontsize=10, loc="left")
    panels[0, 0].set_ylabel("pulses, Figure 5-2")
    panels[0, 1].set_ylabel("stairs, Figure 5-3")
    panels[0, 1].legend(frameon=False, fontsize=9)
    for axes in panels[-1]:
        axes.set_xlabel("time [s]")
    figure.suptitle(f"{data.source}: the park contact as pulses and as stairs", parse_math=False)
    save(figure, out, 110)


def plot_stage_one(found: Sequence[ModeSignals], out: str | PathLike[str], source: str) -> None:
    """Draw each mode: data raw and filtered (5-8, 5-9), and the transfer function's answer (5-10, 5-11)."""
    figure, panels = plain_figure((7.5 * len(found), 9), 3, len(found), sharex="col")
    for column, each in zip(np.reshape(panels, (3, len(found))).T, found, strict=True):
        voltage, current, answer = column
        voltage.plot(each.time_s, each.voltage_v, color=_BLUE, linewidth=0.8, label="raw")
        voltage.plot(each.time_s, each.filtered_v, color=_RED, linewidth=0.8, label="behind the filter")
        current.plot(each.time_s, each.current_a, color=_BLUE, linewidth=0.6)
        current.plot(each.time_s, each.filtered_a, color=_RED, linewidth=0.8)
        answer.plot(each.time_s, each.current_a, color=_BLUE, linestyle=":", linewidth=0.8, label="measured")
        label = f"transfer function, {each.rms_a:.3g} A rms"
        answer.plot(each.time_s, each.answer_a, color=_ORANGE, linewidth=0.9, label=label)
        function = each.result.fit.function
        text = f"({function.b1:.4g} s + {function.b0:.4g}) / (s² + {function.a1:.4g} s + {function.a0:.4g})"
        voltage.set_title(f"{each.mode}: {text}", fontsize=9)
        for axes, label in ((voltage, "voltage [V]"), (current, "current [A]"), (answer, "current [A]")):
            axes.set_ylabel(label)
        voltage.legend(frameon=False, fontsize=8)
        answer.legend(frameon=False, fontsize=8)
        answer.set_xlabel("time [s]")
    figure.suptitle(f"{source}: stage 1 (compare Figures 5-8 to 5-11)", parse_math=False)
    save(figure, out, 110)


def plot_transfer_answers(found: Sequence[TransferAnswer], out: str | PathLike[str], title: str) -> None:
    """Draw the plant's current and that of (5.7), a brush a panel, with their difference: Figure 5-7."""
    figure, panels = plain_figure((11, 7), 2, len(found), sharex=True)
    for column, each in zip(panels.T, found, strict=True):
        column[0].plot(each.time_s, each.plant_a, color=_BLUE, label="equations (3.30), (3.31)")
        column[0].plot(each.time_s, each.answer_a, color=_ORANGE, linestyle="--", label="transfer function (5.7)")
        column[0].set_title(f"{each.brush} brush", fontsize=10)
        column[0].set_ylabel("current [A]")
        column[1].plot(each.time_s, each.answer_a - each.plant_a, color=_RED)
        column[1].set(ylabel="difference [A]", xlabel="time [s]")
    panels[0, 0].legend(loc="center", frameon=False, fontsize=8)
    figure.suptitle(title, parse_math=False)
    save(figure, out, 110)
