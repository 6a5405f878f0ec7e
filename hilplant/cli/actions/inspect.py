"""Reads a measurement, prints what is wrong with it, and what stage 1 finds in it."""

from pathlib import Path
from typing import Any, NamedTuple

import typer

from hilplant.failure import Failure
from hilplant.identify.first_stage import ModeResult, first_stage
from hilplant.identify.transfer_function import Equivalent
from hilplant.measurements.checks import examine
from hilplant.measurements.columns import parse_columns
from hilplant.measurements.files import Origin
from hilplant.measurements.frames import frame_source
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.park import rising_edges
from hilplant.measurements.preparation import Preparation, read_measurement
from hilplant.motor_bench.bench_measurements import quantity


class Inspection(NamedTuple):
    """What to inspect; `frames` is the bus database or the bench that reads a file of CAN frames."""

    path: Path
    columns: str
    frames: str | None
    mode: str | None
    gear_ratio: float


def inspect_data(asked: Inspection) -> tuple[bool, dict[str, Any]]:
    """Print everything about a measurement; return whether it will do, and the figures."""
    path = asked.path
    origin = Origin(path, None, frame_source(asked.frames))
    data = read_measurement(origin, parse_columns(asked.columns), Preparation(mode=asked.mode))
    findings = examine(data)
    typer.echo(f"{path}: {len(data)} samples, {data.time_s[-1]:.4g} s, {len(rising_edges(data.park))} park edges")
    for note in data.notes:
        typer.echo(f"  {note}")
    for finding in findings:
        typer.echo(f"{path}: {'wrong' if finding.fatal else 'note'}: {finding.text}", err=True)
    good = not any(finding.fatal for finding in findings)
    figures: dict[str, Any] = {"samples": len(data), "findings": [finding.name for finding in findings]}
    if good:
        figures |= _motor(data, asked.gear_ratio)
    return good, figures


def _motor(data: Measurement, gear_ratio: float) -> dict[str, Any]:
    """Print stage 1; what it cannot tell is a line, not an error."""
    try:
        results = first_stage(data, gear_ratio)
    except Failure as error:
        typer.echo(f"stage 1: {error}")
        return {"stage_1_failure": str(error)}
    figures: dict[str, Any] = {}
    for mode, text in results.failures.items():
        typer.echo(f"stage 1, {mode}: nothing settles: {text}")
        figures[f"{mode}_failure"] = text
    for mode, found in results.items():
        motor = found.by_park or found.by_load
        how = f"{found.turns} turns at ratio {gear_ratio:g}" if found.by_park else "an assumed load"
        how += f" ({found.left_out})" if found.left_out else ""
        typer.echo(f"stage 1, {mode}: from {found.steps} steps of the voltage and {how} (+- standard error)")
        for name, value in zip(Equivalent._fields, map(quantity, motor), strict=True):
            typer.echo(f"  {name:20} {value:.2uP}")
            figures |= {f"{mode}_{name}": value.n, f"{mode}_{name}_standard_error": value.s}
        figures |= _load(mode, found)
    return figures


def _load(mode: str, found: ModeResult) -> dict[str, float]:
    if found.load is None:
        return {}
    damping, dry = map(quantity, found.load)
    typer.echo(f"  mean load at the shaft, motor's friction included: {dry:.2uP} N m + {damping:.2uP} N m s x speed")
    return {f"{mode}_load_torque_n_m": dry.n, f"{mode}_load_damping_n_m_s": damping.n}
