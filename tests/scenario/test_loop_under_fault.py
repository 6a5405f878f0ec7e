"""What the loop does when the bus misbehaves: each case of a broken client or interface, in virtual time.

The bench is the shipped default, the plant the real one; only the interface is made of lists, so that each fault can be
dealt out at a known tick.
"""

import math
import random
import struct
from collections import Counter
from dataclasses import replace

import pytest
from support.loop_rig import (
    BLADES,
    ECU_STATUS,
    ENVIRONMENT,
    FORCES,
    LINKAGE,
    MOTOR_STATUS,
    OWN,
    RELAY,
    SLOW,
    STALK_COMMAND,
    SUPPLY,
    TIMEOUT_TICKS,
    ListedTransport,
    Rig,
)

from hilplant.bus.frame import Frame
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.commands import BUS, SAFE_STATE
from hilplant.runtime.loop import SAFE, WAITING
from hilplant.runtime.row import FIRST_OWNER
from hilplant.runtime.server import build_loop


@pytest.fixture
def rig() -> Rig:
    return Rig()


def test_an_input_is_the_buss_again_in_the_tick_in_which_commands_are_back(rig: Rig) -> None:
    owners, seen = rig.loop.line[FIRST_OWNER:], []
    for ticks, every in ((5, 0), (50, 10), (2 * TIMEOUT_TICKS, 0), (50, 10)):
        for _ in range(ticks):
            rig.tick(command_every=every)
            expected = SAFE_STATE if rig.value("mode") in (SAFE, WAITING) else BUS
            assert {owners[index] for index, _ in rig.bench.safe} == {expected}
            assert set(owners) <= {expected, BUS}
            seen += [expected] if seen[-1:] != [expected] else []
    assert seen == [SAFE_STATE, BUS, SAFE_STATE, BUS]


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
