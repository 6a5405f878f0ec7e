"""Raw channels -> one measurement, with every change that was made to the data said in a note."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.failure import Failure
from hilplant.measurements.alignment import current_shift
from hilplant.measurements.baseline import Correction, corrected
from hilplant.measurements.channels import Channels
from hilplant.measurements.columns import Column, choose_columns, has_unit, unit_scale
from hilplant.measurements.files import Origin, read_channels, sha256
from hilplant.measurements.measurement import Channel, Measurement, Native
from hilplant.measurements.outliers import near_steps, spikes
from hilplant.measurements.park import contact
from hilplant.measurements.resampling import OnClock, checked, on_clock, own_clock, shared_clock, steadied

#: A shift in time is corrected when it is this many standard errors, and this many samples, away from none: a step of
#: the voltage may lie anywhere between two samples.
SHIFT_ERRORS, SHIFT_SAMPLES = 4.0, 1.0


class Preparation(NamedTuple):
    """How a file becomes a measurement.

    `offset_a` and `current_shift_s` None: estimated from the data; a number is taken as it is. The filter is a
    Butterworth low-pass of fourth order over voltage and current alike, forwards and backwards, so without a shift.
    `mode` is what the motor's mode is throughout when no column says it.
    """

    step_s: float = 0.001
    filter_hz: float | None = None
    offset_a: float | None = None
    current_shift_s: float | None = None
    park_shift_s: float = 0.0
    park_inverted: bool | None = None
    mode: str | None = None


def read_measurement(
    origin: Origin, columns: dict[str, Column] | None = None, preparation: Preparation | None = None
) -> Measurement:
    """Read a file and prepare it.

    Raises
    ------
    Failure
        In one line, when the file, its columns, units or times are not such that they can be a measurement.

    """
    given = dict(columns or {})
    channels = read_channels(origin._replace(time=given.pop("time", origin.time)))
    made = prepare(channels, given, preparation or Preparation(), str(origin.path))
    return replace(made, sha256=sha256(origin.path), notes=channels.notes + made.notes)


def prepare(
    channels: Mapping[str, Channel], columns: dict[str, Column], how: Preparation, source: str = "data"
) -> Measurement:
    """Bring channels onto one clock and into SI units; correct offset and shift, flag outliers, filter."""
    roles = {role: column for role, column in columns.items() if role != "time"}
    texts = channels.texts if isinstance(channels, Channels) else {}
    chosen = choose_columns(roles, channels, source, texts)
    chosen.pop("time", None)
    raw: dict[str, Channel] = {}
    native: dict[str, Native] = {}
    for role, column in chosen.items():
        place = f"{source}, column '{column.name}'"
        raw[role], native[role] = checked(_in_si(channels[column.name], column, role, place), place)
    for role in ("voltage", "current"):
        raw[role] = steadied(raw[role])
    notes = _unit_notes(chosen, channels)
    seen_late_s = _seen_late_s(raw["park"], native["park"], how.step_s)
    raw["park"] = _shifted(raw["park"], how.park_shift_s + seen_late_s)
    if seen_late_s:
        notes += (f"park edges taken {1e3 * seen_late_s:.3g} ms earlier: so much later they are seen on average",)
    shift_s = how.current_shift_s
    if shift_s is None:
        shift_s, note = _find_shift(raw, native, how.step_s, source)
        notes += note
    elif shift_s:
        notes += (f"current taken {1e3 * shift_s:.2f} ms earlier, as told",)
    raw["current"] = _shifted(raw["current"], shift_s)
    return _assemble(raw, native, how, notes, source)


def _in_si(channel: Channel, column: Column, role: str, place: str) -> Channel:
    unit = column.unit if column.unit is not None else channel.unit
    if column.factor != 1.0 and column.unit is None and not has_unit(role, unit):
        unit = ""  # a clamp: the factor leads from the file's unit to the role's own
    scale = unit_scale(place, role, unit) * column.factor
    return Channel(channel.time_s, channel.values * scale, unit, channel.held and role != "current")


def _unit_notes(chosen: dict[str, Column], channels: Mapping[str, Channel]) -> tuple[str, ...]:
    notes = [f"{role} is column '{column.name}'" for role, column in chosen.items()]
    for role, column in chosen.items():
        in_file = channels[column.name].unit
        if column.unit is not None and in_file and column.unit != in_file:
            notes.append(f"{role}: the file says [{in_file}], taken as [{column.unit}], as told")
    return tuple(notes)


def _shifted(channel: Channel, earlier_s: float) -> Channel:
    return Channel(channel.time_s - earlier_s, channel.values, channel.unit, channel.held)


def _seen_late_s(park: Channel, native: Native, step_s: float) -> float:
    """Return by how much more than on the clock an edge is late on average, as it is seen half a sample after it [s].

    In whole steps, so that the clock stays on the samples. A contact that is sent when it changes is not late.
    """
    return 0.0 if park.held else step_s * max(0.0, np.floor(0.5 * (native.period_s / step_s - 1.0) + 1e-6))


def _find_shift(
    raw: dict[str, Channel], native: dict[str, Native], step_s: float, source: str
) -> tuple[float, tuple[str, ...]]:
    """Estimate by how much the current is late, on a clock as fine as the data."""
    fine_s = min(step_s, max(native["current"].period_s, native["voltage"].period_s))
    pair = {role: raw[role] for role in ("voltage", "current")}
    clock = own_clock(raw["voltage"], shared_clock(list(pair.values()), fine_s, source))
    hold = raw["voltage"].held
    voltage = on_clock(pair["voltage"], native["voltage"], clock, hold).values
    current = on_clock(pair["current"], native["current"], clock, False).values
    found = current_shift(current, voltage, fine_s)
    if found is None:
        return 0.0, ("shift between voltage and current: cannot be told, too few clear steps of the voltage",)
    told = f"{1e3 * found.value:+.2f} ms (standard error {1e3 * found.error:.2f} ms, {found.samples} steps)"
    if abs(found.value) < max(SHIFT_ERRORS * found.error, SHIFT_SAMPLES * max(step_s, native["voltage"].period_s)):
        return 0.0, (f"the current is late against the voltage by {told}: none that counts, nothing changed",)
    return found.value, (f"the current is late against the voltage by {told}: moved back by that",)


def _assemble(
    raw: dict[str, Channel], native: dict[str, Native], how: Preparation, notes: tuple[str, ...], source: str
) -> Measurement:
    clock = own_clock(raw["voltage"], shared_clock(list(raw.values()), how.step_s, source))
    on = {role: on_clock(raw[role], native[role], clock, _holds(role, raw[role])) for role in raw}
    voltage = on["voltage"].values * (on["on"].values > 0.5) if "on" in on else on["voltage"].values
    notes += _clock_notes(native, how.step_s)
    present = on["voltage"].present & on["current"].present
    outlier = _outliers(voltage, on["current"].values, how.step_s, native)
    notes += _counted(present, outlier & present)
    signals = corrected(voltage, on["current"].values, how.step_s, Correction(how.offset_a, how.filter_hz))
    closed = contact(on["park"].values, how.step_s, how.park_inverted)
    notes += signals.notes + _park_notes(closed.threshold, closed.inverted, closed.bounces, raw["park"])
    time_s = np.asarray(np.arange(len(clock)) * how.step_s, np.float64)
    return Measurement(
        time_s, signals.voltage, signals.current, closed.closed, _fast(on, how.mode, len(clock)),
        present & ~outlier, how.step_s, source, "", tuple(native.items()), notes,
    )  # fmt: skip


def _holds(role: str, channel: Channel) -> bool:
    return role in ("park", "fast", "on") or (role == "voltage" and channel.held)


def _clock_notes(native: dict[str, Native], step_s: float) -> tuple[str, ...]:
    rates = ", ".join(
        f"{role} {1.0 / each.period_s:.4g} Hz" if each.period_s > 0.0 else f"{role} once"
        for role, each in native.items()
    )
    notes = [f"sampled at {rates}; brought to {1.0 / step_s:.4g} Hz"]
    notes += [f"{role}: cells without a number: {each.missing}" for role, each in native.items() if each.missing]
    return tuple(notes)


def _outliers(voltage: Floats, current: Floats, step_s: float, native: dict[str, Native]) -> Flags:
    """Flag spikes; those of the current are not looked for where steps are, or where it was sampled more slowly."""
    found = spikes(voltage)
    if native["current"].period_s <= 1.5 * step_s:
        found = found | spikes(current, near_steps(voltage, step_s))
    return found


def _counted(present: Flags, outlier: Flags) -> tuple[str, ...]:
    missing, strange = int(np.count_nonzero(~present)), int(np.count_nonzero(outlier))
    notes = [f"{missing} of {len(present)} samples lie in gaps: bridged by a straight line, not used"] * (missing > 0)
    notes += [f"{strange} of {len(present)} samples are outliers: left as they are, not used"] * (strange > 0)
    return tuple(notes)


def _park_notes(threshold: float, inverted: bool, bounces: int, raw: Channel) -> tuple[str, ...]:
    levels = f"park contact: closed {'below' if inverted else 'above'} {threshold:.3g}"
    late = f"{bounces} bounces removed" if bounces else "no bounces"
    return (f"{levels}, {late}, {len(np.unique(raw.values))} levels; its shift against the others cannot be told",)


def _fast(on: dict[str, OnClock], mode: str | None, count: int) -> Floats:
    if mode not in (None, "slow", "fast"):
        raise Failure(f"the mode must be slow or fast, not '{mode}'")
    if "fast" in on:
        return (on["fast"].values > 0.5).astype(np.float64)
    return np.full(count, np.nan if mode is None else float(mode == "fast"))
