"""Channels on clocks of their own -> samples of equal distance on one clock."""

from typing import NamedTuple

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.failure import Failure
from hilplant.measurements.measurement import Channel, Native

#: A distance between samples beyond this many usual ones is a gap.
GAP_PERIODS = 1.5
#: No test of a wiper lasts longer; its time has another unit [s].
LONGEST_S = 10_000.0
#: Fewer samples than this are no channel, unless it is one that is sent when it changes.
FEWEST = 10
#: A channel this many times faster than the common clock is averaged over each step, not picked from.
AVERAGE_ABOVE = 1.5
#: Times are taken as those of equal distances when none is further from them than this part of the distance.
STEADY_PART, STEADY_SAMPLES = 0.3, 20
#: A value that comes so little behind a tick counts at it, in parts of the step: logs round, and frames wait.
HOLD_PART = 0.05
#: Clocks of instruments run differently by up to this part.
QUARTZ = 2e-4


class OnClock(NamedTuple):
    """A channel on the common clock; not `present` where its file had a gap or an empty cell."""

    values: Floats
    present: Flags
    native: Native


def checked(channel: Channel, place: str) -> tuple[Channel, Native]:
    """Return the channel without empty cells, and how it was sampled.

    Raises
    ------
    Failure
        When it has too few samples, or its time does not rise.

    """
    finite = np.isfinite(channel.values)
    kept = Channel(channel.time_s[finite], channel.values[finite], channel.unit, channel.held)
    if len(kept.values) < (1 if channel.held else FEWEST):
        raise Failure(f"{place}: has {len(kept.values)} numbers; too few for a measurement")
    steps = np.diff(kept.time_s)
    if (back := np.flatnonzero(steps < 0.0)).size:
        at = int(np.flatnonzero(finite)[back[0] + 1]) + 1
        raise Failure(f"{place}: the time runs backwards at sample {at}; cut the file there or sort it")
    period_s = float(np.median(steps)) if len(steps) else 0.0
    if period_s <= 0.0 and not channel.held:
        raise Failure(f"{place}: most samples have the same time; is the time column the right one?")
    period_s *= repeats(kept.values)
    return kept, Native(period_s, len(kept.values), int(np.count_nonzero(~finite)), float(np.max(steps, initial=0.0)))


def repeats(values: Floats) -> int:
    """Return how many times a logger wrote each value again: 10 where 100 Hz were written at 1 kHz; else 1."""
    changes = np.flatnonzero(np.diff(values) != 0.0)
    if len(changes) < 50:
        return 1  # a contact, or a supply that only steps
    distances = np.diff(changes)
    usual = int(np.median(distances))
    return usual if usual > 1 and float(np.mean(distances % usual == 0)) > 0.9 else 1


def shared_clock(channels: list[Channel], step_s: float, source: str) -> Floats:
    """Return the times [s] at which all channels have values, from where the last of them begins.

    One that is sent when it changes keeps its value to the end.

    Raises
    ------
    Failure
        When the channels do not overlap in time, or last too long.

    """
    start = max(channel.time_s[0] for channel in channels)
    end = min(channel.time_s[-1] for channel in [each for each in channels if not each.held] or channels)
    if end - start > LONGEST_S:
        text = f"{source}: the time goes on for {(end - start) / 3600.0:.3g} hours; if it has another unit, say"
        raise Failure(f"{text} --columns time=NAME[ms], or [us]; if not, cut the file")
    count = int(np.floor((end - start) / step_s + 1e-6)) + 1
    if count < 10:
        raise Failure(f"{source}: the channels share {max(0.0, end - start):.3g} s of time; that is no measurement")
    return np.asarray(start + np.arange(count) * step_s, np.float64)


def steadied(channel: Channel) -> Channel:
    """Return a channel whose samples are of equal distance with equal distances indeed.

    A frame waits for others on the bus, and a log rounds its times (an epoch in floats: to 2.4e-7 s); the sample itself
    was taken in time. Where all times lie near one straight line over their number, gaps counted, they are taken on it.
    """
    times = channel.time_s
    period_s = float(np.median(np.diff(times))) if len(times) > STEADY_SAMPLES else 0.0
    if period_s <= 0.0:
        return channel
    numbers = np.concatenate([[0.0], np.cumsum(np.round(np.diff(times) / period_s))])
    if numbers[-1] < STEADY_SAMPLES or np.any(np.diff(numbers) < 1.0):
        return channel
    slope, start = np.polyfit(numbers, times, 1)
    away = times - (start + slope * numbers)
    if np.max(np.abs(away)) > STEADY_PART * period_s:
        return channel
    return Channel(start + slope * numbers, channel.values, channel.unit, channel.held)


def own_clock(voltage: Channel, clock: Floats) -> Floats:
    """Return the clock moved onto the voltage's own samples, so that its steps stay steps.

    A voltage whose period is the clock's but for the error of a quartz gives that too, and no sample is met twice.
    """
    step_s, tolerance_s = clock[1] - clock[0], HOLD_PART * (clock[1] - clock[0])
    times = voltage.time_s
    first = min(int(np.searchsorted(times, clock[0] - tolerance_s)), len(times) - 1)
    own_s = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    if abs(own_s / step_s - 1.0) < QUARTZ:
        away = (times - times[0]) / own_s
        if np.max(np.abs(away - np.round(away))) < HOLD_PART:
            step_s = own_s
    count = int(np.floor((clock[-1] - times[first]) / step_s + HOLD_PART)) + 1
    return np.asarray(times[first] + np.arange(count) * step_s, np.float64)


def on_clock(channel: Channel, native: Native, clock: Floats, hold: bool) -> OnClock:
    """Bring a channel onto the clock: the last value where it holds, else a straight line or the mean of each step.

    The mean is taken over half a step to either side, so that it shifts nothing in time.
    """
    step_s = clock[1] - clock[0]
    places = np.searchsorted(channel.time_s, clock + HOLD_PART * step_s, side="right") - 1
    places = np.clip(places, 0, len(channel.values) - 1)
    if hold:
        values = channel.values[places]
    elif step_s > AVERAGE_ABOVE * native.period_s:
        values = _means(channel, clock, step_s)
    else:
        values = np.interp(clock, channel.time_s, channel.values)
    return OnClock(values, _present(channel, native, clock, places) | hold, native)


def _means(channel: Channel, clock: Floats, step_s: float) -> Floats:
    edges = np.searchsorted(channel.time_s, np.concatenate([clock - 0.5 * step_s, [clock[-1] + 0.5 * step_s]]))
    sums = np.concatenate([[0.0], np.cumsum(channel.values)])
    counts = np.diff(edges)
    means: Floats = np.diff(sums[edges]) / np.maximum(counts, 1)
    return np.asarray(np.where(counts > 0, means, np.interp(clock, channel.time_s, channel.values)), np.float64)


def _present(channel: Channel, native: Native, clock: Floats, places: Flags | Floats) -> Flags:
    """Say where the clock's times lie on a sample or between two that are not too far apart."""
    index = np.asarray(places, dtype=np.intp)
    following = np.minimum(index + 1, len(channel.values) - 1)
    apart = channel.time_s[following] - channel.time_s[index]
    near = np.minimum(clock - channel.time_s[index], channel.time_s[following] - clock)
    wide = apart > GAP_PERIODS * native.period_s
    return np.asarray(~wide | (np.abs(near) < 0.5 * native.period_s), dtype=np.bool_)
