"""The ECU on a bus that the test holds in its hands: what it sends when, and what silence does to it."""

import sys

import cantools
import pytest

from hilplant.bench.ecu_side import EcuSide
from hilplant.bus.codec import ReceivedMessage, SentMessage, SignalMapping, Timing, received_message, sent_message
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.cli.actions import ecu as command
from hilplant.ecu.chart import Phase
from hilplant.ecu.node import EcuNode, EcuReport, run_ecu
from hilplant.ecu.vocabulary import Fault, Master, RelaySettings, Stalk
from hilplant.runtime.clock import VirtualClock
from hilplant.signals import ECU_FAULTS, ECU_RX, ECU_STATES, ECU_TX
from hilplant.units import MILLISECOND_NS

STATES, FAULTS = (" ".join(f'{i} "{name}"' for i, name in enumerate(names)) for names in (ECU_STATES, ECU_FAULTS))
DATABASE = cantools.database.load_string(
    f"""
VERSION ""
NS_ :
BS_:
BU_: ECU PLANT
BO_ 256 Relays: 2 ECU
 SG_ Fast : 8|8@1+ (1,0) [0|1] "" PLANT
 SG_ On : 0|8@1+ (1,0) [0|1] "" PLANT
BO_ 257 Supply: 2 ECU
 SG_ Volts : 0|16@1+ (0.01,0) [0|40] "V" PLANT
BO_ 258 Stalk: 2 PLANT
 SG_ Stage : 0|8@1+ (1,0) [0|3] "" ECU
 SG_ Flick : 8|1@1+ (1,0) [0|1] "" ECU
BO_ 259 Told: 2 ECU
 SG_ State : 0|8@1+ (1,0) [0|20] "" PLANT
 SG_ Fault : 8|8@1+ (1,0) [0|8] "" PLANT
BO_ 512 Park: 1 PLANT
 SG_ Open : 0|1@1+ (1,0) [0|1] "" ECU
BO_ 513 Motor: 4 PLANT
 SG_ Current : 0|16@1- (0.01,0) [-100|100] "A" ECU
 SG_ Battery : 16|16@1+ (0.01,0) [0|40] "V" ECU
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 20;
VAL_ 258 Stage 3 "fast" 2 "slow" 1 "intermittent" 0 "off" ;
VAL_ 259 State {STATES} ;
VAL_ 259 Fault {FAULTS} ;
""",
    "dbc",
)
TIMEOUT_NS = 100 * MILLISECOND_NS
CLOSED, OPEN = b"\x00", b"\x01"
OFF, SLOW, FAST = Stalk(), Stalk(Master.SLOW), Stalk(Master.FAST)


def received(name: str, timeout_ns: int = TIMEOUT_NS, **signals: SignalMapping | str) -> ReceivedMessage:
    mapping = [at if isinstance(at, SignalMapping) else SignalMapping(signal, at) for signal, at in signals.items()]
    return received_message(DATABASE.get_message_by_name(name), mapping, ECU_RX, timeout_ns)


def sent(name: str, **plant_signals: str) -> SentMessage:
    mapping = [SignalMapping(signal, plant_signal) for signal, plant_signal in plant_signals.items()]
    timing = Timing(on_change=tuple(plant_signals.values()))
    return sent_message(DATABASE.get_message_by_name(name), mapping, ECU_TX, timing)


def side(stalk_timeout_ns: int = 0) -> EcuSide:
    park = received("Park", Open=SignalMapping("Open", "park_contact", invert=True))
    motor = received("Motor", Current="current_a", Battery="supply_v")
    relays = sent("Relays", On="relay_on", Fast="relay_fast")
    stalk = received("Stalk", stalk_timeout_ns, Stage="master_input", Flick="flick_wipe")
    told = sent("Told", State="ecu_state", Fault="ecu_fault")
    return EcuSide((park, motor), (relays, sent("Supply", Volts="supply_v")), (stalk,), (told,))


class Wire:
    """An interface whose other end is the test."""

    up = True
    missed = 0

    def __init__(self) -> None:
        self.arriving: list[Frame] = []
        self.sent: list[Frame] = []
        self.closed = False

    def receive(self, limit: int) -> list[Frame]:
        arrived, self.arriving = self.arriving[:limit], self.arriving[limit:]
        return arrived

    def send(self, frame: Frame) -> SendResult:
        self.sent.append(frame)
        return SendResult.SENT

    def receive_late(self, limit: int) -> list[tuple[Frame, int | None]]:
        return [(frame, 0) for frame in self.receive(limit)]

    def reopen(self) -> bool:
        return True

    def close(self) -> None:
        self.closed = True


class Seat:
    """The ECU, its wire and a clock: one place to drive it from."""

    def __init__(self, stalk_timeout_ns: int = 0) -> None:
        self.wire = Wire()
        self.now_ms = 0
        self.node = EcuNode(side(stalk_timeout_ns), self.wire, RelaySettings())

    def poll(self, stalk: Stalk, park: bytes | None, milliseconds: int = 1, motor: bytes | None = None) -> list[Frame]:
        """Poll every millisecond for a while with a park frame each time; return what was sent to the relays."""
        self.wire.sent.clear()
        for _ in range(milliseconds):
            for identifier, data in ((512, park), (513, motor)):
                if data is not None:
                    self.wire.arriving.append(Frame(identifier, data))
            self.node.poll(self.now_ms * MILLISECOND_NS, stalk)
            self.now_ms += 1
        return [frame for frame in self.wire.sent if frame.identifier == 256]

    def hear(self, stage: int, flick: bool = False) -> None:
        self.wire.arriving.append(Frame(258, bytes([stage, flick])))

    def told(self) -> tuple[str, str]:
        """Return state and fault in the ECU's last message about itself."""
        data = next(frame.data for frame in reversed(self.wire.sent) if frame.identifier == 259)
        return ECU_STATES[data[0]], ECU_FAULTS[data[1]]


REST, RUN, RUN_FAST = Frame(256, b"\x00\x00"), Frame(256, b"\x01\x00"), Frame(256, b"\x01\x01")


def motor(current_a: float, supply_v: float) -> bytes:
    return DATABASE.encode_message("Motor", {"Current": current_a, "Battery": supply_v})


@pytest.fixture
def seat() -> Seat:
    return Seat()


def test_relays_are_sent_cyclically_and_so_is_the_state_and_nothing_else(seat):
    assert seat.poll(OFF, CLOSED, 100) == [REST] * 5
    assert [frame.identifier for frame in seat.wire.sent] == [256, 259] * 5
    assert seat.told() == ("off", "none")


def test_a_change_is_sent_at_once_and_the_cycle_goes_on(seat):
    seat.poll(OFF, CLOSED, 3)
    assert seat.poll(SLOW, CLOSED) == [RUN]
    assert seat.told() == ("slow", "none")
    assert seat.poll(SLOW, CLOSED, 20) == [RUN]


def test_the_relays_stay_off_until_the_park_switch_has_spoken(seat):
    assert set(seat.poll(SLOW, None, 50)) == {REST}
    assert seat.told() == ("blind", "park_unknown")
    seat.poll(SLOW, CLOSED)
    assert seat.poll(SLOW, CLOSED) == [RUN]


def test_silence_of_the_park_switch_for_its_timeout_releases_the_relays_until_it_speaks(seat):
    seat.poll(SLOW, OPEN, 500)
    assert REST not in seat.poll(SLOW, None, 100)
    assert seat.poll(SLOW, None) == [REST]
    assert set(seat.poll(SLOW, None, 1000)) == {REST}
    assert seat.node.state.phase is Phase.BLIND
    assert seat.poll(SLOW, OPEN)[-1] == RUN


def test_silence_of_other_messages_and_foreign_frames_do_not_matter(seat):
    seat.poll(SLOW, OPEN, 50, motor(3.0, 13.5))
    seat.wire.arriving += [Frame(0x7FF, b"junk"), Frame(512, b"\x01\x00"), Frame(513, b"\x00\x00", remote=True)]
    assert RUN in seat.poll(SLOW, OPEN, 300)
    assert seat.poll(SLOW, OPEN, 20) == [RUN]


def test_the_motors_current_is_heard_and_a_stall_ends_the_drive(seat):
    seat.poll(SLOW, OPEN, 400, motor(10.9, 13.5))
    assert seat.node.state.phase is Phase.SLOW
    seat.poll(SLOW, OPEN, 200, motor(10.9, 13.5))
    assert seat.told() == ("retry", "stall")


def test_a_current_that_is_no_longer_heard_is_not_held_against_the_wiper(seat):
    seat.poll(SLOW, OPEN, 300, motor(10.9, 13.5))
    seat.poll(SLOW, OPEN, 1000)
    assert seat.told() == ("slow", "none")


def test_the_supply_is_heard_and_a_brown_out_ends_the_drive(seat):
    seat.poll(SLOW, OPEN, 100, motor(3.0, 13.5))
    assert seat.poll(SLOW, OPEN, 1, motor(3.0, 5.5)) == [REST]
    assert seat.told() == ("brown_out", "brown_out")


def test_a_stalk_on_the_bus_goes_before_the_hand_at_this_end_once_it_was_heard(seat):
    seat.poll(FAST, OPEN, 10)
    assert seat.node.state.phase is Phase.FAST
    seat.hear(stage=2)
    seat.poll(FAST, OPEN, 5000)
    assert seat.node.state.phase is Phase.SLOW_WAIT, "it has no timeout, so it holds"
    seat.hear(stage=9)
    seat.poll(FAST, OPEN, 10)
    assert seat.node.state.phase is Phase.SLOW_WAIT, "a position that there is not is refused"


def test_the_flick_button_is_heard_and_a_stalk_without_a_pause_has_the_first(seat):
    seat.hear(stage=0, flick=True)
    assert seat.poll(OFF, CLOSED)[-1] == RUN_FAST
    reports: list[EcuReport] = []
    seat.node.report = reports.append
    seat.hear(stage=1)
    seat.poll(OFF, CLOSED)
    assert reports[-1].stalk == Stalk(Master.INTERMITTENT, 1)


def test_a_stalk_message_that_stays_away_too_long_is_reported_and_the_wiper_parks():
    seat = Seat(stalk_timeout_ns=TIMEOUT_NS)
    seat.hear(stage=2)
    seat.poll(OFF, OPEN, 90)
    assert seat.told() == ("slow", "none")
    seat.poll(OFF, OPEN, 20)
    assert seat.told() == ("wait", Fault.STALK_LOST.value)
    seat.hear(stage=2)
    seat.poll(OFF, OPEN, 1)
    assert seat.told() == ("slow_wait", "none")


def test_off_parks_by_the_inverted_contact_of_the_database(seat):
    seat.poll(FAST, OPEN, 500)
    assert seat.poll(OFF, OPEN, 20) == [RUN_FAST], "the wait goes on at its speed"
    assert REST not in seat.poll(OFF, OPEN, 200)
    assert seat.poll(OFF, CLOSED)[0] == REST


def test_release_sends_the_relays_off_whatever_was_due(seat):
    seat.poll(FAST, OPEN, 7)
    seat.wire.sent.clear()
    seat.node.release()
    assert seat.wire.sent[0] == REST
    assert [frame.identifier for frame in seat.wire.sent] == [256, 259]


def test_the_loop_polls_by_its_clock_and_releases_the_relays_when_told_to_stop_or_broken_off(seat):
    reports: list[EcuReport] = []
    seat.node.report = reports.append
    seat.wire.arriving = [Frame(512, OPEN)]
    run_ecu(seat.node, lambda _: SLOW, VirtualClock(), lambda: len(reports) == 20, pause_ns=2 * MILLISECOND_NS)
    assert [round(report.time_s * 1000) for report in reports] == list(range(0, 40, 2))
    commands = [frame for frame in seat.wire.sent if frame.identifier == 256]
    assert commands[-2:] == [RUN, REST]

    def breaks(_: float) -> Stalk:
        raise KeyboardInterrupt

    seat.wire.sent.clear()
    with pytest.raises(KeyboardInterrupt):
        run_ecu(seat.node, breaks, VirtualClock(), lambda: False)
    assert seat.wire.sent[0] == REST


def test_the_bench_says_how_often_the_ecu_decides(tmp_path, monkeypatch):
    pauses: list[int] = []
    monkeypatch.setattr(command, "run_ecu", lambda *_, pause_ns: pauses.append(pause_ns))
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: virtual.yaml\nname: test\necu: {period_ms: 40}\n")
    command.ecu_command(str(bench), 1.0, "0:off")
    assert pauses == [40 * MILLISECOND_NS]


@pytest.mark.parametrize(("stalk", "heard"), [("0:off", 0), (None, 1)])
def test_a_written_stalk_goes_before_the_one_on_the_bus(monkeypatch, stalk, heard):
    sides: list[EcuSide] = []
    monkeypatch.setattr(command, "EcuNode", lambda side, *_: sides.append(side) or Seat().node)
    monkeypatch.setattr(command, "run_ecu", lambda *_, pause_ns: None)
    monkeypatch.setattr(command, "_source", lambda _: None)
    command.ecu_command("virtual", 1.0, stalk)
    assert len(sides[0].stalk) == heard


def test_without_a_standard_input_the_stalk_stays_off(monkeypatch):
    stalks: list[Stalk] = []
    monkeypatch.setattr(command, "run_ecu", lambda _, source, *rest, pause_ns: stalks.append(source(3.0)))
    monkeypatch.setattr(sys, "stdin", None)
    command.ecu_command("virtual", 1.0, None)
    assert stalks == [Stalk()]
