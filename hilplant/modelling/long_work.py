"""What takes long, orders in and figures out: identification in its stages, and training, as the commands do them."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from hilplant.identify.from_files import IdentifiedFiles, Request, figures, identify_files, partial_figures
from hilplant.identify.stages import StagedValues, parse_stages
from hilplant.identify.three_stages import Identified
from hilplant.identify.validation import Comparison
from hilplant.modelling.recordings import thinned
from hilplant.progress import OnProgress
from hilplant.reports.page import TrainingReport

Order = dict[str, Any]
Answer = dict[str, Any]


def identified(order: Order, on_progress: OnProgress) -> Answer:
    """Identify from recordings; the order's keys are those of :class:`Request`, `stages` as the command takes them."""
    wanted: Any = {name: tuple(value) if isinstance(value, list) else value for name, value in order.items()}
    wanted |= {"out": Path(order["out"]), "stages": parse_stages(order.get("stages", "1,2,3"))}
    done = identify_files(Request(**wanted), on_progress)
    done.journal.remove()
    found, outcome = done.found, done.found.outcome
    answer = _whole(found) if isinstance(found, Identified) else _partial(done, found)
    whole = answer | {
        "history": [each._asdict() for each in outcome.history] if outcome is not None else [],
        "compared": [_compared(each, "fitted") for each in found.fitted]
        + [_compared(each, "held out") for each in found.held_out],
        "notes": done.notes,
        "parts": _parts(done),
    }
    return dict(_named_alone(whole, f"{Path(str(wanted['data'][0])).parent}/"))


def _named_alone(value: Any, folder: str) -> Any:
    """Return an answer in which recordings are called by their names, not by where this page keeps them."""
    if isinstance(value, dict):
        return {key: _named_alone(inner, folder) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_named_alone(inner, folder) for inner in value]
    return value.replace(folder, "") if isinstance(value, str) else value


def _whole(found: Identified) -> Answer:
    return {
        "figures": figures(found),
        "parameters": _parameters(found),
        "withheld_why": found.withheld,
        "advice": [f"{', '.join(hint.tells)}: {hint.text}" for hint in found.advice],
    }


def _partial(done: IdentifiedFiles, found: StagedValues) -> Answer:
    """Return what stages without the third found: values without intervals."""
    rows = zip(done.task.choice.parameters, done.task.choice.values, found.values, strict=True)
    nothing: Answer = {"identifiable": None, "withheld": False, "low": None, "high": None, "together": []}
    return {
        "figures": partial_figures(done.task, found),
        "parameters": [
            {"name": parameter.name, "unit": parameter.unit, "before": float(before), "found": float(value)} | nothing
            for parameter, before, value in rows
        ],
        "withheld_why": [],
        "advice": ["intervals, and what is not identifiable, come with the third stage"],
    }


def _parameters(found: Identified) -> list[Answer]:
    """Return before, found and interval of each parameter; None for a side that is open."""
    withheld = bool(found.withheld)
    rows = zip(found.verdicts, found.intervals, found.task.choice.parameters, found.task.choice.values, strict=True)
    return [
        {"name": verdict.name, "unit": parameter.unit, "before": float(before), "found": float(verdict.value),
         "identifiable": bool(verdict.identifiable), "withheld": withheld, "low": interval.low, "high": interval.high,
         "together": list(verdict.together)}
        for verdict, interval, parameter, before in rows
    ]  # fmt: skip


def _compared(each: Comparison, role: str) -> Answer:
    rows = thinned(len(each.run.current_a))
    return {
        "name": each.error.name,
        "role": role,
        "rms_current_a": each.error.rms_current_a,
        "noise_a": each.error.noise_a,
        "time_s": rows * each.run.period_s,
        "measured_a": each.run.current_a[rows],
        "simulated_a": each.simulated_a[rows],
    }


def _parts(done: IdentifiedFiles) -> Answer:
    """Return what was written for motor, screen and blades, as data."""
    written = [yaml.safe_load(path.read_text(encoding="utf-8")) for path in done.written]
    screen = written[1] if len(written) > 2 else {}
    return {"motor": written[0], "screen": screen, "blades": written[-1]["plant"].get("blades", {})}


def trained_torque(order: Order, on_progress: OnProgress) -> Answer:
    """Train the torque network, section 6.4.2."""
    from hilplant.reports.torque import TorqueOptions, train_torque

    options = TorqueOptions(
        int(order["neurons"]), int(order["harmonics"]), int(order["starts"]), tuple(order["speeds_rad_s"]),
        int(order["seed"]), int(order["scenarios"]), Path(order["out"]),
        _path(order["data"]), _path(order["validation"]),
    )  # fmt: skip
    return _report(train_torque(order["bench"], options, on_progress), order)


def trained_motor(order: Order, on_progress: OnProgress) -> Answer:
    """Train the motor network, section 6.4.3."""
    from hilplant.reports.motor import MotorOptions, report_motor

    options = MotorOptions(int(order["seed"]), int(order["scenarios"]), Path(order["out"]), tuple(order["data"]))
    return _report(report_motor(order["bench"], options, on_progress), order)


def tabulated(order: Order, _: OnProgress) -> Answer:
    """Tabulate the kinematics, section 6.2."""
    from hilplant.reports.kinematic_tables import train_tables

    return _report(train_tables(order["bench"], float(order["bound"]), Path(order["out"])), order)


def fitted_polynomial(order: Order, _: OnProgress) -> Answer:
    """Fit the no-load torque, section 6.3."""
    from hilplant.reports.polynomial import train_polynomial

    return _report(train_polynomial(order["bench"], Path(order["out"])), order)


def _path(name: str | None) -> Path | None:
    return Path(name) if name else None


def _report(made: TrainingReport, order: Order) -> Answer:
    files = sorted(path.name for path in Path(order["out"]).iterdir() if path.is_file())
    lines = [line.replace(f"{order['out']}/", "") for line in made.lines]
    return {"lines": lines, "figures": made.figures, "kept": made.kept, "files": files}


WORKS: dict[str, Callable[[Order, OnProgress], Answer]] = {
    "identify": identified,
    "torque": trained_torque,
    "motor": trained_motor,
    "tables": tabulated,
    "polynomial": fitted_polynomial,
}


def plain(value: Any) -> Any:
    """Return an answer as JSON takes it; what is no number becomes None."""
    if isinstance(value, dict):
        return {str(key): plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [plain(inner) for inner in value]
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, np.generic):
        return plain(value.item())
    if isinstance(value, float):
        return value if np.isfinite(value) else None
    return str(value) if isinstance(value, Path) else value
