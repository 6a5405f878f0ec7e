"""What the controller makes of trouble over time: timeouts, tries, thresholds, and when it forgets, to the poll."""

import numpy as np
import pytest
from support.ecu_mind import DRIVE, FAST, OFF, POLL_S, SETTINGS, SLOW, Mind

from hilplant.ecu.chart import Phase
from hilplant.ecu.vocabulary import RELAYS_OFF, Fault, RelaySettings


@pytest.fixture
def bench() -> Mind:
    return Mind()


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("moves", [(SLOW,), (SLOW, FAST, OFF)])
def test_driving_without_park_ends_after_its_timeout_whatever_the_stalk_does(bench, contact, moves):
    """A closed contact that never opens, and an open one that never closes; after a rest in park."""
    bench.play(2.0 * SETTINGS.settle_s, OFF, True)
    bench.play(0.0, SLOW, contact)
    begin_s, number = bench.now_s, 0
    while bench.relays.on:
        number += 1
        bench.play(0.0, moves[number % len(moves)], contact)
        assert bench.now_s - begin_s < 60.0
    limit_s = SETTINGS.leave_timeout_s if contact else SETTINGS.turn_timeout_s
    assert bench.now_s - begin_s == pytest.approx(limit_s, abs=2 * POLL_S)
    assert bench.fault is (Fault.PARK_NEVER_OPENS if contact else Fault.PARK_NEVER_CLOSES)


def test_it_tries_three_times_with_a_pause_and_then_is_locked_out_until_the_stalk_is_put_off(bench):
    bench.play(0.0, SLOW, True)
    bench.play(0.1, SLOW, False)
    drives, was_on = [bench.now_s], True
    for _ in range(round(60.0 / POLL_S)):
        bench.play(0.0, SLOW, False)
        drives += [bench.now_s] if bench.relays.on is not was_on else []
        was_on = bench.relays.on
    lasted_s = np.diff(drives)
    assert lasted_s[::2][1:] == pytest.approx([SETTINGS.turn_timeout_s] * (SETTINGS.tries - 1), abs=2 * POLL_S)
    assert lasted_s[1::2] == pytest.approx([SETTINGS.retry_pause_s] * (SETTINGS.tries - 1), abs=2 * POLL_S)
    assert bench.state.phase is Phase.LOCKOUT
    assert bench.play(30.0, FAST, False) == RELAYS_OFF
    bench.play(0.0, OFF, False)
    assert bench.until(lambda: bench.relays.on, SLOW, False) < 0.1
    took_s = bench.until(lambda: not bench.relays.on, SLOW, False)
    assert took_s == pytest.approx(SETTINGS.turn_timeout_s, abs=2 * POLL_S), "all of the time of a turn"
    assert bench.state.tries == 2, "it lay on the screen, and did not come to park"


def test_minutes_of_wiping_with_a_sound_park_switch_are_no_fault(bench):
    for _ in range(100):
        bench.play(0.2, SLOW, True)
        assert bench.play(1.2, SLOW, False) == DRIVE
    assert bench.fault is Fault.NONE


def test_a_high_current_is_a_stall_only_when_it_stays(bench):
    bench.play(0.1, SLOW, True, current_a=20.0)
    bench.play(0.1, SLOW, False, current_a=3.0)
    assert bench.play(SETTINGS.stall_s - POLL_S, SLOW, False, current_a=SETTINGS.stall_current_a + 0.1).on
    bench.play(0.0, SLOW, False, current_a=3.0)
    assert bench.play(3.0, SLOW, False, current_a=SETTINGS.stall_current_a).on
    took_s = bench.until(lambda: not bench.relays.on, SLOW, False, -11.0)
    assert took_s == pytest.approx(SETTINGS.stall_s, abs=2 * POLL_S), "the sign does not matter"
    assert bench.fault is Fault.STALL


def test_a_warm_motors_stall_is_a_current_above_its_own_threshold_for_its_own_time():
    seat = Mind(RelaySettings(warm_stall_current_a=4.0, warm_stall_s=0.5))
    seat.play(0.1, SLOW, True)
    assert seat.play(2.0, SLOW, False, current_a=4.0).on
    took_s = seat.until(lambda: not seat.relays.on, SLOW, False, 4.01)
    assert took_s == pytest.approx(0.5, abs=2 * POLL_S)
    assert seat.fault is Fault.STALL


def test_a_fault_is_reported_until_a_sound_turn_or_a_rest_in_park(bench):
    bench.play(0.05, SLOW, True)
    bench.play(0.05, SLOW, None)
    assert bench.fault is Fault.PARK_UNKNOWN
    bench.play(1.0, SLOW, False)
    assert bench.fault is Fault.PARK_UNKNOWN
    bench.play(0.0, SLOW, True)
    assert bench.fault is Fault.NONE
    bench.play(0.05, SLOW, None)
    bench.play(SETTINGS.settle_s - 4 * POLL_S, OFF, True)
    assert bench.fault is Fault.PARK_UNKNOWN
    bench.play(8 * POLL_S, OFF, True)
    assert bench.fault is Fault.NONE


def test_a_contact_that_bounces_at_rest_begins_the_rest_anew(bench):
    bench.play(0.05, SLOW, None)
    bench.play(SETTINGS.settle_s - 4 * POLL_S, OFF, True)
    bench.play(0.0, OFF, False)
    took_s = bench.until(lambda: bench.fault is Fault.NONE, OFF, True)
    assert took_s == SETTINGS.settle_s + POLL_S, "from the first poll that sees it closed"


def test_where_the_wiper_rests_with_an_open_contact_a_fault_is_over_after_a_rest_there():
    seat = Mind(RelaySettings(rests_open=True))
    seat.play(1.0, SLOW, None)
    for _ in range(2):  # a turn that is too short to be sound, from outside the window
        assert seat.play(0.2 * SETTINGS.settle_s, OFF, False).on
        seat.play(0.0, OFF, True)
    assert seat.fault is Fault.PARK_UNKNOWN
    took_s = seat.until(lambda: seat.fault is Fault.NONE, OFF, False)
    assert not seat.relays.on
    assert took_s == pytest.approx(SETTINGS.settle_s, abs=2 * POLL_S)


def test_a_turn_is_sound_from_the_time_on_in_which_the_switch_settles():
    seen = {}
    for polls in range(round(0.8 * SETTINGS.settle_s / POLL_S), round(1.2 * SETTINGS.settle_s / POLL_S)):
        bench = Mind()
        for seconds, contact in ((0.05, True), (0.05, None), (polls * POLL_S, False)):
            bench.play(seconds, SLOW, contact)
        begin_s = bench.state.turn_s
        bench.until(lambda bench=bench, begin_s=begin_s: bench.state.turn_s != begin_s, SLOW, True)
        seen[bench.state.turn_s - begin_s] = bench.fault
    assert SETTINGS.settle_s in seen
    assert {fault for turned_s, fault in seen.items() if turned_s >= SETTINGS.settle_s} == {Fault.NONE}
    assert {fault for turned_s, fault in seen.items() if turned_s < SETTINGS.settle_s} == {Fault.PARK_UNKNOWN}


def test_a_supply_that_comes_back_is_trusted_only_after_a_while_above_the_higher_threshold(bench):
    bench.play(0.1, SLOW, True, 3.0, 13.5)
    bench.play(0.3, SLOW, False, 3.0, 13.5)
    assert bench.play(1.0, SLOW, False, 3.0, SETTINGS.brown_out_v).on
    assert not bench.play(0.0, SLOW, False, 3.0, SETTINGS.brown_out_v - 0.1).on
    assert not bench.play(5.0, SLOW, False, 3.0, SETTINGS.resume_v - 0.1).on
    assert not bench.play(SETTINGS.resume_s - POLL_S, SLOW, False, 3.0, SETTINGS.resume_v).on
    assert not bench.play(0.0, SLOW, False, 3.0, SETTINGS.resume_v - 0.1).on
    took_s = bench.until(lambda: bench.relays.on, SLOW, False, 3.0, SETTINGS.resume_v)
    assert took_s == SETTINGS.resume_s + POLL_S, "from the first poll that sees it"


def test_unknown_current_and_supply_are_neither_stall_nor_brown_out(bench):
    bench.play(0.1, SLOW, True)
    assert bench.play(3.0, SLOW, False) == DRIVE


def test_a_silent_park_switch_releases_the_relays_at_once_and_the_wiper_is_parked_when_it_speaks(bench):
    bench.play(0.1, SLOW, True)
    bench.play(0.5, SLOW, False)
    assert bench.play(20.0, SLOW, None) == RELAYS_OFF
    assert bench.play(0.5, OFF, False) == DRIVE
    assert bench.play(0.0, OFF, True) == RELAYS_OFF


@pytest.mark.parametrize("contact", [True, False], ids=["in park", "on the screen"])
@pytest.mark.parametrize("held_up", ["silence", "supply"])
def test_a_blocked_wiper_that_is_held_up_again_and_again_is_not_driven_for_ever(bench, contact, held_up):
    """Neither silence of the park switch nor dips of the supply begin the time of a turn anew."""
    driven = 0
    while bench.state.phase is not Phase.LOCKOUT:
        for _ in range(200):
            driven += bench.play(0.0, SLOW, contact, supply_v=13.5).on
        bench.play(0.0, SLOW, *((None, 3.0, 13.5) if held_up == "silence" else (contact, 3.0, 5.0)))
        assert bench.now_s < 600.0, f"driven for {driven * POLL_S:.0f} s, {bench.state}"
    assert driven * POLL_S < SETTINGS.tries * SETTINGS.turn_timeout_s + 1.0


def test_a_wiper_that_silence_held_up_still_has_the_time_of_a_turn_when_it_is_taken_up_again(bench):
    bench.play(1.0, SLOW, True)
    bench.play(1.0, SLOW, False)
    bench.play(2.0 * SETTINGS.turn_timeout_s, SLOW, None)
    assert bench.play(5.0, SLOW, False) == DRIVE, "the silence itself does not count"
    assert bench.state.tries == 0
