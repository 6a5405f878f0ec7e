"""What one tick of the server costs, from the first frame taken to the last frame sent.

Beside it the same number of frames through the bus alone, and a tick without a bus, in turn. A peer sends and
drains outside the measured time. Ticks follow each other without a pause: their own work alone is measured.
"""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from hilplant.bench import Bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import Transport
from hilplant.perf.busy_bus import (
    FRAMES_IN,
    FRAMES_OUT,
    VIRTUAL,
    Peer,
    both_ends,
    busy_bench,
    silent_bench,
)
from hilplant.perf.daemon_run import PRIORITY, chosen_cpu
from hilplant.perf.results import NotMeasurable, PartResult, Row
from hilplant.perf.samples import quantile
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.scheduling import real_time
from hilplant.runtime.server import build_loop
from hilplant.units import MICROSECOND_NS

_ROUNDS = 10
_TICKS = 1000
_UNCOUNTED = 100
_MOST_FRAMES = 100

Action = Callable[[int], None]
#: p50 and p99 [us] of the whole tick, of the bus alone, of a recorded tick and of one without frames.
Times = dict[str, tuple[float, float]]


def measure() -> PartResult:
    """Measure on python-can's in-memory bus."""
    return tick_part(tick_times(VIRTUAL), "tick", "in-memory bus")


def tick_part(times: Times, key: str, bus: str) -> PartResult:
    """Turn the times into rows and figures; `key` begins the names of the figures."""
    measured = PartResult(remarks=[f"{FRAMES_IN} frames in and {FRAMES_OUT} out in every tick"])
    for index, name in enumerate(("p50", "p99")):
        whole, bare = times["tick"][index], times["bus"][index]
        measured.rows.append(Row(f"{bus}, {name}", whole, "us", bare, "frames alone"))
        measured.figures |= {
            f"{key}_{name}_us": whole,
            f"{key}_bus_{name}_us": bare,
            f"{key}_{name}_ratio_to_bus": whole / bare,
        }
    for subject, what in (("recorded", "the same, recorded"), ("silent", "without frames")):
        for index, name in enumerate(("p50", "p99")):
            measured.rows.append(Row(f"{what}, {name}", times[subject][index], "us"))
            measured.figures[f"{key}_{subject}_{name}_us"] = times[subject][index]
    return measured


def tick_times(interface: dict[str, Any], rounds: int = _ROUNDS) -> Times:
    """Measure on the given interface in turn, as punctually as this process may be."""
    bench = busy_bench()
    with both_ends(interface) as ends, _ring() as ring, real_time(PRIORITY, chosen_cpu()):
        peer = Peer(bench, ends.peer)
        loop = build_loop(bench, ends.plant, VirtualClock())
        recorded = build_loop(bench, ends.plant, VirtualClock(), ring)
        silent = build_loop(silent_bench(), ends.plant, VirtualClock())
        subjects: dict[str, tuple[Action, Peer | None]] = {
            "tick": (lambda tick: loop.tick(tick * bench.step_ns), peer),
            "bus": (_exchange(bench, ends.plant), peer),
            "recorded": (lambda tick: recorded.tick(tick * bench.step_ns), peer),
            "silent": (lambda tick: silent.tick(tick * bench.step_ns), None),
        }
        samples: dict[str, list[int]] = {name: [] for name in subjects}
        for turn in range(rounds):
            for name, (action, partner) in subjects.items():
                samples[name] += _timed(action, turn * (_TICKS + _UNCOUNTED), partner)
    _check_counts(loop.counts())
    _check_counts(recorded.counts())
    return {name: _p50_and_p99_us(sorted(times)) for name, times in samples.items()}


@contextmanager
def _ring() -> Iterator[Ring]:
    """Give a ring that nobody drains: the loop writes to it all the same."""
    ring = Ring.create(ROW_WIDTH)
    try:
        yield ring
    finally:
        ring.close()


def _exchange(bench: Bench, plant: Transport) -> Action:
    """Return what takes in and sends as many frames as a tick, without looking at them."""
    frames = [Frame(message.identifier, bytes(message.length), message.extended) for message in bench.send]

    def exchange(_tick: int) -> None:
        plant.receive(_MOST_FRAMES)
        for frame in frames:
            plant.send(frame)

    return exchange


def _timed(action: Action, first_tick: int, peer: Peer | None) -> list[int]:
    """Return the times of `action` [ns], with the peer's work between them; the first few do not count."""
    samples = []
    for tick in range(first_tick, first_tick + _TICKS + _UNCOUNTED):
        if peer is not None:
            peer.send()
        begin = time.perf_counter_ns()
        action(tick)
        samples.append(time.perf_counter_ns() - begin)
        if peer is not None and (frames := peer.take(FRAMES_OUT)) != FRAMES_OUT:
            raise NotMeasurable(f"{frames} frames came out of tick {tick}, not {FRAMES_OUT}")
    return samples[_UNCOUNTED:]


def _check_counts(counts: dict[str, int]) -> None:
    refused = {name: count for name, count in counts.items() if count and name != "tick"}
    if refused:
        raise NotMeasurable(f"the plant did not take every frame: {refused}")


def _p50_and_p99_us(ordered: list[int]) -> tuple[float, float]:
    return quantile(ordered, 0.5) / MICROSECOND_NS, quantile(ordered, 0.99) / MICROSECOND_NS
