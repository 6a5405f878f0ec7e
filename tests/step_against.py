"""The step of this checkout beside that of another one: the same bits where all additions are off, and what it costs.

::

    python tests/step_against.py TREE             # bits over the benches of both, cost with all off and on, a minute
    python tests/step_against.py TREE --only bits

Each tree runs in a process of its own; short blocks follow each other in turn. A figure is the quotient of CPU times
of blocks side by side: the median over all rounds, and the quotient of the least times.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

OWN = Path(__file__).parents[1]
TICKS, BLOCK, ROUNDS, MINUTES = 60_000, 6_000, 300, 15
#: Goals: the step with all additions off, and with all on, as parts of the other's.
OFF, ON = 1.02, 1.6
#: What a stalled motor presses with was 0 once: compared while the motor turns.
STANDING = "load_torque_n_m"
#: Every addition at once, as a bench may have them; the play is that of a sound linkage.
ALL_ON = """extends: default.yaml
name: all_on
plant:
  supply: {resistance_ohm: 0.15}
  wires: {terminal_53_ohm: 0.02, terminal_53b_ohm: 0.02, terminal_31_ohm: 0.02}
  relays: {relay_on: {operate_ms: 5, release_ms: 3, transfer_ms: 1}, relay_fast: {operate_ms: 5, release_ms: 3}}
  heat: {winding_j_k: 150, case_j_k: 450, winding_to_case_w_k: 0.6, case_to_ambient_w_k: 0.4, trip_c: 150, reset_c: 110}
  obstacles: {left: {above: {angle_deg: 140, stiffness_n_m_rad: 5}}}
  backlash: {angle_deg: 0.5}
  wear: {blades_percent: 0.05, brushes_ohm: 0.0002, cam_deg: 0.002}
  water: {runoff_percent_s: 1, wiped_percent: 70, washer_mm_s: 0.2, evaporation_mm_h: 0.5, sensor_mm: 0.1, dry_mm: 0.01,
          tacky_mm: 0.03, wet_mm: 0.06}
"""
SCENARIO = """seconds: 60
signals:
  relay_on: [[0, false], [1, true], [26, false], [30, true], [44, false], [46, true], [58, false]]
  relay_fast: [[0, false], [14, true], [26, false], [34, true], [44, false]]
  supply_v: [[0, 13.5], [8, {ramp_to: 9.0, seconds: 0.5}], [10, {ramp_to: 13.5, seconds: 0.5}]]
  screen: [[0, dry], [12, {ramp_to: wet, seconds: 8}], [38, tacky], [42, wet]]
  vehicle_speed_m_s: [[0, 0.0], [20, {ramp_to: 30.0, seconds: 5}], [48, {ramp_to: 0.0, seconds: 4}]]
"""
DRAWN = {
    "relay_on": [0.0, 1.0, 1.0], "relay_fast": [0.0, 1.0], "supply_v": [0.0, 9.0, 12.0, 13.5, 16.0, 25.0],
    "screen": [0.0, 0.3, 0.5, 0.8, 1.0], "vehicle_speed_m_s": [0.0, 15.0, 40.0],
    "brake_torque_n_m": [0.0, 0.0, 0.0, 5.0, 300.0], "left_screen": [-1.0, -1.0, 0.0, 1.0],
    "left_wear": [1.0, 1.0, 2.0],
    "right_force": [1.0, 1.0, 0.5],
}  # fmt: skip


class Side:
    """A tree in a process of its own, which does one thing after the other."""

    def __init__(self, tree: Path) -> None:
        environment = os.environ | {"PYTHONPATH": str(tree)}
        self._process = subprocess.Popen([sys.executable, __file__, "--worker"], stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, text=True, cwd=tree, env=environment)  # fmt: skip

    def ask(self, *words: Any) -> Any:
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(json.dumps(words) + "\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise SystemExit(f"a tree ended at {words}")
        return json.loads(answer)


def worker() -> None:
    """Answer questions line by line in the tree that PYTHONPATH names."""
    import time
    from dataclasses import is_dataclass

    import numpy as np

    from hilplant import load_bench, simulate
    from hilplant.models.plant import simulate_rows
    from hilplant.signals import INPUTS, OUTPUTS

    columns, shown = [signal.name for signal in INPUTS], [signal.name for signal in OUTPUTS]
    kept: dict[str, Any] = {}

    def rows(bench: Any, ticks: int) -> Any:
        random = np.random.default_rng(20)
        found = np.tile(bench.input_row, (ticks, 1))
        for name, values in DRAWN.items():
            first = 0
            while first < ticks:
                last = first + int(random.integers(20, 2500))
                found[first:last, columns.index(name)] = values[int(random.integers(len(values)))]
                first = last
        return found

    def bits(name: str, path: str) -> list[str]:
        bench = load_bench(name)
        outputs = np.empty((TICKS, len(shown)))
        simulate_rows(bench.state_row.copy(), rows(bench, TICKS), bench.parameter_row, bench.tables, outputs)
        np.save(path, outputs)
        return shown

    def prepare(name: str) -> bool:
        bench = load_bench(name)
        outputs = np.empty((BLOCK, len(shown)))
        kept[name] = (bench, bench.state_row.copy(), rows(bench, 10 * BLOCK), outputs, [0])
        return is_dataclass(bench)

    def block(name: str) -> float:
        bench, state, inputs, outputs, at = kept[name]
        part = inputs[at[0] : at[0] + BLOCK]
        at[0] = (at[0] + BLOCK) % len(inputs)
        begin = time.process_time_ns()
        simulate_rows(state, part, bench.parameter_row, bench.tables, outputs)
        return (time.process_time_ns() - begin) / BLOCK

    def minute(path: str) -> float:
        begin = time.process_time_ns()
        simulate("default", path)
        return (time.process_time_ns() - begin) * 1e-6

    tasks = {"bits": bits, "prepare": prepare, "block": block, "minute": minute}
    for line in sys.stdin:
        task, *words = json.loads(line)
        print(json.dumps(tasks[task](*words)), flush=True)


def same_bits(own: Side, other: Side, tree: Path, folder: Path) -> bool:
    """Run every bench that both trees have; print which columns differ."""
    import numpy as np

    names = sorted({p.stem for p in (OWN / "config/benches").glob("*.yaml")}
                   & {p.stem for p in (tree / "config/benches").glob("*.yaml")})  # fmt: skip
    equal = 0
    for name in names:
        lists = [side.ask("bits", name, str(folder / f"{k}.npy")) for k, side in enumerate((own, other))]
        ours, theirs = (np.load(folder / f"{k}.npy") for k in range(2))
        both = [column for column in lists[1] if column in lists[0]]
        turns = ours[:, lists[0].index("motor_speed_rad_s")] != 0.0
        differ = []
        for column in both:
            looked_at = turns if column == STANDING else np.ones(len(ours), np.bool_)
            pair = ours[looked_at, lists[0].index(column)], theirs[looked_at, lists[1].index(column)]
            if pair[0].tobytes() != pair[1].tobytes():
                differ.append(column)
        equal += not differ
        print(f"{name}: {len(both)} of {len(lists[1])} outputs, {len(ours)} ticks: {differ or 'equal to the last bit'}")
    print(f"{equal} of {len(names)} benches equal to the last bit, {equal * TICKS} ticks")
    return equal == len(names)


def cost(own: Side, other: Side, folder: Path) -> bool:
    """Print what a step costs with all additions off and on, in parts of the other's."""
    (folder / "all_on.yaml").write_text(ALL_ON, encoding="utf-8")
    on = str(folder / "all_on.yaml")
    ways = [(other, "default"), (own, "default"), (own, on)]
    for side, name in ways:
        side.ask("prepare", name)
    found: list[list[float]] = [[], [], []]
    for number in range(ROUNDS):
        for k in ((0, 1, 2), (2, 1, 0))[number % 2]:
            found[k].append(ways[k][0].ask("block", ways[k][1]))
    good = True
    for name, values, goal in (("off", found[1], OFF), ("on", found[2], ON)):
        ratio = statistics.median(a / b for a, b in zip(values, found[0], strict=True))
        least = statistics.median(_least(values, k) / _least(found[0], k) for k in range(10))
        print(f"all additions {name}: {least:.3f} of the other's step by least times, {ratio:.3f} median; "
              f"goal {goal}; {min(values):.0f} ns beside {min(found[0]):.0f} ns")  # fmt: skip
        good = good and least <= goal
    return good


def _least(values: list[float], block: int) -> float:
    """Return the least time of one of the ten blocks."""
    return min(values[block::10])


def minutes(own: Side, other: Side, folder: Path) -> bool:
    """Print what `simulate` takes for 60 s of the default bench."""
    (folder / "minute.yaml").write_text(SCENARIO, encoding="utf-8")
    found: list[list[float]] = [[], []]
    for _ in range(MINUTES):
        for k, side in enumerate((own, other)):
            found[k].append(side.ask("minute", str(folder / "minute.yaml")))
    ours, theirs = min(found[0]), min(found[1])
    middle = statistics.median(a / b for a, b in zip(*found, strict=True))
    print(
        f"60 s of the default bench, bench and scenario read: {ours:.0f} ms beside {theirs:.0f} ms, median {middle:.3f}"
    )
    return ours <= theirs


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tree", nargs="?", type=Path)
    parser.add_argument("--only", choices=("bits", "cost", "minute"))
    parser.add_argument("--worker", action="store_true")
    given = parser.parse_args()
    if given.worker:
        worker()
        return
    own, other = Side(OWN), Side(given.tree)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        checks = {"bits": lambda: same_bits(own, other, given.tree, folder), "cost": lambda: cost(own, other, folder),
                  "minute": lambda: minutes(own, other, folder)}  # fmt: skip
        good = [check() for name, check in checks.items() if given.only in (None, name)]
    raise SystemExit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
