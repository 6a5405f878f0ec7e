"""Plant loop and ECU node on an in-memory bus in virtual time, with every tick and frame kept."""

from collections import Counter
from dataclasses import dataclass
from typing import cast

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.bus.frame import Frame
from hilplant.bus.in_memory import InMemoryBus
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import parse_stalk, stalk_at
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.server import build_loop
from hilplant.runtime.tape import Tape
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, OUTPUTS
from hilplant.units import MILLISECOND_NS, SECOND_NS, TURN_RAD

_FIRST_OUTPUT = 2 + len(INPUTS)

#: All stages, ended from each of them, by time [s] within a round; and supply and screen of the rounds in turn.
ROUND = "0.1:slow,2.5:off,5:fast,9:off,12:i1,17:off,19:flick,22:slow,24:fast,26.5:i2,29:slow,31:off"
ROUND_S = 37.5
WEATHER = ((13.5, 0.0), (13.5, 1.0), (11.0, 1.0), (15.0, 0.0))


class _Outputs(Tape):
    """A tape for long runs: it keeps outputs, and counts frames by identifier, length and direction."""

    def __init__(self, ticks: int) -> None:
        super().__init__()
        self.outputs = np.empty((ticks, len(OUTPUTS)))
        self.counted: Counter[tuple[int, int, bool]] = Counter()

    def next_rows(self, count: int) -> Floats:
        return self._rows[:count]

    def commit(self, count: int = 1) -> None:
        outputs = self._rows[:count, _FIRST_OUTPUT : _FIRST_OUTPUT + len(OUTPUTS)]
        self.outputs[self.ticks : self.ticks + count] = outputs
        self.ticks += count

    def write_frame(self, tick: int, bus_ns: int, frame: Frame, sent: bool) -> None:
        self.counted[frame.identifier, len(frame.data), sent] += 1


@dataclass(frozen=True, slots=True)
class BusRun:
    """What a run on the bus left: outputs of each tick, and frames counted by identifier, length and direction."""

    step_s: float
    outputs: Floats
    frames: Counter[tuple[int, int, bool]]

    def __getitem__(self, name: str) -> Floats:
        """Return an output by its name."""
        column: Floats = self.outputs[:, OUTPUT_INDEX[name]]
        return column

    def stops(self) -> Floats:
        """Return the crank angles at which it came to rest with the park contact closed, within half a turn of 0."""
        resting = (self["crank_speed_rad_s"] == 0.0) & (self["park_contact"] > 0.5)
        begins = np.flatnonzero(resting[1:] & ~resting[:-1]) + 1
        angle = self["crank_angle_rad"][begins]
        wrapped: Floats = np.mod(angle + 0.5 * TURN_RAD, TURN_RAD) - 0.5 * TURN_RAD
        return wrapped

    @property
    def turns(self) -> float:
        """How far the crank came."""
        return float(np.ptp(np.unwrap(self["crank_angle_rad"]))) / TURN_RAD


def drive(bench: Bench, seconds: float, look_ms: float | None = None) -> BusRun:
    """Let the stand-in ECU drive a bench through rounds of all stages, each with a supply and a screen of its own.

    `look_ms` is how often the ECU looks at what it heard, its own period when left out. The crank turns by up to 2
    degrees in the shipped 5 ms, so that two plants that are a hair apart may stop by that much apart.
    """
    bus = InMemoryBus()
    ticks = round(seconds * SECOND_NS / bench.step_ns)
    tape = _Outputs(ticks)
    weather = _Weather(bench)
    loop = build_loop(bench, bus.end(), VirtualClock(), cast("Ring", tape))
    loop.control = weather
    ecu = EcuNode(bench.ecu_side(), bus.end(), controller_settings(bench.ecu))
    poll_ticks = round((look_ms or bench.ecu.period_ms) * MILLISECOND_NS / bench.step_ns)
    moves = parse_stalk(ROUND)
    for tick in range(ticks):
        now_ns = tick * bench.step_ns
        loop.tick(now_ns)
        if tick % poll_ticks == 0:
            ecu.poll(now_ns, stalk_at(moves, now_ns / SECOND_NS % ROUND_S))
    return BusRun(bench.step_ns / SECOND_NS, tape.outputs, tape.counted)


class _Weather:
    """Sets supply and screen of the round; stands where a controller inside the loop would."""

    def __init__(self, bench: Bench) -> None:
        self._supply, self._screen = INPUT_INDEX["supply_v"], INPUT_INDEX["screen"]

    def __call__(self, bus_ns: int, _state: Floats, inputs: Floats, _parameters: Floats) -> bool:
        supply_v, screen = WEATHER[int(bus_ns / SECOND_NS // ROUND_S) % len(WEATHER)]
        inputs[self._supply], inputs[self._screen] = supply_v, screen
        return True
