"""Single ticks of the loop that other tests pass over: the last one, the guard's, a late one, the watchdog's."""

from collections import deque
from typing import Any, cast

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import RUNNING, SAFE, STOPPED, Loop
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.server import build_loop
from hilplant.runtime.watchdog import Watchdog
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUTS, STATUS_INDEX

FAST = Frame(0x120, b"\x03\x00")
TIMEOUT_TICKS = 500
STEP_NS = 1_000_000
ON, FAST_ON = 2 + INPUT_INDEX["relay_on"], 2 + INPUT_INDEX["relay_fast"]
MODE = 2 + len(INPUTS) + len(OUTPUTS) + STATUS_INDEX["mode"]


class Line:
    """An interface of lists that hands out a relay command every `period` ticks until `until`."""

    up, missed = True, 0

    def __init__(self, period: int = 50, until: int = 10**9) -> None:
        self.period, self.until, self.tick = period, until, 0
        self.sent: list[Frame] = []

    def receive(self, _limit: int) -> list[Frame]:
        self.tick += 1
        return [FAST] if self.tick <= self.until and (self.tick - 1) % self.period == 0 else []

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, 0) for frame in self.receive(limit)]

    def send(self, frame: Frame) -> SendResult:
        self.sent.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        """Nothing is open."""


class Rows:
    """Takes what a ring takes and keeps each row."""

    lost = recording = 0

    def __init__(self) -> None:
        self.rows: deque[Any] = deque()
        self.line = np.zeros(ROW_WIDTH)

    def next_row(self) -> Any:
        return self.line

    def commit(self) -> None:
        self.rows.append(self.line.copy())

    def write_frame(self, *_: object) -> None:
        """Frames are seen at the interface."""

    def note_late(self, late_us: int) -> None:
        """Lateness is counted by the row."""


class CountedFeeds(Watchdog):
    """A watchdog that systemd would wait for every 300 ms."""

    feeds = 0
    period_ns = 100 * STEP_NS  # type: ignore[assignment]

    def feed(self) -> None:
        self.feeds += 1


def built(line: Line, clock: VirtualClock | None = None) -> tuple[Loop, Rows]:
    rows = Rows()
    return build_loop(load_bench("default"), cast("Any", line), clock or VirtualClock(), cast("Ring", rows)), rows


@pytest.mark.parametrize("ticks", [203, 517, 611])
def test_the_last_tick_opens_both_relays_and_every_message_tells_of_it(ticks: int) -> None:
    line = Line()
    loop, kept = built(line)
    loop.run(ticks, lambda: False, Watchdog())
    *before, last = kept.rows
    assert [before[-1][ON], before[-1][FAST_ON], before[-1][MODE]] == [1.0, 1.0, RUNNING]
    assert [last[ON], last[FAST_ON], last[MODE]] == [0.0, 0.0, STOPPED]
    expected = [message.identifier for message in load_bench("default").send]
    assert [frame.identifier for frame in line.sent[-len(expected) :]] == expected


@pytest.mark.parametrize("until", [1, 51, 130])
def test_lost_commands_open_both_relays_after_the_timeout_until_they_are_back(until: int) -> None:
    line = Line(until=until)
    loop, kept = built(line)
    last_heard = (until - 1) // 50 * 50
    for tick in range(last_heard + TIMEOUT_TICKS + 20):
        loop.tick(tick * STEP_NS)
    relays = [(row[ON], row[FAST_ON]) for row in kept.rows]
    assert set(relays[: last_heard + TIMEOUT_TICKS]) == {(1.0, 1.0)}
    assert set(relays[last_heard + TIMEOUT_TICKS + 2 :]) == {(0.0, 0.0)}
    assert kept.rows[-1][MODE] == SAFE
    line.until = 10**9
    line.period = 1
    loop.tick((last_heard + TIMEOUT_TICKS + 20) * STEP_NS)
    assert (kept.rows[-1][ON], kept.rows[-1][FAST_ON], kept.rows[-1][MODE]) == (1.0, 1.0, RUNNING)


def test_the_guard_shows_in_the_mode_while_commands_are_good() -> None:
    loop, kept = built(Line())
    for tick in range(10):
        loop.tick(tick * STEP_NS)
    assert kept.rows[-1][MODE] == RUNNING
    loop._state[:] = np.nan
    for tick in range(10, 13):
        loop.tick(tick * STEP_NS)
    assert kept.rows[-1][MODE] == SAFE
    assert np.isfinite(kept.rows[-1]).all()


@pytest.mark.parametrize(("ticks", "feeds"), [(100, 0), (102, 1), (1001, 9), (2005, 20)])
def test_the_watchdog_is_fed_at_a_third_of_its_patience_and_not_in_every_tick(ticks: int, feeds: int) -> None:
    loop, _ = built(Line())
    watchdog = CountedFeeds()
    loop.run(ticks, lambda: False, watchdog)
    assert watchdog.feeds == feeds


class LateOnce(VirtualClock):
    """A clock on which one wake-up is late."""

    def __init__(self, tick: int, late_ns: int) -> None:
        super().__init__()
        self.left, self.late_ns = tick, late_ns

    def sleep_until_ns(self, deadline_ns: int) -> None:
        self.left -= 1
        super().sleep_until_ns(deadline_ns + (self.late_ns if self.left == 0 else 0))


@pytest.mark.parametrize(
    ("late_ns", "missed"), [(0, 0), (STEP_NS - 1, 0), (STEP_NS, 1), (2 * STEP_NS - 1, 1), (3 * STEP_NS, 3)]
)
def test_each_whole_period_of_lateness_is_one_overrun_and_no_less(late_ns: int, missed: int) -> None:
    loop, _ = built(Line(), LateOnce(50, late_ns))
    loop.run(200, lambda: False, Watchdog())
    assert loop.progress.overruns == missed
    assert loop.progress.ticks == 200 - missed
