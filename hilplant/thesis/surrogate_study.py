"""Which model to choose: all loads and motors through the same minute, and through ten minutes on the bus."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench, load_bench
from hilplant.models.load import LOADS
from hilplant.models.narx import NETWORK
from hilplant.models.plant import simulate_rows
from hilplant.models.row import pack
from hilplant.perf.c_step import compile_step
from hilplant.perf.networks_cost import calm_minute
from hilplant.perf.samples import alternate
from hilplant.perf.step_cost import timed_s
from hilplant.plots.surrogates import Mark, plot_surrogates
from hilplant.signals import OUTPUT_INDEX, OUTPUTS
from hilplant.simulation.bus_run import BusRun, drive
from hilplant.units import SECOND_NS

#: The physical plant at steps this much shorter is the truth of the minute.
FINER = 20
#: A surrogate's current may be off by this part of its range, its stops by this angle.
CURRENT_GOAL, ANGLE_GOAL_DEG = 0.03, 1.0
_ROUNDS = 20
_CURRENT = OUTPUT_INDEX["current_a"]


@dataclass(frozen=True, slots=True)
class Compared:
    """One model: cost (best round) and accuracy over a minute, and what differs from the physical plant on the bus."""

    name: str
    step_ns: float
    c_step_ns: float
    current_rms_a: float
    current_range_a: float
    stops: int
    stops_of_physical: int
    worst_angle_deg: float  # not-a-number where the counts differ
    bus_current_share: float  # RMS error of the current as part of its range
    same_frames: bool
    load_in_charge: float
    motor_in_charge: float

    @property
    def kept(self) -> bool:
        """Whether the ECU sees no difference: frames, stops, angles and current within the goals."""
        stops = self.stops == self.stops_of_physical and self.worst_angle_deg < ANGLE_GOAL_DEG
        return self.same_frames and stops and self.bus_current_share < CURRENT_GOAL


@dataclass(frozen=True, slots=True)
class Pair:
    """A bench, and the one with the physics that it stands for."""

    bench: Bench
    physical: Bench


def models() -> dict[str, Pair]:
    """Return the benches by name; the motor network is that of the bench with all networks.

    The polynomials stand for a linkage without arms and blades, everything else for the whole wiper.
    """
    default, alone, all_networks = load_bench("default"), load_bench("linkage_alone"), load_bench("networks")
    networks = all_networks.parameters.networks
    motor = np.concatenate([[0.0], networks[1 + int(networks[0]) :]])
    return {
        "reduced": Pair(default, default),
        "none": Pair(_with(default, load=default.parameters.load._replace(model=float(LOADS.index("none")))), default),
        "torque network": Pair(load_bench("network"), default),
        "motor network": Pair(_with(default, motor_model=1.0, networks=motor), default),
        "all networks": Pair(all_networks, default),
        "linkage alone": Pair(alone, alone),
        "polynomial": Pair(load_bench("polynomial"), alone),
        "own polynomial": Pair(load_bench("linkage_alone_polynomial"), alone),
    }


def _with(bench: Bench, **changed: Any) -> Bench:
    parameters = bench.parameters._replace(**changed)
    return replace(bench, parameters=parameters, parameter_row=pack(parameters))


def compare(seconds: float) -> list[Compared]:
    """Compare all models; `seconds` is how long each drives the bus."""
    pairs = models()
    physical = {bench.name: bench for bench in (pair.physical for pair in pairs.values())}
    truths = {name: finer_current(bench) for name, bench in physical.items()}
    runs = {name: drive(bench, seconds, look_ms=1.0) for name, bench in physical.items()}
    found = []
    in_c = compile_step()
    for name, pair in pairs.items():
        wanted = runs[pair.physical.name]
        ours = wanted if pair.bench is pair.physical else drive(pair.bench, seconds, look_ms=1.0)
        found.append(_compared(name, pair.bench, in_c, truths[pair.physical.name], ours, wanted))
    return found


def _compared(  # noqa: PLR0913, PLR0917
    name: str, bench: Bench, in_c: Any, truth: Floats, ours: BusRun, physical: BusRun
) -> Compared:
    inputs = calm_minute(bench)
    outputs = np.empty((len(inputs), len(OUTPUTS)))

    def timed(way: Any) -> float:
        return timed_s(way, bench, inputs, outputs) / len(inputs) * SECOND_NS

    theirs, mine = alternate(_ROUNDS, lambda: timed(in_c), lambda: timed(simulate_rows))
    stops, wanted = ours.stops(), physical.stops()
    angle = float(np.degrees(np.abs(stops - wanted)).max()) if len(stops) == len(wanted) else float("nan")
    error = np.sqrt(np.mean((ours["current_a"] - physical["current_a"]) ** 2)) / np.ptp(physical["current_a"])
    return Compared(
        name=name,
        step_ns=min(mine),
        c_step_ns=min(theirs),
        current_rms_a=float(np.sqrt(np.mean((outputs[:, _CURRENT] - truth) ** 2))),
        current_range_a=float(np.ptp(truth)),
        stops=len(stops),
        stops_of_physical=len(wanted),
        worst_angle_deg=angle,
        bus_current_share=float(error),
        same_frames=set(ours.frames) == set(physical.frames),
        load_in_charge=float((ours["load_mode"] == NETWORK).mean()),
        motor_in_charge=float((ours["motor_mode"] == NETWORK).mean()),
    )


def finer_current(bench: Bench) -> Floats:
    """Return the current of the minute at each tick from steps that are `FINER` times shorter."""
    inputs = np.repeat(calm_minute(bench), FINER, axis=0)
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    row = pack(bench.parameters._replace(step_s=bench.parameters.step_s / FINER))
    simulate_rows(bench.state_row.copy(), inputs, row, bench.tables, outputs)
    return outputs[::FINER, _CURRENT].copy()


def lines(compared: list[Compared], seconds: float) -> list[str]:
    """Return the table for a terminal."""
    goals = f"{100.0 * CURRENT_GOAL:g} % of the current's range, {ANGLE_GOAL_DEG:g} deg"
    head = (
        "against the physics that each stands for: a calm minute, there with steps "
        f"{FINER} times shorter, and {seconds:g} s on the bus (goals: {goals})"
    )
    rows = [head, f"{'':16}{'step':>9}{'to C':>7}{'current RMS':>16}{'stops':>10}{'angle':>10}{'current':>10}"
                  f"{'active':>17}{'kept':>6}"]  # fmt: skip
    for one in compared:
        angle = "-" if np.isnan(one.worst_angle_deg) else f"{one.worst_angle_deg:.2f} deg"
        charge = f"{100.0 * one.load_in_charge:.0f} %, {100.0 * one.motor_in_charge:.0f} %"
        rows.append(
            f"{one.name:16}{one.step_ns:6.0f} ns{one.step_ns / one.c_step_ns:7.2f}"
            f"{one.current_rms_a:9.4f} A{100.0 * one.current_rms_a / one.current_range_a:4.1f}%"
            f"{one.stops:6}/{one.stops_of_physical}{angle:>10}{100.0 * one.bus_current_share:8.2f} %{charge:>17}"
            f"{'yes' if one.kept else 'NO':>6}"
        )
    return rows


def plot(compared: list[Compared], path: Path) -> None:
    """Draw accuracy against cost."""
    marks = [Mark(one.name, one.step_ns, one.current_rms_a) for one in compared]
    plot_surrogates(marks, CURRENT_GOAL * compared[0].current_range_a, path)


def all_kept(compared: list[Compared]) -> bool:
    """Say whether every model of a load or motor kept the goals."""
    return all(one.kept for one in compared if one.name != "none")


def figures(compared: list[Compared], seconds: float) -> dict[str, Any]:
    """Return the comparison as flat figures; `seconds` is how long each drove the bus."""
    flat: dict[str, Any] = {"bus_s": seconds}
    for one in compared:
        key = one.name.replace(" ", "_")
        flat |= {
            f"{key}_step_ns": one.step_ns,
            f"{key}_step_ratio_to_c": one.step_ns / one.c_step_ns,
            f"{key}_current_rms_a": one.current_rms_a,
            f"{key}_stops": one.stops,
            f"{key}_worst_angle_deg": None if np.isnan(one.worst_angle_deg) else one.worst_angle_deg,
            f"{key}_bus_current_share": one.bus_current_share,
            f"{key}_kept": one.kept,
        }
    return flat
