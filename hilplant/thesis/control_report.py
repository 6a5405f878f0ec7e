"""The control study as tables, and its figures as flat JSON."""

import re
from typing import Any

from hilplant.thesis.control_search import FoundGains
from hilplant.thesis.control_study import OURS, Study
from hilplant.thesis.control_test import Metrics
from hilplant.thesis.control_thesis import ROWS, ThesisRow, factors, far_off
from hilplant.thesis.text_table import Part, TextTable
from hilplant.train.speed_estimates import ESTIMATORS, Case

_TITLES = {
    "7-2": "Table 7-2: PID",
    "7-5": "Table 7-5: single neuron, fixed K",
    "7-6": "Table 7-6: single neuron, fuzzy K",
}
_STATES = [f"{n}" for n in range(1, 6)]
#: Of :class:`~hilplant.thesis.control_rain.Duty`, in the table's order.
_DUTY_COLUMNS = ("energy [Wh]", "i2 t [A2 h]", "motor turns", "wipes", "peak [A]", "need missed [%]")


def report(study: Study, seconds: float) -> list[Part]:
    """Return all tables; the thesis' numbers stand under ours. `seconds` is how long the study took."""
    return [
        *(_beside(study, number, title) for number, title in _TITLES.items()),
        _metric_table(
            "Ours: another PID, gains found by search, the cascade",
            [[name, *_cells(study.results[name].row())] for name in OURS],
        ),
        *_remarks(study),
        _metric_table("Without a speed sensor", [[name, *_cells(r.row())] for name, r in study.blind.items()]),
        _cases(study.cases),
        _duties(study),
        f"{seconds:.1f} s",
    ]


def _metric_table(title: str, rows: list[list[str]]) -> TextTable:
    columns = ["rad/s, s", "overshoot", "rise", *(f"state {n} -/+" for n in _STATES)]
    return TextTable(title, columns, rows, numbers=True)


def _cells(numbers: tuple[float, ...]) -> list[str]:
    pairs = [f"{low:.3f}/{high:.3f}" for low, high in zip(numbers[2::2], numbers[3::2], strict=True)]
    return [f"{numbers[0]:.3f}", f"{numbers[1]:.3f}", *pairs]


def _beside(study: Study, number: str, title: str) -> TextTable:
    rows = []
    for row in ROWS:
        if row.table == number:
            rows += [[row.name, *_cells(study.results[row.name].row())], ["  source", *_cells(row.numbers)]]
    return _metric_table(title, rows)


def _remarks(study: Study) -> list[str]:
    lines = []
    for figure, order in study.orders.items():
        swapped = "; ".join(f"{a} before {b} ({100.0 * (ratio - 1.0):.0f} %)" for a, b, ratio in order.swapped)
        lines.append(
            f"Order by {figure}: Kendall's tau {order.tau:.2f}; in the thesis, not in ours: {swapped or 'none'}"
        )
    compared, beyond = compare_all(study)
    off = "; ".join(f"{name}, {column}: {factor:.2f}" for name, column, factor in beyond)
    lines.append(f"{compared - len(beyond)} of {compared} figures within a factor of 3 of the thesis'; not: {off}")
    return [*lines, ""]


def compare_all(study: Study) -> tuple[int, list[tuple[str, str, float]]]:
    """Return how many figures were compared, and those farther off than a factor of three."""
    compared, beyond = 0, []
    for row in ROWS:
        compared += len(factors(row, study.results[row.name]))
        beyond += [(row.name, column, factor) for column, factor in far_off(row, study.results[row.name]).items()]
    return compared, beyond


def _cases(cases: list[Case]) -> TextTable:
    columns = [
        f"{estimator}, {brush}" for estimator in ("network", "observer", "adapting") for brush in ("slow", "fast")
    ]
    title = (
        "Error of the estimated crank speed, rms (worst) in rad/s; the plant's parameter is off, the estimator's not"
    )
    rows = []
    for slow, fast in zip(cases[::2], cases[1::2], strict=True):
        errors = [case.errors[estimator] for estimator in ESTIMATORS for case in (slow, fast)]
        name = slow.parameter if slow.factor == 1.0 else f"{slow.parameter} {100.0 * (slow.factor - 1.0):+.0f} %"
        rows.append([name, *(f"{e.rms_rad_s:.3f} ({e.worst_rad_s:.2f})" for e in errors)])
    return TextTable(title, ["parameter", *columns], rows, numbers=True)


def _duties(study: Study) -> TextTable:
    rows = [
        [name, *(f"{value:.1f}" for value in duty[:-1]), f"{100.0 * duty.missed:.1f}"]
        for name, duty in study.duties.items()
    ]
    return TextTable("An hour of mixed rain", ["", *_DUTY_COLUMNS], rows, numbers=True)


def found_report(found: list[FoundGains]) -> list[Part]:
    """Return what the search found, as the catalogue keeps it."""
    rows = [[f"{one.rule}_{one.aim}", *_cells(one.metrics.row())] for one in found]
    lines = [f'("{one.rule}", "{one.aim}"): {one.gains},' for one in found]
    return [_metric_table("Gains found by search", rows), *lines]


def figures(study: Study, seconds: float) -> dict[str, Any]:
    """Return the study as flat figures."""
    flat: dict[str, Any] = {"study_s": seconds}
    for name, result in study.results.items():
        flat |= _flat_metrics(_key(name), result)
    for row in ROWS:
        flat |= {f"source_{key}": value for key, value in _flat_row(row).items()}
    for name, result in study.blind.items():
        flat |= _flat_metrics(_key(f"sensorless {name}"), result)
    for figure, order in study.orders.items():
        flat[_key(f"order {figure} tau")] = order.tau
    compared, beyond = compare_all(study)
    flat |= {"compared": compared, "within_factor_3": compared - len(beyond)}
    for case in study.cases:
        for estimator, error in case.errors.items():
            sign = f" {100.0 * (case.factor - 1.0):+.0f} percent" if case.factor != 1.0 else ""
            key = _key(
                f"estimator {estimator} {case.brush} {case.parameter}{sign}".replace("+", "plus ").replace(
                    "-", "minus "
                )
            )
            flat |= {f"{key}_rms_rad_s": error.rms_rad_s, f"{key}_worst_rad_s": error.worst_rad_s}
    for name, duty in study.duties.items():
        flat |= {_key(f"rain {name} {field}"): value for field, value in duty._asdict().items()}
    return flat


def _flat_metrics(key: str, result: Metrics) -> dict[str, float]:
    flat = {f"{key}_overshoot_rad_s": result.overshoot_rad_s, f"{key}_rise_s": result.rise_s}
    for number, low, high in zip(_STATES, result.low, result.high, strict=True):
        flat |= {f"{key}_state_{number}_low_rad_s": low, f"{key}_state_{number}_high_rad_s": high}
    return flat | {f"{key}_worst_rad_s": result.worst_rad_s, f"{key}_mean_rad_s": result.mean_rad_s}


def _flat_row(row: ThesisRow) -> dict[str, float]:
    numbers = row.numbers
    return _flat_metrics(_key(row.name), Metrics(numbers[0], numbers[1], numbers[2::2], numbers[3::2]))


def _key(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "_", name.lower()).strip("_")
