"""The result as files that a bench can load: a bench over the old one, its motor, and its screen."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from hilplant import resources
from hilplant.arrays import Floats
from hilplant.atomic_write import write_text
from hilplant.bench import Bench
from hilplant.identify.stages import ALL, StagedValues
from hilplant.identify.three_stages import Identified, Task, has_wiper
from hilplant.measurements.measurement import Measurement
from hilplant.models.records import Motor, Parameters
from hilplant.models.row import unpack


class ResultOrigin(NamedTuple):
    """What the files say of where they come from."""

    fitted: tuple[tuple[str, Measurement], ...]  # as they were named, with @dry, @wet ...
    held_out: tuple[tuple[str, Measurement], ...]
    date: str
    seed: int
    search: str


def write_bench(out: Path, found: Identified, origin: ResultOrigin) -> list[Path]:
    """Write OUT.yaml, OUT.motor.yaml and OUT.screen.yaml; they are said to be identified, with intervals."""
    return _write(out, found.task.bench, found.row, _facts(found, origin))


def write_partly(out: Path, task: Task, found: StagedValues, origin: ResultOrigin) -> list[Path]:
    """Write the same files for what some stages found, without intervals; they say which stages."""
    facts = _head(task, found.cost, origin) | {"stages": list(task.stages), "not_told": list(task.choice.names)}
    return _write(out, task.bench, found.row, facts)


def _write(out: Path, bench: Bench, row: Floats, facts: dict[str, Any]) -> list[Path]:
    record = unpack(Parameters, row)
    stem = out.with_suffix("")
    motor, screen = stem.with_name(f"{stem.name}.motor.yaml"), stem.with_name(f"{stem.name}.screen.yaml")
    written: dict[Path, dict[str, Any]] = {motor: _motor(stem.name, record.motor, facts)}
    if has_wiper(bench):
        written[screen] = _screen(bench, stem.name, row, facts)
    written[out] = _bench(bench, out, [path.name for path in written], row)
    head = f"# Identified from measurements, {facts['date']}; `identified` says from which, and how sure it is.\n"
    for path, data in written.items():
        write_text(path, head + yaml.safe_dump(_plain(data), sort_keys=False, allow_unicode=True, width=120))
    return list(written)


def _facts(found: Identified, origin: ResultOrigin) -> dict[str, Any]:
    """Return what the files carry beside their numbers."""
    left = found.solution.noise
    facts = _head(found.task, found.final_cost, origin)
    facts |= {"rms_current_a": left.current_a, "rms_park_edge_s": left.edge_s}
    if found.task.stages != ALL:
        facts["stages"] = list(found.task.stages)
    facts["intervals_95"] = {name: [low, high] for name, (low, high) in found.told_intervals.items()}
    if found.withheld:
        facts["withheld"] = found.withheld
    facts["not_told"] = [verdict.name for verdict in found.verdicts if not verdict.identifiable]
    return facts


def _head(task: Task, cost: float, origin: ResultOrigin) -> dict[str, Any]:
    return {
        "date": origin.date,
        "data": _files(origin.fitted),
        "held_out": _files(origin.held_out),
        "bench": task.bench.name,
        "search": origin.search,
        "seed": origin.seed,
        "cost": cost,
    }


def _files(measurements: tuple[tuple[str, Measurement], ...]) -> list[dict[str, str]]:
    return [{"file": name, "sha256": data.sha256} for name, data in measurements]


def _document(name: str, facts: dict[str, Any], what: str) -> dict[str, Any]:
    files = ", ".join(entry["file"] for entry in facts["data"])
    text = f"{what} identified from {files}. Values under `not_told` are what the search left them at, not findings."
    return {"name": name, "source": text, "status": "identified", "identified": facts}


def _motor(name: str, motor: Motor, facts: dict[str, Any]) -> dict[str, Any]:
    numbers = {key: value for key, value in motor._asdict().items() if key not in ("slow", "fast")}
    brushes = {key: brush._asdict() for key, brush in (("slow", motor.slow), ("fast", motor.fast))}
    return _document(f"{name} motor", facts, "Motor") | brushes | numbers


def _screen(bench: Bench, name: str, row: Floats, facts: dict[str, Any]) -> dict[str, Any]:
    friction = unpack(Parameters, row).load.friction._asdict()
    groups: dict[str, dict[str, float]] = {"dry": {}, "wet": {}, "tacky": {}}
    for key, value in friction.items():
        if (kind := key.split("_")[0]) in groups:
            groups[kind][f"mu_{key}"] = float(value)
    angle = bench.plant.screen.from_vertical_rad if bench.plant.screen is not None else 0.0
    head = {"angle_rad": angle, "angle_from": "vertical", "velocity_limit_mm_s": float(friction["velocity_limit_mm_s"])}
    return _document(f"{name} screen", facts, "Friction") | head | groups


def _bench(bench: Bench, out: Path, parts: list[str], row: Floats) -> dict[str, Any]:
    shipped = bench.path.resolve().parent == resources.shipped("config", "benches").resolve()
    base = bench.path.name if shipped else str(bench.path.resolve())
    load = unpack(Parameters, row).load
    sides = {}
    for side, blade, entry in zip(
        ("left", "right"), (load.left_blade, load.right_blade), bench.plant.blades or (), strict=False
    ):
        written = entry.model_dump(exclude_unset=True) | blade._asdict()
        sides[side] = written
    plant: dict[str, Any] = dict(zip(("motor", "screen"), parts, strict=False))
    if not has_wiper(bench):
        return {"name": out.stem, "extends": base, "plant": plant}
    return {"name": out.stem, "extends": base, "plant": plant | ({"blades": sides} if sides else {})}


def _plain(value: Any) -> Any:
    """Return the same with lists for tuples and floats for numpy's, which YAML knows."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, tuple | list):
        return [_plain(inner) for inner in value]
    return float(value) if isinstance(value, np.floating) else value
