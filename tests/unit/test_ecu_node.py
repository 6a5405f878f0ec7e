"""The ECU on a bus that the test holds in its hands: what it sends when, and what silence does to it."""

import sys
from dataclasses import replace

import pytest
from support.ecu_seat import (
    CLOSED,
    FAST,
    OFF,
    OPEN,
    REST,
    RUN,
    RUN_FAST,
    SLOW,
    TIMEOUT_NS,
    Seat,
    motor,
    received,
    side,
)

from hilplant.bench.ecu_side import EcuSide
from hilplant.bus.frame import Frame
from hilplant.bus.node import Node
from hilplant.cli.actions import ecu as command
from hilplant.ecu.chart import Phase
from hilplant.ecu.node import EcuNode, EcuReport, run_ecu
from hilplant.ecu.vocabulary import Fault, Master, RelaySettings, Stalk
from hilplant.runtime.clock import VirtualClock
from hilplant.signals import ECU_TX, STATUS_INDEX
from hilplant.units import MILLISECOND_NS, SECOND_NS


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


def test_what_has_nothing_for_the_ecu_is_not_even_read(seat):
    other = received("Supply", Volts="crank_speed_rad_s")
    heard = side()
    seat.node = EcuNode(replace(heard, receive=(*heard.receive, other)), seat.wire, RelaySettings())
    seat.wire.arriving.append(Frame(257, b"\x00"))
    seat.poll(OFF, CLOSED)
    assert seat.node.counts[STATUS_INDEX["wrong_length"]] == 0, "a frame that is too short is counted where it is read"


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


def test_the_stalk_is_asked_by_the_time_since_the_start_whatever_the_clock_shows_then(seat):
    clock, asked, reports = VirtualClock(), [], []
    clock.sleep_until_ns(7 * SECOND_NS)
    seat.node.report = reports.append
    run_ecu(seat.node, lambda at_s: asked.append(at_s) or SLOW, clock, lambda: len(asked) == 3)
    assert asked == [report.time_s for report in reports] == [0.0, 0.005, 0.01]


def test_its_messages_are_rehearsed_before_the_first_poll(monkeypatch):
    rehearsed = []
    monkeypatch.setattr(Node, "rehearse", lambda node, values: rehearsed.append(values[:]))
    Seat()
    assert rehearsed == [[signal.default for signal in ECU_TX]]


def test_leaving_gives_the_interface_back(seat):
    seat.node.close()
    assert seat.wire.closed


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
