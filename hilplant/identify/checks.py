"""What is wrong with a measurement, in words that say what to do; good data give no word at all.

Each check looks for one mistake that people make with a supply, a current clamp and a logger.
"""

from collections.abc import Callable, Iterable

import numpy as np

from hilplant.failure import Failure
from hilplant.identify.alignment import voltage_steps
from hilplant.identify.measurement import Finding, Mask, Measurement, Samples
from hilplant.identify.park import rising_edges

#: A wiper motor at work shows V/I between about its resistance (blocked) and some ten ohms (no load) [ohm].
LOWEST_OHM, HIGHEST_OHM = 0.15, 60.0
#: The electrical time constant of a wiper motor is 2 to 10 ms; slower sampling does not see it [s].
SLOWEST_PERIOD_S, WISHED_PERIOD_S = 0.005, 0.002
#: A turn of the crank takes 0.5 to 1.5 s at work.
LONGEST_TURN_S = 5.0
#: Voltages that differ by this part of the highest are two levels.
LEVEL_PART = 0.04


def examine(data: Measurement) -> list[Finding]:
    """Return everything that is wrong with a measurement that is meant for identification.

    Where the columns or units are wrong, nothing else is said: it would only follow from that.
    """
    for check in (swapped, wrong_unit):
        if gross := list(check(data)):
            return gross
    checks: tuple[Callable[[Measurement], Iterable[Finding]], ...] = (slow_sampling, clipped, park_edges, levels, gaps)
    return [found for check in checks for found in check(data)]


def refuse(data: Measurement) -> list[Finding]:
    """Refuse data that are fatally wrong; return what else is to be known.

    Raises
    ------
    Failure
        With one line for each fatal finding.

    """
    found = examine(data)
    if fatal := [finding for finding in found if finding.fatal]:
        raise Failure("\n".join(f"{data.source or 'data'}: {finding.text}" for finding in fatal))
    return found


def running(data: Measurement) -> Mask:
    """Say where the motor is on: the terminal voltage above a tenth of its highest."""
    return np.asarray(np.abs(data.voltage_v) > 0.1 * float(np.max(np.abs(data.voltage_v))), dtype=np.bool_)


def _restlessness(values: Samples, lag: int) -> float:
    """Return the usual change over `lag` samples per mean size: near 0 for a supply, large for a current."""
    size = float(np.mean(np.abs(values)))
    return float(np.median(np.abs(values[lag:] - values[:-lag]))) / size if size > 0.0 and len(values) > lag else 0.0


def swapped(data: Measurement) -> Iterable[Finding]:
    """Find columns that are mixed up: by V/I, by which of the two is steady, and by which one has two levels only."""
    for name, values in (("voltage", data.voltage_v), ("current", data.current_a)):
        if np.ptp(values) > 0.0 and np.ptp(values) <= 1.05 and _two_levels(values) and np.mean(values) < 0.5:
            text = f"the {name} knows only two values, as a park switch does: are the columns of {name} and park "
            yield Finding("swapped_columns", f"{text}swapped? Say --columns {name}=...,park=...")
            return
    on = running(data) & data.valid
    backwards = np.abs(data.current_a) > 0.1 * float(np.max(np.abs(data.current_a)))
    if not np.any(on) or not np.any(backwards):
        return
    ratio = float(np.median(np.abs(data.voltage_v[backwards])) / np.median(np.abs(data.current_a[backwards])))
    lag = max(1, round(0.02 / data.period_s))
    seen = [_restlessness(values[on], lag) for values in (data.voltage_v, data.current_a)]
    if 0.02 < ratio < 0.8 and seen[0] > 2.0 * seen[1]:
        text = (
            f"'voltage' moves like a current and 'current' like a supply (V/I is {ratio:.2g} ohm, less than any wiper "
            "motor has at work): the columns of voltage and current are swapped; exchange them in --columns"
        )
        yield Finding("swapped_columns", text)


def _two_levels(values: Samples) -> bool:
    low, high = float(np.min(values)), float(np.max(values))
    near = np.minimum(values - low, high - values)
    return bool(np.all(near <= 0.02 * (high - low)))


def wrong_unit(data: Measurement) -> Iterable[Finding]:
    """Find volts and amperes that are a thousand times too large or too small."""
    top_v, on = float(np.percentile(np.abs(data.voltage_v), 99)), running(data) & data.valid
    if top_v > 100.0 or top_v < 0.5:
        small = top_v < 0.5
        unit, other = ("V", "as millivolts though it is volts") if small else ("mV", "as volts though it is millivolts")
        text = f"the voltage reaches {top_v:.4g} V: it looks as if it was taken {other}; "
        yield Finding("wrong_voltage_unit", f"{text}say --columns voltage=NAME[{unit}]")
        return
    if not np.any(on):
        return
    typical_a = float(np.median(np.abs(data.current_a[on])))
    ohm = float(np.median(np.abs(data.voltage_v[on]))) / max(typical_a, 1e-12)
    if ohm > HIGHEST_OHM:
        text = f"the current is {typical_a:.3g} A while the motor runs: "
        text += "nothing flows; is the clamp around the right wire?"
        if 1.0 < ohm / 1000.0 < HIGHEST_OHM:
            text = f"the current is {typical_a:.3g} A while the motor runs, a thousandth of what a wiper motor draws: "
            text += "it is in amperes but was taken as milliamperes; say --columns current=NAME[A]"
        yield Finding("wrong_current_unit", text)
    elif ohm < LOWEST_OHM:
        text = f"the current is {typical_a:.4g} A while the motor runs, more than any wiper motor draws: it looks like "
        text += "milliamperes that were taken as amperes; say --columns current=NAME[mA]"
        yield Finding("wrong_current_unit", text)


def slow_sampling(data: Measurement) -> Iterable[Finding]:
    """Find a current sampled too slowly for its own time constant, also where a slow one was repeated or held."""
    period_s = _native_period_s(data)
    hertz = f"{1.0 / period_s:.4g} Hz ({1e3 * period_s:.3g} ms)"
    if period_s >= SLOWEST_PERIOD_S * 0.99:
        text = f"the current is sampled at {hertz}: the motor's electrical time constant is 2 to 10 ms, so its "
        text += "inductance cannot be seen and peaks are lost; record at 1 kHz or more"
        yield Finding("slow_sampling", text)
    elif period_s > WISHED_PERIOD_S:
        text = f"the current is sampled at {hertz}: enough for resistance and constants, little for the inductance"
        yield Finding("slow_sampling", text, fatal=False)


def _native_period_s(data: Measurement) -> float:
    """Return the distance at which the current had new values before it came onto the common clock [s]."""
    named = dict(data.native)
    return named["current"].period_s if "current" in named else data.period_s


def clipped(data: Measurement) -> Iterable[Finding]:
    """Find a current that runs into a limit: flat at its extreme, entered at full slope."""
    stride = max(1, round(_native_period_s(data) / data.period_s))  # repeated values are no plateau
    current, time_s = data.current_a[::stride], data.time_s[::stride]
    two_ms = max(2, round(0.002 / (stride * data.period_s)))
    span = float(np.ptp(current))
    for sign, name in ((1.0, "above"), (-1.0, "below")):
        top = float(np.max(sign * current))
        if span == 0.0 or top < 0.3 * span:
            continue
        flat = np.concatenate([[0], (sign * current >= top - 1e-9 * span).astype(np.int8), [0]])
        starts, ends = np.flatnonzero(np.diff(flat) > 0), np.flatnonzero(np.diff(flat) < 0)
        hits = [
            start
            for start, end in zip(starts, ends, strict=True)
            if end - start >= 3 and start >= two_ms and top - sign * current[start - two_ms] > 0.02 * span
        ]
        if hits:
            text = f"the current is cut off {name} {sign * top:.4g} A, first at {time_s[hits[0]]:.3f} s ({len(hits)} "
            text += "times): it left the range of clamp or logger; choose a larger range and record again"
            yield Finding("clipped_current", text)


def park_edges(data: Measurement) -> Iterable[Finding]:
    """Find a park switch that says nothing, or says it too often or too seldom."""
    edges, on_s = rising_edges(data.park), float(np.count_nonzero(running(data))) * data.period_s
    if len(edges) == 0 and on_s > LONGEST_TURN_S / 2.0:
        text = f"no park edges in {on_s:.3g} s of running: the park contact never closes, so nothing shows the speed; "
        text += "check its wire and its column, and that the wiper turns"
        yield Finding("no_park_edges", text)
        return
    turns_s = np.diff(edges) * data.period_s
    if len(turns_s) and float(np.median(turns_s)) < 0.2:
        text = f"park edges every {float(np.median(turns_s)):.3g} s: no wiper turns that fast; is the contact noisy, "
        text += "or is it another column?"
        yield Finding("too_many_park_edges", text)
    elif len(edges) < 4:
        text = f"only {len(edges)} park edges: the speed is known for {max(0, len(edges) - 1)} turns; record longer"
        yield Finding("few_park_edges", text, fatal=False)


def levels(data: Measurement) -> Iterable[Finding]:
    """Find a supply that never changes: one operating point tells resistance and constant not apart."""
    on = running(data)
    if not np.any(on):
        yield Finding("never_on", "the voltage is never on: nothing to identify; is it the right column?")
        return
    steps = voltage_steps(data.voltage_v, data.period_s)
    volts = data.voltage_v[on & data.valid]
    lowest, highest = np.percentile(volts, [2, 98])
    if not steps and highest - lowest < LEVEL_PART * highest:
        text = f"the voltage is constant, {float(np.median(volts)):.4g} V, from start to end: neither inductance nor "
        text += "inertia shows, and resistance and back-EMF constant cannot be told apart; record switching on and at "
        text += "least three voltages"
        yield Finding("constant_voltage", text)
    elif highest - lowest < LEVEL_PART * highest and not _both_modes(data):
        text = f"there is one voltage only, {float(np.median(volts)):.4g} V: resistance and back-EMF constant are told "
        text += "apart by the start alone; three voltages make them sure"
        yield Finding("one_voltage", text, fatal=False)


def _both_modes(data: Measurement) -> bool:
    return bool(np.any(data.fast == 1.0) and np.any(data.fast == 0.0))


def gaps(data: Measurement) -> Iterable[Finding]:
    """Tell of samples that are missing or stand out."""
    unused = float(np.mean(~data.valid))
    if unused > 0.2:
        text = f"{100 * unused:.0f} % of the samples are missing or outliers: too many; look at the file"
        yield Finding("too_few_samples", text)
    elif unused > 0.01:
        yield Finding("missing_samples", f"{100 * unused:.1f} % of the samples are missing or outliers", fatal=False)
