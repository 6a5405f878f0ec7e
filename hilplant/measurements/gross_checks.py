"""Mistakes after which nothing else in a measurement means anything: wrong columns, units, signs, or a wrong time."""

from collections.abc import Iterable

import numpy as np

from hilplant.arrays import Floats
from hilplant.measurements.measurement import DataFinding, Measurement, running

#: A wiper motor at work shows V/I between about its resistance (blocked) and some ten ohms (no load) [ohm].
LOWEST_OHM, HIGHEST_OHM = 0.15, 60.0
#: A turn of the crank takes 0.5 to 1.5 s at work.
SHORTEST_S = 1.0


def too_short(data: Measurement) -> Iterable[DataFinding]:
    """Find a recording that is shorter than a turn; most often its time has another unit."""
    lasts_s = float(data.time_s[-1])
    if lasts_s < SHORTEST_S:
        text = f"the recording lasts {lasts_s:.3g} s, which is less than a turn of the crank; if that is not so, its "
        text += "time has another unit: say --columns time=NAME[s], or [ms]"
        yield DataFinding("too_short", text)


def swapped(data: Measurement) -> Iterable[DataFinding]:
    """Find columns that are mixed up: by V/I, by which of the two is steady, and by which one has two levels only."""
    for name, values in (("voltage", data.voltage_v), ("current", data.current_a)):
        if np.ptp(values) > 0.0 and np.ptp(values) <= 1.05 and _two_levels(values) and np.mean(values) < 0.5:
            text = f"the {name} knows only two values, as a park switch does: are the columns of {name} and park "
            yield DataFinding("swapped_columns", f"{text}swapped? Say --columns {name}=...,park=...")
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
        yield DataFinding("swapped_columns", text)


def _restlessness(values: Floats, lag: int) -> float:
    """Return the usual change over `lag` samples per mean size: near 0 for a supply, large for a current."""
    size = float(np.mean(np.abs(values)))
    return float(np.median(np.abs(values[lag:] - values[:-lag]))) / size if size > 0.0 and len(values) > lag else 0.0


def _two_levels(values: Floats) -> bool:
    low, high = float(np.min(values)), float(np.max(values))
    near = np.minimum(values - low, high - values)
    return bool(np.all(near <= 0.02 * (high - low)))


def wrong_unit(data: Measurement) -> Iterable[DataFinding]:
    """Find volts and amperes that are a thousand times too large or too small."""
    top_v, on = float(np.percentile(np.abs(data.voltage_v), 99)), running(data) & data.valid
    if top_v > 100.0 or top_v < 0.5:
        small = top_v < 0.5
        unit, other = ("V", "as millivolts though it is volts") if small else ("mV", "as volts though it is millivolts")
        text = f"the voltage reaches {top_v:.4g} V: it looks as if it was taken {other}; "
        yield DataFinding("wrong_voltage_unit", f"{text}say --columns voltage=NAME[{unit}]")
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
        yield DataFinding("wrong_current_unit", text)
    elif ohm < LOWEST_OHM:
        text = f"the current is {typical_a:.4g} A while the motor runs, more than any wiper motor draws: it looks like "
        text += "milliamperes that were taken as amperes; say --columns current=NAME[mA]"
        yield DataFinding("wrong_current_unit", text)


def wrong_sign(data: Measurement) -> Iterable[DataFinding]:
    """Find a current that flows against the voltage while the motor runs."""
    on = running(data) & data.valid
    volts, amperes = (float(np.median(values[on])) for values in (data.voltage_v, data.current_a))
    if volts * amperes < 0.0:
        name, what = ("voltage", "the voltmeter's leads are") if volts < 0.0 else ("current", "the clamp is")
        text = f"voltage and current have opposite signs while the motor runs ({volts:.3g} V, {amperes:.3g} A): {what} "
        yield DataFinding("wrong_sign", f"{text}the wrong way round; say --columns {name}=NAME*-1")
