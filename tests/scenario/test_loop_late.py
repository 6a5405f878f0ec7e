"""What a late loop does: commands that waited too long drive nothing, too much lost time is said."""

import pytest
from support.loop_rig import OFF, SLOW, STEP_NS, ListedTransport, Rig

from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import BEHIND, SAFE, WAITING
from hilplant.runtime.server import StopRequest, build_loop
from hilplant.runtime.watchdog import Watchdog
from hilplant.signals import PUBLISHED_INDEX


@pytest.fixture
def rig() -> Rig:
    return Rig()


@pytest.mark.parametrize("waited_ms", [[5000, 4990, 4980], [None, None, None], [100_000, 700, None]])
def test_after_a_stall_old_commands_are_lost_ones_until_a_fresh_one_comes(
    rig: Rig, waited_ms: list[int | None]
) -> None:
    """Five seconds without a tick; where the interface does not say how old a frame is, it counts as old."""
    rig.tick(1000, command_every=50)
    rig.now += 5000
    rig.transport.waited_ns.extend([None if wait is None else wait * STEP_NS for wait in waited_ms])
    rig.tick(1, SLOW, OFF, SLOW)
    assert (rig.value("terminal_v"), rig.value("mode")) == (0.0, SAFE)
    assert rig.counts() == {"stale_frame": 3, "timeout": 1}
    rig.tick(200)
    assert rig.value("terminal_v") == 0.0
    rig.tick(1, SLOW)
    assert rig.value("terminal_v") == 13.5
    assert rig.counts() == {"stale_frame": 3, "timeout": 1}


def test_after_a_stall_a_command_that_has_just_come_holds(rig: Rig) -> None:
    rig.tick(1000, command_every=50)
    rig.now += 5000
    rig.transport.waited_ns.extend([4000 * STEP_NS, 30 * STEP_NS])
    rig.tick(1, OFF, SLOW)
    assert rig.value("terminal_v") == 13.5
    assert rig.counts() == {"stale_frame": 1}


def test_a_backlog_of_more_than_a_tick_takes_drives_nothing_while_it_is_worked_off(rig: Rig) -> None:
    rig.tick(1000, command_every=50)
    rig.now += 5000
    rig.transport.waited_ns.extend([(5000 - index) * STEP_NS for index in range(450)])
    rig.transport.arrived.extend([SLOW] * 450)
    for _ in range(100):
        rig.tick()
        assert rig.value("terminal_v") == 0.0
    assert rig.counts()["stale_frame"] == 450


def test_what_waited_since_before_the_start_commands_nothing(rig: Rig) -> None:
    rig.transport.waited_ns.append(3000 * STEP_NS)
    rig.tick(1, SLOW)
    assert (rig.value("terminal_v"), rig.value("mode")) == (0.0, WAITING)
    assert rig.counts() == {"stale_frame": 1}


@pytest.mark.parametrize(("period", "other_period", "noticed"), [(50, 50, True), (50, 20, True), (100, 50, True)])
def test_two_senders_of_one_command_are_noticed(rig: Rig, period: int, other_period: int, noticed: bool) -> None:
    for _ in range(2000):
        frames = [SLOW] * (rig.now % period == 0) + [OFF] * (rig.now % other_period == 11)
        rig.tick(1, *frames)
    assert (rig.counts().get("alternating", 0) > 20) is noticed


def test_one_sender_that_switches_often_is_not_taken_for_two(rig: Rig) -> None:
    for _ in range(20):
        rig.tick(200, *[SLOW, SLOW], command_every=50)
        rig.tick(1, OFF)
        rig.tick(199)
    assert rig.counts() == {}


class StallingClock(VirtualClock):
    """Comes `late_ms` late at every tick that is due in the given seconds."""

    def __init__(self, late_ms: float, seconds: range) -> None:
        super().__init__()
        self.late_ns, self.seconds = round(late_ms * 1e6), seconds

    def sleep_until_ns(self, deadline_ns: int) -> None:
        super().sleep_until_ns(deadline_ns)
        if deadline_ns // 10**9 in self.seconds:
            self.time_ns = max(self.time_ns, deadline_ns + self.late_ns)


class CountingWatchdog(Watchdog):
    period_ns = 100_000_000
    fed = 0

    def feed(self) -> None:
        self.fed += 1


@pytest.mark.parametrize(("late_ms", "behind"), [(1.2, True), (0.9, False)])
def test_a_loop_that_loses_too_much_time_says_so_and_does_not_feed_the_watchdog(
    rig: Rig, late_ms: float, behind: bool
) -> None:
    """A tick that is 1.2 ms late each time loses every second period, from second 1 to second 3 of 6."""
    loop = build_loop(rig.bench, transport := ListedTransport(), StallingClock(late_ms, range(1, 4)))
    watchdog = CountingWatchdog()
    modes = []

    def command_and_look() -> bool:
        transport.arrived.append(SLOW)
        modes.append(int(loop._published[PUBLISHED_INDEX["mode"]]))
        return False

    loop.run(6000, command_and_look, watchdog)
    assert loop.lost_time.exceeded is behind
    assert (int(BEHIND) in modes) is behind
    assert modes[-1] != int(BEHIND), "it has caught up"
    assert (watchdog.fed < 45) is behind
    assert watchdog.fed > 15


def test_single_hiccups_do_not_make_a_loop_fall_behind(rig: Rig) -> None:
    class Hiccup(VirtualClock):
        def sleep_until_ns(self, deadline_ns: int) -> None:
            super().sleep_until_ns(deadline_ns)
            if deadline_ns % 10**9 == 0:
                self.time_ns += 150_000_000

    loop = build_loop(rig.bench, ListedTransport(), Hiccup())
    loop.run(5000, StopRequest(), Watchdog())
    assert loop.progress.overruns >= 600
    assert not loop.lost_time.exceeded
