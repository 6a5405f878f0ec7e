"""When the loop sends, and what a late tick leads to, in virtual time."""

from dataclasses import replace
from itertools import pairwise

import pytest
from support.loop_rig import (
    STEP_NS,
    ListedTransport,
    Rig,
)

from hilplant.bus.codec import SentMessage
from hilplant.bus.frame import Frame
from hilplant.runtime import loop as loop_module
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import FIRST_STATUS, ROW_WIDTH
from hilplant.runtime.server import StopRequest, build_loop
from hilplant.runtime.watchdog import Watchdog
from hilplant.signals import MODES, PUBLISHED, STATUS_INDEX
from hilplant.units import SECOND_NS


class LateClock(VirtualClock):
    """Comes so much too late once, at the hundredth tick."""

    def __init__(self, late_ns: int) -> None:
        super().__init__()
        self._late_ns = late_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        super().sleep_until_ns(deadline_ns)
        if deadline_ns == 101 * STEP_NS:
            self.time_ns += self._late_ns


@pytest.fixture
def rig() -> Rig:
    return Rig()


def periods_ms(rig: Rig, message: SentMessage, ticks: int) -> list[int]:
    """Tick on and return the times between the frames of one message [ms]."""
    times = []
    for _ in range(ticks):
        before = len(rig.transport.sent)
        rig.tick()
        times += [rig.now for frame in rig.transport.sent[before:] if frame.identifier == message.identifier]
    return [later - earlier for earlier, later in pairwise(times)]


def test_each_message_comes_at_the_cycle_time_of_the_database(rig: Rig) -> None:
    truth = {"MotorStatus": 10, "ParkSwitch": 20, "Linkage": 10, "PlantStatus": 100, "FrameFaults": 1000}
    for message in rig.bench.send:
        if message.name in truth:
            assert set(periods_ms(rig, message, 3500)) == {truth[message.name]}


def test_late_ticks_are_counted_and_their_periods_skipped_not_stretched(rig: Rig) -> None:
    loop = build_loop(rig.bench, ListedTransport(), LateClock(7_300_000))
    loop.run(1000, StopRequest(), Watchdog())
    assert loop.progress.overruns == 7
    assert loop.progress.ticks == 993
    assert loop.latency.worst_ns == 7_300_000


def test_the_last_row_comes_a_period_after_the_last_tick_and_says_stopped(rig: Rig) -> None:
    ring = Ring.create(ROW_WIDTH)
    build_loop(rig.bench, ListedTransport(), VirtualClock(), ring).run(100, StopRequest(), Watchdog())
    rows = ring.latest(), ring.read_rows()
    ring.close()
    assert rows[1][:, 1].tolist() == [tick * STEP_NS for tick in range(100)]
    assert [rows[0][0], rows[0][FIRST_STATUS + STATUS_INDEX["mode"]]] == [99, MODES.index("stopped")]


def test_a_worst_latency_beyond_what_its_frame_carries_is_no_fault(rig: Rig) -> None:
    rig.loop.latency.add(70_000_000)
    rig.tick(201)
    assert rig.counts() == {"worst_latency_us": 70_000}


@pytest.mark.parametrize(("policy", "stops"), [("count", False), ("degrade", False), ("stop", True)])
def test_the_bench_decides_what_a_late_tick_leads_to(rig: Rig, policy: str, stops: bool) -> None:
    bench = replace(rig.bench, loop=rig.bench.loop.model_copy(update={"on_overrun": policy}))
    loop = build_loop(bench, ListedTransport(), LateClock(5_000_000))
    loop.run(1000, StopRequest(), Watchdog())
    assert loop.progress.stopped_by_overrun is stops
    assert (loop.progress.ticks < 200) is stops


def test_after_a_late_tick_the_loop_is_degraded_for_a_second_and_takes_fewer_frames(rig: Rig) -> None:
    bench = replace(rig.bench, loop=rig.bench.loop.model_copy(update={"on_overrun": "degrade"}))
    wire, limits, ring = ListedTransport(), [], Ring.create(ROW_WIDTH)
    loop = build_loop(bench, wire, LateClock(5_000_000), ring)

    def receive(limit: int) -> list[Frame]:
        limits.append(limit)
        return []

    wire.receive = wire.receive_late = receive  # type: ignore[method-assign, assignment]
    loop._node._supervised.clear()  # nobody waits for commands here
    loop._node.lost = False
    loop.run(1500, StopRequest(), Watchdog())
    most = bench.loop.frames_per_tick
    changes = [tick for tick, (before, after) in enumerate(pairwise(limits), 1) if before != after]
    assert [limits[0], *(limits[tick] for tick in changes)] == [most, most // 4, most]
    assert changes[1] - changes[0] == SECOND_NS // STEP_NS
    modes, late_us = ring.read_rows()[:, FIRST_STATUS + STATUS_INDEX["mode"]], ring.late_us(len(limits) + 1).tolist()
    ring.close()
    assert [tick for tick, mode in enumerate(modes) if MODES[int(mode)] == "degraded"] == list(range(*changes))
    assert [tick for tick, late in enumerate(late_us) if late] == changes[:1] and max(late_us) == 5000


def test_the_count_of_ticks_begins_again_where_its_frame_ends(rig: Rig) -> None:
    rig.loop.progress.ticks = 2**32 - 60
    rig.tick(150)
    ticks = [int.from_bytes(f.data[:4], "little") for f in rig.transport.sent if f.identifier == 0x210]
    assert ticks[0] == 2**32 - 60
    assert ticks[-1] == 100 - 60
    assert rig.counts() == {}


def test_the_warm_up_calls_what_a_tick_calls_and_changes_nothing(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    stepped, rehearsed = [], []
    monkeypatch.setattr(loop_module, "plant_tick", lambda *arguments: stepped.append(arguments[0]))
    monkeypatch.setattr(rig.loop._node, "rehearse", lambda values: rehearsed.append(len(values)))
    rig.loop.warm_up()
    assert len(stepped) == 1 and stepped[0] is not rig.loop._state
    assert rehearsed == [len(PUBLISHED)]
