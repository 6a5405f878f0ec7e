"""Tables 5-2 to 5-5 computed again from their inputs, each printed number beside ours.

A number that was computed from rounded numbers need not round to the printed one. So each line also says what all
inputs can give that round to the printed inputs: within that range the difference is rounding, outside it is one.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from hilplant import resources
from hilplant.checked_yaml.yaml_reader import read_text
from hilplant.identify.srivc import Stretch, TransferFit, fit, simulated
from hilplant.identify.transfer_function import (
    Coefficients,
    Equivalent,
    TransferFunction,
    by_load,
    coefficients,
    load_constant,
    of_motor,
)  # fmt: skip
from hilplant.motor_bench.bench_measurements import SteadyRun, back_emf_constant
from hilplant.thesis.rounding import Bounds, cut_to, half_digit, reachable, rounds_to

MODES = ("slow", "fast")
_TRANSFER_FUNCTION = ("b1", "b0", "a1", "a0")


class PublishedNumber(NamedTuple):
    """One printed number beside ours.

    `bounds` are what the printed inputs can give within their rounding; equal where the inputs are exact.
    """

    table: str
    name: str
    printed: str
    ours: float
    bounds: Bounds
    remark: str = ""

    @property
    def agrees(self) -> str:
        """Return "digits", "cut" (the printed digits were cut off, not rounded), "rounding" (of inputs), or "no"."""
        if rounds_to(self.ours, self.printed):
            return "digits"
        if cut_to(self.ours, self.printed):
            return "cut"
        low, high = self.bounds
        slack = half_digit(self.printed) * (1.0 + 1e-9)
        return "rounding" if low - slack <= float(self.printed) <= high + slack else "no"


def published_lines() -> list[PublishedNumber]:
    """Return every line of Tables 5-2 to 5-5, in their order."""
    return [*table_5_2(), *table_5_3(), *table_5_4(), *table_5_5()]


def table_5_2() -> Iterator[PublishedNumber]:
    """Compare Table 5-2: coefficients and parameters from (5.11), (5.12), and both from data of the simulated motor."""
    data = _read("table_5_2.yaml")
    yield from _from_transfer_functions("5-2", data)
    for mode in MODES:
        found = identified_from_simulation(data, mode).function
        printed = data["transfer_function"][mode]
        pairs = zip(_TRANSFER_FUNCTION, found, strict=True)
        for name, value in pairs:
            remark = "identified here from data of the simulated motor"
            yield PublishedNumber(
                "5-2", f"{mode} {name} identified", printed[name], value, _identified_bounds(value), remark
            )


def _identified_bounds(value: float) -> Bounds:
    """Allow what the thesis' tool may have missed: a thousandth, as its own gain of 666.6 for 666.67 shows."""
    return value * (1.0 - 1e-3), value * (1.0 + 1e-3)


def identified_from_simulation(data: Any, mode: str) -> TransferFit:
    """Return what identification makes of the motor of Table 5-2: steps of the voltage, 20 kHz, without noise."""
    brush = data["motor"][mode]
    drag, inertia = float(data["gamma_n_m_s"]), float(data["motor"]["inertia_kg_m2"])
    resistance, inductance, constant = (float(text) for text in brush.values())
    motor = Equivalent(resistance, inductance, constant, inertia, drag)
    period_s, held = 5e-5, 8000
    volts = np.repeat([10.0, 12.0, 14.0, 12.0, 16.0, 0.0], held)
    current = simulated(of_motor(motor), volts, period_s)
    return fit([Stretch(volts, current, np.ones(len(volts), dtype=np.bool_))], period_s)


def table_5_3() -> Iterator[PublishedNumber]:
    """Compare Table 5-3: gamma, coefficients and parameters from (5.13) to (5.15)."""
    data = _read("table_5_3.yaml")
    gamma = load_constant()
    yield PublishedNumber("5-3", "gamma [N m s/rad]", data["gamma_n_m_s"], gamma, (gamma, gamma), "(5.15)")
    yield from _from_transfer_functions("5-3", data)


def _from_transfer_functions(table: str, data: Any) -> Iterator[PublishedNumber]:
    drag = float(data["gamma_n_m_s"])
    for mode in MODES:
        texts = [data["transfer_function"][mode][name] for name in _TRANSFER_FUNCTION]
        found = coefficients(TransferFunction(*map(float, texts)))
        for index, name in enumerate(Coefficients._fields):
            bounds = reachable(_coefficient(index), texts)
            yield PublishedNumber(table, f"{mode} {name}", data["coefficients"][mode][name], found[index], bounds)
        motor = by_load(found, drag)
        for index, name in enumerate(Equivalent._fields[:4]):
            bounds = reachable(_parameter(index, drag), texts)
            yield PublishedNumber(table, f"{mode} {name}", data["parameters"][mode][name], motor[index], bounds)


def _coefficient(index: int) -> Callable[..., float]:
    return lambda *values: coefficients(TransferFunction(*values))[index]


def _parameter(index: int, drag: float) -> Callable[..., float]:
    return lambda *values: by_load(coefficients(TransferFunction(*values)), drag)[index]


class _Reading(NamedTuple):
    """One row of Table 5-4; current and speed as printed, voltage and resistance are settings."""

    voltage_v: float
    resistance_ohm: float
    current_a: str
    speed_rad_s: str

    def constant(self, current_a: float, speed_rad_s: float) -> float:
        return float(back_emf_constant(SteadyRun(self.voltage_v, current_a, speed_rad_s), self.resistance_ohm).n)

    @property
    def value(self) -> float:
        return self.constant(float(self.current_a), float(self.speed_rad_s))


def table_5_4() -> Iterator[PublishedNumber]:
    """Compare Table 5-4: the back-EMF constants (5.18), and their averages."""
    printed = _read("table_5_4_constants.yaml")["constant_v_s"]
    for mode in MODES:
        rows = _readings(mode)
        bounds = [reachable(row.constant, (row.current_a, row.speed_rad_s)) for row in rows]
        for row, limits in zip(rows, bounds, strict=True):
            text = printed[mode][f"{row.voltage_v:g}"]
            yield PublishedNumber("5-4", f"{mode} K at {row.voltage_v:g} V", text, row.value, limits, _stray(row, rows))
        low, high = np.mean(bounds, axis=0)
        mean = float(np.mean([row.value for row in rows]))
        yield PublishedNumber("5-4", f"{mode} K average", printed[mode]["average"], mean, (float(low), float(high)))


def _readings(mode: str) -> list[_Reading]:
    data = _read("table_5_4.yaml")
    ohm = float(data["resistance_ohm"][mode])
    rows = [row for row in data["rows"] if row["stage"] == mode]
    return [
        _Reading(float(row["supply_v"]), ohm, f"{row['current_a']:.3f}", f"{row['speed_rad_s']:.2f}") for row in rows
    ]


def _stray(row: _Reading, rows: Sequence[_Reading]) -> str:
    """Say where a row is more than a twentieth off the mean of the others, while they agree within that."""
    others = [other.value for other in rows if other is not row]
    off = row.value / float(np.mean(others)) - 1.0
    if abs(off) < 0.05 or np.ptp(others) > 0.05 * float(np.mean(others)):
        return ""
    return f"{100.0 * off:+.1f} % off the other rows, which agree: its speed is doubtful"


def table_5_5() -> Iterator[PublishedNumber]:
    """Compare Table 5-5: time constants and inductances (5.20)."""
    for row in _read("table_5_5.yaml")["rows"]:
        fallen = row["fallen_s"]
        as_printed = float(fallen) - float(row["step_s"])
        remark = ""
        if as_printed < 0.0:
            fallen = _exchanged(fallen)
            remark = f"{row['fallen_s']} s lies before the step; read as {fallen} s"
        tau = float(fallen) - float(row["step_s"])
        bounds = reachable(lambda step, end: end - step, [row["step_s"], fallen])
        yield PublishedNumber("5-5", f"{row['state']} time constant [s]", row["time_constant_s"], tau, bounds, remark)
        ohm = float(row["resistance_ohm"])
        scaled = bounds[0] * ohm, bounds[1] * ohm
        yield PublishedNumber("5-5", f"{row['state']} inductance [H]", row["inductance_henry"], tau * ohm, scaled)


def _exchanged(text: str) -> str:
    """Exchange the first two decimals: 3.278 -> 3.728."""
    whole, _, decimals = text.partition(".")
    return f"{whole}.{decimals[1]}{decimals[0]}{decimals[2:]}"


def as_table(lines: Sequence[PublishedNumber]) -> str:
    """Return the lines as text for a terminal."""
    rows = [("table", "quantity", "printed", "ours", "inputs can give", "agrees", "")]
    for line in lines:
        span = f"{line.bounds[0]:.6g} .. {line.bounds[1]:.6g}" if line.bounds[0] != line.bounds[1] else ""
        rows.append((line.table, line.name, line.printed, f"{line.ours:.6g}", span, line.agrees, line.remark))
    widths = [max(len(row[column]) for row in rows) for column in range(6)]
    padded = [[*(cell.ljust(width) for cell, width in zip(row, widths, strict=False)), row[6]] for row in rows]
    return "\n".join("  ".join(cells).rstrip() for cells in padded)


def figures(lines: Sequence[PublishedNumber]) -> dict[str, float | str]:
    """Return the numbers for a JSON file: ours under a flat name, and how many lines agree in which way."""
    flat: dict[str, float | str] = {
        f"table_{line.table}_{line.name}".replace("-", "_").replace(" ", "_").split("_[")[0].lower(): line.ours
        for line in lines
    }
    for answer in ("digits", "cut", "rounding", "no"):
        flat[f"lines_{answer}"] = sum(line.agrees == answer for line in lines)
    return flat


def _read(name: str) -> Any:
    path = resources.shipped("config", "measurements", name)
    return read_text(path.read_text(encoding="utf-8"), name).data
