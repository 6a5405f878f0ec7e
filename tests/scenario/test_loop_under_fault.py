"""What the loop does when the bus misbehaves: each case of a broken client or interface, in virtual time.

The bench is the shipped default, the plant the real one; only the interface is made of lists, so that each fault can be
dealt out at a known tick.
"""

import math
import random
import struct
from collections import Counter, deque
from dataclasses import replace
from itertools import pairwise

import pytest

from hilplant.bench import load_bench
from hilplant.bus.codec import SentMessage
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.loop import BEHIND, SAFE, WAITING, Loop
from hilplant.runtime.server import StopRequest, build_loop
from hilplant.runtime.watchdog import Watchdog
from hilplant.signals import PUBLISHED_INDEX

RELAY, SUPPLY, ENVIRONMENT, BLADES, MOTOR_STATUS, LINKAGE, FORCES = 0x120, 0x121, 0x122, 0x123, 0x200, 0x202, 0x204
BETWEEN_OTHERS = (0x110, 0x130)  # from the stalk to the ECU and back
SLOW, OFF = Frame(RELAY, b"\x01\x00"), Frame(RELAY, b"\x00\x00")
OWN = (0x200, 0x201, 0x202, 0x203, 0x204, 0x205, 0x210, 0x211, 0x212, 0x213, 0x214, 0x215)
STALK_COMMAND, ECU_STATUS = 0x110, 0x130  # between ECU and driver: none of the plant's business
STEP_NS = 1_000_000
TIMEOUT_TICKS = 500


class ListedTransport:
    """An interface whose frames are lists, and which can be taken down or filled up."""

    def __init__(self) -> None:
        self.up = True
        self.missed = 0
        self.full = False
        self.can_reopen = True
        self.reopened = 0
        self.arrived: deque[Frame] = deque()
        self.waited_ns: deque[int | None] = deque()  # of what has arrived; 0 where nothing is left of it
        self.sent: list[Frame] = []

    def receive(self, limit: int) -> list[Frame]:
        if not self.up:
            return []
        return [self.arrived.popleft() for _ in range(min(limit, len(self.arrived)))]

    def send(self, frame: Frame) -> SendResult:
        if not self.up:
            return SendResult.DOWN
        if self.full:
            return SendResult.FULL
        self.sent.append(frame)
        return SendResult.SENT

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, self.waited_ns.popleft() if self.waited_ns else 0) for frame in self.receive(limit)]

    def reopen(self) -> bool:
        self.reopened += 1
        self.up = self.can_reopen
        return self.up

    def close(self) -> None:
        self.up = False


class Rig:
    """The default bench's loop on a listed transport, ticked by hand."""

    def __init__(self) -> None:
        self.bench = load_bench("default")
        self.transport = ListedTransport()
        self.loop: Loop = build_loop(self.bench, self.transport, VirtualClock())
        self.now = 0

    def tick(self, ticks: int = 1, *frames: Frame, command_every: int = 0) -> None:
        """Tick on; `frames` come with the first tick, a slow command every so many ticks."""
        self.transport.arrived.extend(frames)
        for _ in range(ticks):
            if command_every and self.now % command_every == 0:
                self.transport.arrived.append(SLOW)
            self.loop.tick(self.now * STEP_NS)
            self.now += 1

    def value(self, name: str) -> float:
        return self.loop._published[PUBLISHED_INDEX[name]]

    def counts(self) -> dict[str, int]:
        return {name: count for name, count in self.loop.counts().items() if count and name != "tick"}


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_relays_stay_open_until_the_first_command(rig: Rig) -> None:
    rig.tick(1000)
    assert rig.value("mode") == WAITING
    assert rig.value("terminal_v") == 0.0
    assert rig.value("crank_angle_rad") == 0.0
    assert rig.counts() == {}


def test_a_command_shows_in_the_frames_of_the_same_tick_and_moves_the_motor_in_the_next(rig: Rig) -> None:
    rig.tick(25)
    before = len(rig.transport.sent)
    rig.tick(1, SLOW)
    status = [frame for frame in rig.transport.sent[before:] if frame.identifier == MOTOR_STATUS]
    assert status, "the relay change sends MotorStatus at once, off its 10 ms grid"
    current, _, _, terminal = struct.unpack("<hhhh", status[0].data)
    assert (current, terminal * 0.002) == (0, 13.5)
    rig.tick()
    assert rig.value("current_a") > 1.0


def test_the_frame_of_the_blades_changes_their_forces_in_the_same_tick(rig: Rig) -> None:
    """Twice the force on the left, a lifted arm on the right; wear 1, wetness as before. The bench has 7.615 N."""
    payload = 0x9C | 0x9C << 8 | 1000 << 16 | 1000 << 28 | 2000 << 40
    rig.tick(1, Frame(BLADES, payload.to_bytes(8, "little")))
    assert (rig.value("left_force_n"), rig.value("right_force_n")) == pytest.approx((15.23, 0.0))
    rig.tick(60)
    forces = [frame.data for frame in rig.transport.sent if frame.identifier == FORCES]
    assert struct.unpack("<HH", forces[0]) == (1523, 0)


def test_a_lost_command_opens_the_relays_until_it_is_back(rig: Rig) -> None:
    rig.tick(1000, command_every=50)
    assert rig.value("terminal_v") == 13.5
    last_command_tick = 950
    rig.tick(last_command_tick + TIMEOUT_TICKS + 1 - rig.now)
    assert rig.value("terminal_v") == 13.5, "not before its time"
    rig.tick()
    assert (rig.value("terminal_v"), rig.value("mode")) == (0.0, SAFE)
    assert rig.counts() == {"timeout": 1}
    rig.tick(5000)
    assert abs(rig.value("motor_speed_rad_s")) < 1e-6, "braked to a stand"
    assert rig.counts() == {"timeout": 1}, "one loss is one count"
    rig.tick(1, SLOW)
    assert rig.value("terminal_v") == 13.5


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
    rig.transport.waited_ns.extend([(5000 - place) * STEP_NS for place in range(450)])
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


FRAMES_BY_CAUSE = {
    "unknown_frame": [
        Frame(0x7FF, b"\x01\x00"),
        Frame(RELAY, b"\x01\x00", extended=True),
        Frame(MOTOR_STATUS, bytes(8), extended=True),
    ],
    "own_identifier": [Frame(MOTOR_STATUS, bytes(8)), Frame(LINKAGE, b""), Frame(0x214, bytes(8), fd=True)],
    "wrong_length": [Frame(RELAY, b""), Frame(RELAY, b"\x01"), Frame(RELAY, bytes(3)), Frame(RELAY, bytes(8))],
    "remote_frame": [Frame(RELAY, b"", remote=True), Frame(0x1FFFFFFF, b"", extended=True, remote=True)],
    "fd_frame": [Frame(RELAY, b"\x01\x00", fd=True), Frame(RELAY, bytes(64), fd=True)],
    "error_frame": [Frame(0x4, bytes(8), error=True), Frame(RELAY, b"\x01\x00", error=True)],
    "out_of_range": [
        Frame(SUPPLY, struct.pack("<H", 40_001)),
        Frame(SUPPLY, b"\xff\xff"),
        Frame(ENVIRONMENT, b"\x03\x00\x00"),
        Frame(ENVIRONMENT, b"\x00\xff\xff"),
        Frame(BLADES, b"\x65" + bytes(7)),  # 1.01 under the left blade
        Frame(BLADES, b"\x00\x9b" + bytes(6)),  # -1.01 under the right one
    ],
}


@pytest.mark.parametrize("cause", FRAMES_BY_CAUSE)
def test_each_wrong_frame_is_counted_by_its_cause_and_changes_nothing(rig: Rig, cause: str) -> None:
    frames = FRAMES_BY_CAUSE[cause]
    rig.tick(10)
    values = list(rig.loop._node.values)
    rig.tick(1, *frames)
    assert rig.counts() == {cause: len(frames)}
    assert rig.loop._node.values == values
    assert rig.value("mode") == WAITING


def test_a_number_that_is_not_finite_is_refused(rig: Rig) -> None:
    for number in (math.nan, math.inf, -math.inf):
        loop = build_loop(
            replace(rig.bench, receive=(replace(rig.bench.receive[1], decode=lambda _, n=number: (n,)),)),
            transport := ListedTransport(),
            VirtualClock(),
        )
        transport.arrived.append(Frame(SUPPLY, bytes(2)))
        loop.tick(0)
        assert loop.counts()["non_finite"] == 1
        assert loop._node.values[2] == 13.5


def test_no_more_frames_are_taken_in_a_tick_than_the_bench_allows(rig: Rig) -> None:
    rig.tick(1, *[Frame(0x7FF, b"")] * 250)
    assert rig.counts() == {"unknown_frame": 100}
    rig.tick(2)
    assert rig.counts() == {"unknown_frame": 250}


def test_a_full_queue_drops_the_oldest_frames_counts_them_and_recovers(rig: Rig) -> None:
    rig.tick(100, command_every=50)
    rig.transport.full = True
    sent_before = len(rig.transport.sent)
    shown = []
    for _ in range(2000):
        rig.tick(1, command_every=50)
        if (rig.now - 1) % 10 == 0:
            shown.append(round(rig.value("crank_angle_rad") * 1e4))
    assert len(rig.transport.sent) == sent_before
    dropped = rig.counts()["queue_full"]
    assert dropped > 300
    rig.transport.full = False
    rig.tick(1, command_every=50)
    shown.append(round(rig.value("crank_angle_rad") * 1e4))
    caught_up = rig.transport.sent[sent_before:]
    assert 64 <= len(caught_up) <= 64 + len(rig.bench.send)
    angles = [struct.unpack("<H", frame.data[:2])[0] for frame in caught_up if frame.identifier == LINKAGE]
    assert len(angles) >= 64 // len(rig.bench.send), "one of the most frequent frames"
    assert angles == shown[-len(angles) :], "the newest are kept, in order"
    rig.tick(1000, command_every=50)
    assert rig.counts()["queue_full"] == dropped


def test_a_lost_link_is_counted_once_and_reopened_with_growing_pauses(rig: Rig) -> None:
    rig.tick(100, command_every=50)
    rig.transport.up = rig.transport.can_reopen = False
    rig.tick(10_000)
    assert rig.counts() == {"link_down": 1, "timeout": 1}
    assert rig.value("mode") == SAFE
    assert rig.transport.reopened == 8, "after 0.1, 0.3, 0.7, 1.5, 3.1, 5.1, 7.1, 9.1 s"
    rig.transport.can_reopen = True
    rig.tick(2000)
    assert rig.transport.up
    rig.tick(1, SLOW)
    assert rig.value("terminal_v") == 13.5


def test_ten_losses_of_the_link_are_ten_counts(rig: Rig) -> None:
    for _ in range(10):
        rig.tick(50, command_every=50)
        rig.transport.up = False
        rig.tick(200, command_every=50)
        assert rig.transport.up
    assert rig.counts()["link_down"] == 10


def random_frame(source: random.Random) -> Frame:
    """Any frame a bus can carry: right and wrong identifiers, all lengths, classic, FD, remote and error frames."""
    kind = source.random()
    identifier = source.choice((RELAY, SUPPLY, ENVIRONMENT, BLADES, MOTOR_STATUS, source.randrange(0x800)))
    if kind < 0.05:
        return Frame(source.randrange(1 << 29), bytes(8), error=True)
    if kind < 0.10:
        return Frame(identifier, b"", remote=True)
    if kind < 0.20:
        return Frame(identifier, source.randbytes(source.choice((0, 1, 2, 3, 8, 12, 48, 64))), fd=True)
    extended = kind < 0.30
    return Frame(source.randrange(1 << 29) if extended else identifier, source.randbytes(source.randrange(9)), extended)


def expected_cause(frame: Frame) -> str:
    """Name the cause from the database's text alone, in the order in which a frame is judged."""
    lengths = {RELAY: 2, SUPPLY: 2, ENVIRONMENT: 3, BLADES: 8}
    if frame.error:
        return "error_frame"
    if frame.remote:
        return "remote_frame"
    if frame.identifier in OWN and not frame.extended:
        return "own_identifier"
    if frame.extended or frame.identifier not in lengths:
        between_others = frame.identifier in (STALK_COMMAND, ECU_STATUS) and not frame.extended
        return "between_others" if between_others else "unknown_frame"
    if frame.fd:
        return "fd_frame"
    if len(frame.data) != lengths[frame.identifier]:
        return "wrong_length"
    if frame.identifier == SUPPLY and int.from_bytes(frame.data, "little") > 40_000:
        return "out_of_range"
    screen, speed = frame.data[0] & 3, int.from_bytes(frame.data[1:], "little")
    if frame.identifier == ENVIRONMENT and (screen > 2 or speed > 10_000):
        return "out_of_range"
    if frame.identifier == BLADES and any(100 < byte < 156 for byte in frame.data[:2]):
        return "out_of_range"
    return "accepted"


def test_a_million_random_frames_are_counted_by_cause_and_the_plant_goes_on(rig: Rig) -> None:
    source = random.Random(20260101)
    wanted: Counter[str] = Counter()
    for _ in range(10_000):
        frames = [random_frame(source) for _ in range(100)]
        wanted.update(expected_cause(frame) for frame in frames)
        rig.tick(1, *frames)
    accepted, others = wanted.pop("accepted"), wanted.pop("between_others")
    assert accepted > 1000
    assert others > 100
    counts = rig.counts()
    counts.pop("saturated", None)
    counts.pop("alternating", None)
    assert counts == dict(wanted)
    assert rig.loop.progress.ticks == 10_000
    rig.tick(TIMEOUT_TICKS + 2)
    assert (rig.value("mode"), rig.value("terminal_v")) == (SAFE, 0.0)
    assert rig.value("guard") == 0.0


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
    class LateClock(VirtualClock):
        def sleep_until_ns(self, deadline_ns: int) -> None:
            super().sleep_until_ns(deadline_ns)
            if deadline_ns == 101 * STEP_NS:
                self.time_ns += 7_300_000

    loop = build_loop(rig.bench, ListedTransport(), LateClock())
    loop.run(1000, StopRequest(), Watchdog())
    assert loop.progress.overruns == 7
    assert loop.progress.ticks == 993
    assert loop.latency.worst_ns == 7_300_000


def test_a_worst_latency_beyond_what_its_frame_carries_is_no_fault(rig: Rig) -> None:
    rig.loop.latency.add(70_000_000)
    rig.tick(201)
    assert rig.counts() == {"worst_latency_us": 70_000}


@pytest.mark.parametrize(("policy", "stops"), [("count", False), ("degrade", False), ("stop", True)])
def test_the_bench_decides_what_a_late_tick_leads_to(rig: Rig, policy: str, stops: bool) -> None:
    class LateClock(VirtualClock):
        def sleep_until_ns(self, deadline_ns: int) -> None:
            super().sleep_until_ns(deadline_ns)
            if deadline_ns == 101 * STEP_NS:
                self.time_ns += 5_000_000

    bench = replace(rig.bench, loop=rig.bench.loop.model_copy(update={"on_overrun": policy}))
    loop = build_loop(bench, ListedTransport(), LateClock())
    loop.run(1000, StopRequest(), Watchdog())
    assert loop.progress.stopped_by_overrun is stops
    assert (loop.progress.ticks < 200) is stops


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


def test_the_count_of_ticks_begins_again_where_its_frame_ends(rig: Rig) -> None:
    rig.loop.progress.ticks = 2**32 - 60
    rig.tick(150)
    ticks = [int.from_bytes(f.data[:4], "little") for f in rig.transport.sent if f.identifier == 0x210]
    assert ticks[0] == 2**32 - 60
    assert ticks[-1] == 100 - 60
    assert rig.counts() == {}
