"""Offsets of voltage and current taken off, and a filter where one is asked for; each change is said in a note."""

from typing import NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt

from hilplant.arrays import Floats
from hilplant.failure import Failure
from hilplant.measurements.alignment import rest_offset

#: Offsets below this are none [A, V].
LEAST_OFFSET = 1e-3


class Correction(NamedTuple):
    """Offset of the current [A], None where the data are to say it, and corner of the filter [Hz], None without one."""

    offset_a: float | None
    filter_hz: float | None


class Corrected(NamedTuple):
    """Voltage [V] and current [A] as they are used, and what was done to them."""

    voltage: Floats
    current: Floats
    notes: tuple[str, ...]


def corrected(voltage: Floats, current: Floats, step_s: float, how: Correction) -> Corrected:
    """Take the offsets off, and filter where that is asked for."""
    current, notes = _without_offset(current, voltage, step_s, how.offset_a)
    level = rest_offset(voltage, voltage, step_s)
    if level is not None and abs(level.value) > LEAST_OFFSET:
        voltage = voltage - level.value
        notes += (f"offset of the voltage: {level.value:.4g} V subtracted",)
    if how.filter_hz is not None:
        voltage, current = (low_pass(values, step_s, how.filter_hz) for values in (voltage, current))
        notes += (f"voltage and current filtered forwards and backwards, fourth order, {how.filter_hz:g} Hz",)
    return Corrected(voltage, current, notes)


def _without_offset(
    current: Floats, voltage: Floats, step_s: float, told_a: float | None
) -> tuple[Floats, tuple[str, ...]]:
    if told_a is not None:
        return current - told_a, (f"offset of the current: {told_a:.4g} A subtracted, as told",)
    found = rest_offset(current, voltage, step_s)
    if found is None:
        return current, ("offset of the current: cannot be told, the motor never rests with its terminals at 0 V",)
    told = f"{found.value:.4g} A (standard error {found.error:.2g} A)"
    if abs(found.value) <= max(3.0 * found.error, LEAST_OFFSET):
        return current, (f"offset of the current: {told}: none that counts, nothing changed",)
    return current - found.value, (f"offset of the current: {told} subtracted",)


def low_pass(values: Floats, period_s: float, corner_hz: float) -> Floats:
    """Return the values behind a Butterworth low-pass of fourth order that runs forwards, then backwards.

    Raises
    ------
    Failure
        When the corner is not below half the sampling rate.

    """
    if not 0.0 < corner_hz < 0.5 / period_s:
        raise Failure(f"a filter of {corner_hz:g} Hz needs more than {2.0 * corner_hz:g} samples a second")
    sections = butter(4, corner_hz, fs=1.0 / period_s, output="sos")
    return np.asarray(sosfiltfilt(sections, values), np.float64)
