"""Each fault of the bus against the frames that it must make, and a node's own counts of what it then hears."""

from collections import deque
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest

from hilplant.bus.faulty_transport import FaultyTransport
from hilplant.bus.frame import Frame
from hilplant.bus.interface import SendResult
from hilplant.bus.protection import Checker, FrameCheck, Protection, Protector
from hilplant.failure import Failure
from hilplant.faults.bus_catalogue import BUS_FAULTS
from hilplant.faults.catalogue import fault_named
from hilplant.faults.fault import About
from hilplant.faults.on_bus import placed_faults
from hilplant.faults.timing import Course, Inserted

MS = 1_000_000
PROTECTION = Protection(1, 4, data_id=0x123)
DATABASE = """VERSION ""
BU_: ECU PLANT
BO_ 256 Command: 4 ECU
 SG_ On : 16|1@1+ (1,0) [0|1] "" PLANT
 SG_ Level : 24|8@1+ (0.5,0) [0|100] "" PLANT
BO_ 512 Status: 2 PLANT
 SG_ Value : 7|16@0+ (1,0) [0|65535] "" ECU
"""


class _Message:
    def __init__(self, name: str, identifier: int, length: int, protection: Protection | None) -> None:
        self.name, self.identifier, self.length, self.protection = name, identifier, length, protection
        self.extended = False


class _Side:
    receive = (_Message("Command", 256, 4, PROTECTION),)
    send = (_Message("Status", 512, 2, None),)
    sources = MappingProxyType({"own.dbc": DATABASE})


class _Wire:
    """A transport whose frames are given and taken by the test."""

    up, missed, full = True, 0, False

    def __init__(self) -> None:
        self.coming: deque[Frame] = deque()
        self.sent: list[Frame] = []

    def receive(self, limit: int) -> list[Frame]:
        return [self.coming.popleft() for _ in range(min(limit, len(self.coming)))]

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, 3) for frame in self.receive(limit)]

    def send(self, frame: Frame) -> SendResult:
        if self.full:
            return SendResult.FULL
        self.sent.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        pass


def inserted(name: str, about: About, course: dict[str, Any], **values: float) -> Inserted:
    fault = fault_named(name)
    return Inserted(fault, fault.complete(values), about=about, **course)


class Rig:
    """A tick is 1 ms; the ECU sends a protected command in each, the plant a status; all that passes is kept."""

    def __init__(self, *faults: Inserted) -> None:
        self.courses = [Course(each) for each in faults]
        self.wire = _Wire()
        self.transport = FaultyTransport(self.wire, placed_faults(self.courses, _Side()))  # type: ignore[arg-type]
        self.protector, self.tick = Protector(PROTECTION), 0
        self.heard: list[list[Frame]] = []

    def run(self, ticks: int) -> "Rig":
        for _ in range(ticks):
            for course in self.courses:
                course.move(self.tick, None)
            self.transport.begin(self.tick * MS)
            data = bytearray([0, 0, 1, self.tick])
            self.protector.protect(data)
            self.wire.coming.append(Frame(256, bytes(data)))
            self.heard.append(self.transport.receive(100))
            self.transport.send(Frame(512, self.tick.to_bytes(2, "big")))
            self.tick += 1
        return self

    @property
    def levels(self) -> list[list[int]]:
        """The tick in which each command was made, by the tick in which it was heard."""
        return [[frame.data[3] for frame in frames if frame.identifier == 256] for frames in self.heard]

    @property
    def verdicts(self) -> list[FrameCheck]:
        checker = Checker(PROTECTION)
        return [checker.check(frame.data) for frames in self.heard for frame in frames]


COMMAND, TO, FROM = About(message="Command"), About(direction="to plant"), About(direction="from plant")
THREE = {"at": 2, "ticks": 3}
OK, COUNTER, CRC = FrameCheck.OK, FrameCheck.WRONG_COUNTER, FrameCheck.WRONG_CRC


@pytest.mark.parametrize(
    ("fault", "levels"),
    [
        (inserted("frames_lost", COMMAND, THREE), [[0], [1], [], [], [], [5], [6]]),
        (inserted("node_silent", TO, THREE), [[0], [1], [], [], [], [5], [6]]),
        (inserted("bus_off", TO, THREE), [[0], [1], [], [], [], [5], [6]]),
        (inserted("frames_delayed", TO, THREE, time_s=0.002), [[0], [1], [], [], [2], [3, 5], [4, 6]]),
        (inserted("frames_doubled", COMMAND, {"at": 2, "ticks": 1}, time_s=0.002), [[0], [1], [2], [3], [2, 4], [5]]),
        (inserted("frames_doubled", COMMAND, {"at": 2, "ticks": 1}), [[0], [1], [2, 2], [3]]),
        (inserted("frames_swapped", COMMAND, {"at": 1, "ticks": 4}), [[0], [], [2, 1], [], [4, 3], [5]]),
        (inserted("frames_stale", COMMAND, THREE), [[0], [1], [2], [2], [2], [5]]),
        (inserted("cycle_wrong", COMMAND, {"at": 1}, time_s=0.003), [[0], [], [1], [], [], [4], [], [], [7], []]),
    ],
    ids=lambda value: value.fault.name if isinstance(value, Inserted) else "",
)
def test_which_frames_pass_and_when(fault: Inserted, levels: list[list[int]]) -> None:
    assert Rig(fault).run(len(levels)).levels == levels


@pytest.mark.parametrize(
    ("fault", "verdicts"),
    [
        (inserted("counter_stuck", COMMAND, THREE), [OK, OK, COUNTER, COUNTER, COUNTER, COUNTER, OK]),
        (inserted("counter_jumps", COMMAND, THREE, steps=5), [OK, OK, COUNTER, OK, OK, COUNTER, OK]),
        (inserted("crc_wrong", COMMAND, THREE), [OK, OK, CRC, CRC, CRC, COUNTER, OK]),
        (inserted("frames_stale", COMMAND, THREE), [OK] * 7),
        (inserted("value_wrong", About("Command", "Level", 50.0), THREE), [OK] * 7),
        (inserted("value_invalid", About("Command", "Level"), THREE), [OK] * 7),
        (inserted("node_restarts", TO, THREE), [OK, OK, COUNTER, OK, OK, OK]),
        (inserted("cycle_wrong", COMMAND, {"at": 1}, time_s=0.003), [OK] * 4),
    ],
    ids=lambda value: value.fault.name if isinstance(value, Inserted) else "",
)
def test_what_a_receiver_with_protection_finds(fault: Inserted, verdicts: list[FrameCheck]) -> None:
    rig = Rig(fault).run(9 if fault.fault.name in ("node_restarts", "cycle_wrong") else 7)
    assert rig.verdicts[: len(verdicts)] == verdicts


@pytest.mark.parametrize("profile", [1, 2, 4, 5, 6, 7, 11])
def test_counter_and_checksum_of_every_profile_can_be_made_wrong_and_right(profile: int) -> None:
    from hilplant.bus.protection import Forger

    own = {"data_id_list": bytes(range(16))} if profile == 2 else {"data_id": 7}
    protection = Protection(profile, 32 if profile > 2 and profile != 11 else 8, **own)  # type: ignore[arg-type]
    forger, data = Forger(protection), bytearray(protection.length)
    Protector(protection).protect(data)
    signed = forger.signed(bytes(data), forger.counter(data) + 3)
    checker = Checker(protection)
    assert checker.check(bytes(data)) is OK
    assert checker.check(forger.corrupted(signed)) is CRC
    assert forger.counter(forger.corrupted(signed)) == forger.counter(signed) == 3
    assert checker.check(signed) is COUNTER
    assert checker.check(forger.signed(signed, 4)) is OK


@pytest.mark.parametrize("profile", [1, 4, 5, 6, 7, 11])
@pytest.mark.parametrize("offset", [0, 1, 7, 8, 9, 21, 40, 41])
def test_a_corrupted_frame_differs_in_one_bit_of_its_header_that_is_no_counter(profile: int, offset: int) -> None:
    from hilplant.bus.protection import Forger

    protection = Protection(profile, 64, data_id=7, offset=offset)
    forger, data = Forger(protection), bytearray(64)
    Protector(protection).protect(data)
    changed = int.from_bytes(data, "little") ^ int.from_bytes(forger.corrupted(bytes(data)), "little")
    assert changed.bit_count() == 1
    assert changed.bit_length() - 1 in protection.reserved_places()
    assert forger.counter(forger.corrupted(bytes(data))) == forger.counter(data)
    assert Checker(protection).check(forger.corrupted(bytes(data))) is CRC


def test_a_value_is_written_into_its_bits_alone() -> None:
    rig = Rig(inserted("value_wrong", About("Command", "Level", 50.0), THREE)).run(6)
    assert [frames[0].data[2:] for frames in rig.heard] == [b"\1\0", b"\1\1", b"\1d", b"\1d", b"\1d", b"\1\5"]
    rig = Rig(inserted("value_invalid", About("Status", "Value"), THREE)).run(6)
    assert [frame.data.hex() for frame in rig.wire.sent] == ["0000", "0001", "ffff", "ffff", "ffff", "0005"]


def test_bytes_that_are_missing() -> None:
    rig = Rig(inserted("frames_short", FROM, THREE, bytes=1)).run(6)
    assert [len(frame.data) for frame in rig.wire.sent] == [2, 2, 1, 1, 1, 2]


def test_a_babbling_node_adds_its_frames_once_and_touches_no_other() -> None:
    rig = Rig(inserted("babble", TO, THREE, identifier=3, frames=2)).run(6)
    assert rig.levels == [[0], [1], [2], [3], [4], [5]]
    assert [sum(frame.identifier == 3 for frame in frames) for frames in rig.heard] == [0, 0, 2, 2, 2, 0]


def test_a_node_that_is_off_the_bus_sees_its_link_down_and_hears_nothing_of_that_time() -> None:
    rig = Rig(inserted("bus_off", FROM, THREE)).run(2)
    assert rig.transport.up
    rig.run(1)
    assert not rig.transport.up
    assert not rig.transport.reopen()
    assert rig.transport.send(Frame(512, b"")) is SendResult.DOWN
    rig.run(4)
    assert rig.transport.reopen()
    assert rig.levels == [[0], [1], [], [], [], [5], [6]]
    assert [frame.data[1] for frame in rig.wire.sent] == [0, 1, 5, 6]


def test_jitter_and_loss_are_those_of_their_seed_and_keep_the_order() -> None:
    def played(seed: int) -> list[list[int]]:
        jitter = inserted("frames_jitter", COMMAND, {"seed": seed}, time_s=0.006)
        return Rig(jitter, inserted("frames_lost", TO, {"seed": seed}, share=0.3)).run(100).levels

    order = [level for levels in played(1) for level in levels]
    assert order == sorted(order)
    assert 50 < len(order) < 85
    assert played(1) == played(1) != played(2)


def test_what_a_full_interface_does_not_take_waits_with_the_node() -> None:
    rig = Rig(inserted("frames_delayed", FROM, {}, time_s=0.001))
    rig.run(2)
    rig.wire.full = True
    assert rig.run(3).transport.send(Frame(512, b"later")) is SendResult.FULL
    rig.wire.full = False
    rig.run(4)
    assert [frame.data[1] for frame in rig.wire.sent] == [0, 1, 5, 6, 7]


@pytest.mark.parametrize(
    ("name", "about", "text"),
    [
        ("frames_lost", About("Comand"), "did you mean"),
        ("frames_lost", About("Command", direction="from plant"), "does not send Command"),
        ("crc_wrong", About("Status"), "no protection"),
        ("value_wrong", About("Command", "Lefel", 1.0), "Level"),
        ("value_wrong", About("Command", "Level"), "needs value"),
        ("babble", About("Command"), "takes no message"),
        ("frames_lost", About(), "needs message or direction"),
        ("park_stuck_open", About("Command"), "none of the bus"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(name: str, about: About, text: str) -> None:
    with pytest.raises(Failure, match=text):
        fault_named(name).check_about(about)
        placed_faults([Course(inserted(name, about, {}, **({"share": 1.0} if name == "frames_lost" else {})))], _Side())  # type: ignore[arg-type]


def test_every_fault_of_the_bus_is_tried_here() -> None:
    tried = Path(__file__).read_text(encoding="utf-8")
    assert not [fault.name for fault in BUS_FAULTS if f'"{fault.name}"' not in tried]
