"""What is wrong with a measurement, in words that say what to do; good data give no word at all.

Each check looks for one mistake that people make with a supply, a current clamp and a logger.
"""

from collections.abc import Callable, Iterable

import numpy as np

from hilplant.failure import Unfit
from hilplant.measurements import clipping
from hilplant.measurements.alignment import voltage_steps
from hilplant.measurements.gross_checks import swapped, too_short, wrong_sign, wrong_unit
from hilplant.measurements.measurement import DataFinding, Measurement, running
from hilplant.measurements.park import rising_edges

#: The electrical time constant of a wiper motor is 2 to 10 ms; slower sampling does not see it [s].
SLOWEST_PERIOD_S, WISHED_PERIOD_S = 0.005, 0.002
#: No logger is that slow; its time has another unit [s].
UNLIKELY_PERIOD_S = 0.2
#: Voltages that differ by this part of the highest are two levels.
LEVEL_PART = 0.04


def examine(data: Measurement) -> list[DataFinding]:
    """Return everything that is wrong with a measurement that is meant for identification.

    Where length, columns, units or signs are wrong, nothing else is said: it would only follow from that.
    """
    for check in (too_short, swapped, wrong_unit, wrong_sign):
        if gross := list(check(data)):
            return gross
    checks: tuple[Callable[[Measurement], Iterable[DataFinding]], ...] = (
        slow_sampling,
        clipped,
        park_edges,
        levels,
        gaps,
    )
    return [found for check in checks for found in check(data)]


def refuse(data: Measurement) -> list[DataFinding]:
    """Refuse data that are fatally wrong; return what else is to be known.

    Raises
    ------
    Unfit
        With one line for each fatal finding.

    """
    found = examine(data)
    if fatal := [finding for finding in found if finding.fatal]:
        raise Unfit("\n".join(f"{data.source or 'data'}: {finding.text}" for finding in fatal))
    return found


def slow_sampling(data: Measurement) -> Iterable[DataFinding]:
    """Find a current sampled too slowly for its own time constant, also where a slow one was repeated or held."""
    period_s = _native_period_s(data)
    hertz = f"{1.0 / period_s:.4g} Hz ({1e3 * period_s:.3g} ms)"
    if period_s >= SLOWEST_PERIOD_S * 0.99:
        text = f"the current is sampled at {hertz}: the motor's electrical time constant is 2 to 10 ms, so its "
        text += "inductance cannot be seen and peaks are lost; record at 1 kHz or more"
        text += ", or say --columns time=NAME[ms] if the time is in milliseconds" * (period_s >= UNLIKELY_PERIOD_S)
        yield DataFinding("slow_sampling", text)
    elif period_s > WISHED_PERIOD_S:
        text = f"the current is sampled at {hertz}: enough for resistance and constants, little for the inductance"
        yield DataFinding("slow_sampling", text, fatal=False)


def _native_period_s(data: Measurement) -> float:
    """Return the distance at which the current had new values before it came onto the common clock [s]."""
    named = dict(data.native)
    return named["current"].period_s if "current" in named else data.period_s


def clipped(data: Measurement) -> Iterable[DataFinding]:
    """Find a current that runs into the limit of clamp or logger."""
    return clipping.clipped(data, _native_period_s(data))


def park_edges(data: Measurement) -> Iterable[DataFinding]:
    """Find a park switch that says nothing, or says it too often or too seldom."""
    edges, on_s = rising_edges(data.park), float(np.count_nonzero(running(data))) * data.period_s
    if len(edges) == 0:
        text = f"no park edges in {on_s:.3g} s of running: the park contact never closes, so nothing shows the speed; "
        text += "check its wire and its column, and that the wiper turns"
        yield DataFinding("no_park_edges", text)
        return
    turns_s = np.diff(edges) * data.period_s
    if len(turns_s) and float(np.median(turns_s)) < 0.2:
        text = f"park edges every {float(np.median(turns_s)):.3g} s: no wiper turns that fast; is the contact noisy, "
        text += "or is it another column?"
        yield DataFinding("too_many_park_edges", text)
    elif len(edges) < 4:
        text = f"only {len(edges)} park edges: the speed is known for {max(0, len(edges) - 1)} turns; record longer"
        yield DataFinding("few_park_edges", text, fatal=False)


def levels(data: Measurement) -> Iterable[DataFinding]:
    """Find a supply that never changes: one operating point tells resistance and constant not apart."""
    on = running(data)
    if not np.any(on):
        yield DataFinding("never_on", "the voltage is never on: nothing to identify; is it the right column?")
        return
    steps = voltage_steps(data.voltage_v, data.period_s)
    volts = data.voltage_v[on & data.valid]
    lowest, highest = np.percentile(volts, [2, 98])
    if not steps and highest - lowest < LEVEL_PART * highest:
        text = f"the voltage is constant, {float(np.median(volts)):.4g} V, from start to end: neither inductance nor "
        text += "inertia shows, and resistance and back-EMF constant cannot be told apart; record switching on and at "
        text += "least three voltages"
        yield DataFinding("constant_voltage", text)
    elif highest - lowest < LEVEL_PART * highest and not _both_modes(data):
        text = f"there is one voltage only, {float(np.median(volts)):.4g} V: resistance and back-EMF constant are told "
        text += "apart by the start alone; three voltages make them sure"
        yield DataFinding("one_voltage", text, fatal=False)


def _both_modes(data: Measurement) -> bool:
    return bool(np.any(data.fast == 1.0) and np.any(data.fast == 0.0))


def gaps(data: Measurement) -> Iterable[DataFinding]:
    """Tell of samples that are missing or stand out."""
    unused = float(np.mean(~data.valid))
    if unused > 0.2:
        text = f"{100 * unused:.0f} % of the samples are missing or outliers: too many; look at the file"
        yield DataFinding("too_few_samples", text)
    elif unused > 0.01:
        yield DataFinding(
            "missing_samples", f"{100 * unused:.1f} % of the samples are missing or outliers", fatal=False
        )
