"""Soak in virtual time: plant loop and simulated ECU on an in-memory bus, random driver, supply and weather.

python tests/soak.py --hours 200 --seed 7      # a night; a line each simulated hour, exit code 1 at a broken rule

Checked each simulated minute: outputs are finite, the energy balance closes, the wiper parks when it is switched off,
every frame is sent as often as its cycle says, nothing is counted as wrong, memory stays flat.
"""

import argparse
import random
import resource
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from hilplant.bench import Bench, load_bench
from hilplant.bus.in_memory import InMemoryBus
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.vocabulary import Master, Stalk
from hilplant.models.records import Parameters
from hilplant.models.row import unpack
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.server import build_loop
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, OUTPUTS
from hilplant.units import MILLISECOND_NS, SECOND_NS

ROUND_S = 60
#: At the end of a round the stalk is off and the supply good for so long: time for any wipe to reach park.
PARKING_S = 12
SUPPLIES_V = (9.0, 11.0, 12.5, 13.5, 14.4, 16.0)
FIRST_OUTPUT = 2 + len(INPUTS)
#: Largest part of the energy that may stay unexplained, beyond what jumps of the power between two samples hide.
BALANCE = 0.005
#: A hand that moves the stalk there and back within 0.1 s is counted as `alternating`, as docs/can.md says.
NO_FAULTS = ("tick", "overruns", "worst_latency_us", "alternating")
#: After the first rounds, in which every buffer has its full size.
SETTLED_ROUNDS, MOST_GROWTH_MB = 3, 4.0


@dataclass
class Tape:
    """Takes what a ring takes: inputs and outputs of one round, frames sent by identifier."""

    rows: Any
    line: Any
    frames: Counter[int]
    filled: int = 0
    lost = 0
    recording = 0.0

    def next_row(self) -> Any:
        return self.line

    def commit(self) -> None:
        self.rows[self.filled % len(self.rows)] = self.line[: self.rows.shape[1]]
        self.filled += 1

    def write_frame(self, _tick: int, _bus_ns: int, frame: Any, sent: bool) -> None:
        if sent:
            self.frames[frame.identifier] += 1


class Car:
    """A driver who moves the stalk as chance has it, in weather and on a supply that change."""

    def __init__(self, seed: int) -> None:
        self.chance, self.stalk, self.until_s = random.Random(seed), Stalk(), 0.0
        self.supply_v, self.screen, self.wind_m_s = 13.5, 0.0, 0.0

    def at(self, time_s: float) -> Stalk:
        """Return the stalk; what it is changes at random, and is off at the end of each round."""
        if time_s % ROUND_S >= ROUND_S - PARKING_S:
            self.stalk, self.until_s, self.supply_v, self.wind_m_s = Stalk(), time_s, 13.5, 0.0
        elif time_s >= self.until_s:
            chance = self.chance
            self.stalk = Stalk(Master(chance.randrange(4)), chance.randint(1, 6), chance.random() < 0.1, False)
            self.until_s = time_s + chance.choice([0.05, 0.3, 1.0, 4.0, 12.0])
            self.supply_v, self.screen = chance.choice(SUPPLIES_V), chance.choice([0.0, 0.3, 0.5, 1.0])
            self.wind_m_s = chance.choice([0.0, 0.0, 15.0, 30.0])
        return self.stalk

    def __call__(self, _bus_ns: int, _state: Any, inputs: Any, _parameters: Any) -> bool:
        for name, value in (("supply_v", self.supply_v), ("screen", self.screen), ("vehicle_speed_m_s", self.wind_m_s)):
            inputs[INPUT_INDEX[name]] = value
        return True


def rounds(bench: Bench, seed: int) -> Iterator[tuple[Tape, Any]]:
    """Run for ever; yield after each round what it left, and the loop."""
    bus = InMemoryBus()
    plant, controller = bus.end(), bus.end()
    ticks = ROUND_S * SECOND_NS // bench.step_ns
    tape = Tape(np.zeros((ticks, FIRST_OUTPUT + len(OUTPUTS))), np.zeros(ROW_WIDTH), Counter())
    loop = build_loop(bench, cast("Any", plant), VirtualClock(), cast("Ring", tape))
    car = Car(seed)
    loop.control = car
    ecu = EcuNode(bench.ecu_side(), cast("Any", controller), controller_settings(bench.ecu))
    poll_ticks = round(bench.ecu.period_ms * MILLISECOND_NS / bench.step_ns)
    tick = 0
    while True:
        tape.frames.clear()
        for _ in range(ticks):
            now_ns = tick * bench.step_ns
            loop.tick(now_ns)
            if tick % poll_ticks == 0:
                ecu.poll(now_ns, car.at(now_ns / SECOND_NS))
            tick += 1
        yield tape, loop


def broken_rules(bench: Bench, tape: Tape, loop: Any) -> list[str]:
    """Return what does not hold of a round, one line each."""
    out = {name: tape.rows[:, FIRST_OUTPUT + index] for name, index in OUTPUT_INDEX.items()}
    fast = tape.rows[:, 2 + INPUT_INDEX["relay_fast"]] > 0.5
    found = [f"{name} is not finite" for name, values in out.items() if not np.isfinite(values).all()]
    apart, hidden, scale = unexplained_energy(bench, out, fast)
    if abs(apart) > BALANCE * scale + hidden:
        found.append(f"{apart:.2f} J of {scale:.1f} J are not explained; jumps hide up to {hidden:.2f} J")
    last = -1
    if not (out["park_contact"][last] > 0.5 and abs(out["crank_speed_rad_s"][last]) < 1e-6):
        found.append(f"not parked: {out['crank_angle_rad'][last]:.3f} rad, {out['crank_speed_rad_s'][last]:.3f} rad/s")
    for message in bench.send:
        expected = ROUND_S * SECOND_NS / message.period_ns
        if tape.frames[message.identifier] < int(expected):
            found.append(f"{message.identifier:03X}: {tape.frames[message.identifier]} frames of {expected:.0f}")
    wrong = {name: count for name, count in loop.counts().items() if count and name not in NO_FAULTS}
    return found + ([f"counted: {wrong}"] if wrong else [])


def unexplained_energy(bench: Bench, out: dict[str, Any], fast: Any) -> tuple[float, float, float]:
    """Return energies [J]: neither heat, friction nor work on the load; what jumps may hide; all that came in."""
    motor = unpack(Parameters, bench.parameter_row).motor
    step_s = bench.step_ns / SECOND_NS
    current, speed = out["current_a"], out["motor_speed_rad_s"]
    put_in = out["terminal_v"] * current
    resistance = np.where(fast, motor.fast.resistance_ohm, motor.slow.resistance_ohm)
    friction = motor.damping_n_m_s * speed**2 + motor.coulomb_torque_n_m * np.abs(speed)
    work = out["load_torque_n_m"] * out["crank_speed_rad_s"]
    load = np.where(work > 0.0, work / motor.gear_efficiency, work * motor.gear_back_efficiency)
    apart = np.trapezoid(put_in - resistance * current**2 - friction - load, dx=step_s)
    hidden = 0.5 * step_s * np.abs(np.diff(put_in)).sum()
    return float(apart), float(hidden), float(np.trapezoid(np.abs(put_in), dx=step_s))


def resident_mb() -> float:
    """Return the most memory that this process had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


def soak(bench: Bench, seed: int, minutes: int, tell: Any = None) -> list[str]:
    """Run `minutes` rounds; return the broken rules of the first that has any."""
    settled_mb = 0.0
    for number, (tape, loop) in enumerate(rounds(bench, seed), start=1):
        found = broken_rules(bench, tape, loop)
        if number == SETTLED_ROUNDS:
            settled_mb = resident_mb()
        elif number > SETTLED_ROUNDS and (growth := resident_mb() - settled_mb) > MOST_GROWTH_MB:
            found.append(f"memory grew by {growth:.1f} MB")
        if tell is not None and number % 60 == 0:
            tell(f"{number // 60} h simulated, {tape.filled} ticks, {resident_mb():.0f} MB")
        if found or number >= minutes:
            return [f"seed {seed}, minute {number}: {line}" for line in found]
    return []


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--hours", type=float, default=1.0, help="simulated hours")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--bench", default="default")
    options = parser.parse_args()
    began = time.monotonic()
    found = soak(
        load_bench(options.bench), options.seed, round(60 * options.hours), lambda line: print(line, flush=True)
    )
    print("\n".join(found) or f"{options.hours:g} h simulated in {time.monotonic() - began:.0f} s: all rules held")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
