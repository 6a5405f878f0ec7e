"""The ECU on a bus that the test holds in its hands: what it sends when, and what silence does to it."""

import cantools
import pytest

from hilplant.bus.codec import (
    ReceivedMessage,
    SentMessage,
    SignalMapping,
    Timing,
    received_message,
    sent_message,
)
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.ecu import command
from hilplant.ecu.node import EcuNode, Report, run_ecu
from hilplant.ecu.relay_controller import Phase, Settings, Stalk
from hilplant.runtime.clock import VirtualClock
from hilplant.signals import INPUTS, PUBLISHED
from hilplant.units import MILLISECOND_NS

DATABASE = cantools.database.load_string(
    """
VERSION ""
NS_ :
BS_:
BU_: ECU PLANT
BO_ 256 Relays: 2 ECU
 SG_ Fast : 8|8@1+ (1,0) [0|1] "" PLANT
 SG_ On : 0|8@1+ (1,0) [0|1] "" PLANT
BO_ 257 Supply: 2 ECU
 SG_ Volts : 0|16@1+ (0.01,0) [0|40] "V" PLANT
BO_ 512 Park: 1 PLANT
 SG_ Open : 0|1@1+ (1,0) [0|1] "" ECU
BO_ 513 Motor: 2 PLANT
 SG_ Current : 0|16@1- (0.01,0) [-100|100] "A" ECU
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 20;
""",
    "dbc",
)
PARK_TIMEOUT_NS = 100 * MILLISECOND_NS
CLOSED, OPEN = b"\x00", b"\x01"


def received(name: str, signal: str, plant_signal: str, invert: bool = False) -> ReceivedMessage:
    mapping = [SignalMapping(signal, plant_signal, invert=invert)]
    message = DATABASE.get_message_by_name(name)
    return received_message(message, mapping, PUBLISHED, PARK_TIMEOUT_NS)


def sent(name: str, **plant_signals: str) -> SentMessage:
    mapping = [SignalMapping(signal, plant_signal) for signal, plant_signal in plant_signals.items()]
    timing = Timing(on_change=tuple(plant_signals.values()))
    return sent_message(DATABASE.get_message_by_name(name), mapping, INPUTS, timing)


class Wire:
    """An interface whose other end is the test."""

    up = True

    def __init__(self) -> None:
        self.arriving: list[Frame] = []
        self.sent: list[Frame] = []
        self.closed = False

    missed = 0

    def receive(self, limit: int) -> list[Frame]:
        arrived, self.arriving = self.arriving[:limit], self.arriving[limit:]
        return arrived

    def send(self, frame: Frame) -> SendResult:
        self.sent.append(frame)
        return SendResult.SENT

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        self.closed = True


class Seat:
    """The ECU, its wire and a clock: one place to drive it from."""

    def __init__(self) -> None:
        self.wire = Wire()
        self.now_ms = 0
        park = received("Park", "Open", "park_contact", invert=True)
        motor = received("Motor", "Current", "current_a")
        relays = sent("Relays", On="relay_on", Fast="relay_fast")
        supply = sent("Supply", Volts="supply_v")
        self.node = EcuNode([park, motor], [relays, supply], self.wire, Settings())

    def poll(self, stalk: Stalk, park: bytes | None, milliseconds: int = 1) -> list[Frame]:
        """Poll every millisecond for a while with a park frame each time; return what was sent."""
        self.wire.sent.clear()
        for _ in range(milliseconds):
            if park is not None:
                self.wire.arriving.append(Frame(512, park))
            self.node.poll(self.now_ms * MILLISECOND_NS, stalk)
            self.now_ms += 1
        return list(self.wire.sent)


OFF, SLOW, FAST = Frame(256, b"\x00\x00"), Frame(256, b"\x01\x00"), Frame(256, b"\x01\x01")


@pytest.fixture
def seat() -> Seat:
    return Seat()


def test_relays_are_sent_cyclically_and_nothing_else_is(seat):
    assert seat.poll(Stalk.OFF, CLOSED, 100) == [OFF] * 5


def test_a_change_is_sent_at_once_and_the_cycle_goes_on(seat):
    seat.poll(Stalk.OFF, CLOSED, 3)
    assert seat.poll(Stalk.SLOW, CLOSED) == [SLOW]
    assert seat.poll(Stalk.FAST, CLOSED) == [FAST]
    assert seat.poll(Stalk.FAST, CLOSED, 20) == [FAST]


def test_the_relays_stay_off_until_the_park_switch_has_spoken(seat):
    assert set(seat.poll(Stalk.SLOW, None, 50)) == {OFF}
    assert seat.poll(Stalk.SLOW, CLOSED) == [SLOW]


def test_silence_of_the_park_switch_for_its_timeout_releases_the_relays_until_it_speaks(seat):
    seat.poll(Stalk.SLOW, OPEN, 500)
    assert OFF not in seat.poll(Stalk.SLOW, None, 100)
    assert seat.poll(Stalk.SLOW, None) == [OFF]
    assert set(seat.poll(Stalk.SLOW, None, 1000)) == {OFF}
    assert seat.node.state.phase is Phase.BLIND
    assert seat.poll(Stalk.SLOW, OPEN)[-1] == SLOW


def test_silence_of_other_messages_and_foreign_frames_do_not_matter(seat):
    seat.wire.arriving += [
        Frame(0x7FF, b"junk"),
        Frame(512, b"\x01\x00"),
        Frame(513, b"\x00\x00", remote=True),
    ]
    assert SLOW in seat.poll(Stalk.SLOW, OPEN, 300)
    assert seat.poll(Stalk.SLOW, OPEN, 20) == [SLOW]


def test_off_parks_by_the_inverted_contact_of_the_database(seat):
    seat.poll(Stalk.FAST, OPEN, 500)
    assert seat.poll(Stalk.OFF, OPEN)[0] == SLOW
    assert OFF not in seat.poll(Stalk.OFF, OPEN, 200)
    assert seat.poll(Stalk.OFF, CLOSED)[0] == OFF


def test_release_sends_the_relays_off_whatever_was_due(seat):
    seat.poll(Stalk.FAST, OPEN, 7)
    seat.wire.sent.clear()
    seat.node.release()
    assert seat.wire.sent == [OFF]


def test_the_loop_polls_by_its_clock_and_releases_the_relays_when_told_to_stop_or_broken_off(seat):
    reports: list[Report] = []
    seat.node.report = reports.append
    seat.wire.arriving = [Frame(512, OPEN)]
    run_ecu(seat.node, lambda _: Stalk.SLOW, VirtualClock(), lambda: len(reports) == 20)
    assert [round(report.time_s * 1000) for report in reports] == list(range(0, 40, 2))
    assert seat.wire.sent[-2:] == [SLOW, OFF]

    def breaks(_: float) -> Stalk:
        raise KeyboardInterrupt

    seat.wire.sent.clear()
    with pytest.raises(KeyboardInterrupt):
        run_ecu(seat.node, breaks, VirtualClock(), lambda: False)
    assert seat.wire.sent == [OFF]


def test_the_bench_says_how_often_the_ecu_decides(tmp_path, monkeypatch):
    pauses: list[int] = []
    monkeypatch.setattr(command, "run_ecu", lambda *_, pause_ns: pauses.append(pause_ns))
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: virtual.yaml\nname: test\necu: {period_ms: 40}\n")
    assert command.ecu_command(str(bench), 1.0, "0:off") == 0
    assert pauses == [40 * MILLISECOND_NS]
