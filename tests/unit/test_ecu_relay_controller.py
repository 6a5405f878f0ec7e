"""What the controller makes of time: debounce, pauses, timeouts, counts and thresholds, to the poll."""

import math

import numpy as np
import pytest

from hilplant.ecu.chart import Phase
from hilplant.ecu.relay_controller import ControllerState, advance
from hilplant.ecu.vocabulary import INTERVALS, RELAYS_OFF, EcuInputs, Fault, Master, RelayCommand, RelaySettings, Stalk

POLL_S = 1.0 / 256.0  # sums of it are exact
SETTINGS = RelaySettings()
OFF, SLOW, FAST = Stalk(), Stalk(Master.SLOW), Stalk(Master.FAST)
DRIVE = RelayCommand(on=True, fast=False)


class Bench:
    """Plays inputs to a controller and keeps its answers."""

    def __init__(self, settings: RelaySettings = SETTINGS) -> None:
        self.settings = settings
        self.state, self.relays, self.fault, self.now_s = ControllerState(), RELAYS_OFF, Fault.NONE, 0.0

    def play(
        self, seconds: float, stalk: Stalk, contact: bool | None, current_a=math.nan, supply_v=math.nan
    ) -> RelayCommand:
        """Hold the inputs for a while, at least for one poll."""
        for _ in range(max(1, round(seconds / POLL_S))):
            self.now_s += POLL_S
            inputs = EcuInputs(stalk, contact, current_a, supply_v)
            self.state, self.relays, self.fault = advance(self.state, inputs, self.now_s, self.settings)
        return self.relays

    def until(self, condition, *inputs) -> float:
        """Hold the inputs until the condition holds; return how long that took."""
        begin_s = self.now_s
        while not condition():
            self.play(0.0, *inputs)
            assert self.now_s - begin_s < 60.0
        return self.now_s - begin_s


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_it_begins_off_and_stays_off(bench):
    assert bench.play(30.0, OFF, True) == RELAYS_OFF
    assert bench.state.phase is Phase.OFF
    assert bench.fault is Fault.NONE


def test_a_park_switch_that_is_silent_at_rest_is_reported_after_a_while_and_nothing_is_driven(bench):
    assert bench.play(0.49, OFF, None) == RELAYS_OFF
    assert bench.fault is Fault.NONE, "the first frame may still come"
    assert bench.play(30.0, OFF, None) == RELAYS_OFF
    assert bench.fault is Fault.PARK_UNKNOWN
    assert bench.play(0.6, OFF, True) == RELAYS_OFF
    assert bench.fault is Fault.NONE


def test_where_the_wiper_rests_with_an_open_contact_silence_at_rest_moves_nothing():
    seat = Bench(RelaySettings(rests_open=True))
    seat.play(1.0, OFF, None)
    assert seat.play(5.0, OFF, False) == RELAYS_OFF
    assert seat.fault is Fault.NONE


def test_off_while_the_wiper_is_still_in_the_park_window_makes_one_whole_turn(bench):
    bench.play(0.05, SLOW, True)
    assert bench.play(0.05, OFF, True) == DRIVE
    assert bench.play(1.0, OFF, False) == DRIVE
    assert bench.play(0.0, OFF, True) == RELAYS_OFF


def test_off_while_the_wiper_passes_park_makes_one_more_turn(bench):
    bench.play(0.05, SLOW, True)
    bench.play(1.0, SLOW, False)
    bench.play(0.01, SLOW, True)
    assert bench.play(0.02, OFF, True) == DRIVE
    bench.play(1.0, OFF, False)
    assert bench.play(0.0, OFF, True) == RELAYS_OFF


@pytest.mark.parametrize(("rests_open", "begins", "arrivals"), [(True, False, 2), (True, True, 1), (False, True, 1)])
def test_the_window_that_a_wiper_passes_as_it_leaves_is_not_taken_for_its_return(rests_open, begins, arrivals):
    """One that rests outside the window meets it twice in its first turn; one that starts inside has left it."""
    seat = Bench(RelaySettings(rests_open=rests_open))
    seat.play(1.0, OFF, begins)
    seat.play(0.05, SLOW, begins)
    for arrival in range(1, arrivals + 1):
        assert seat.play(0.3, OFF, False) == DRIVE
        seat.play(0.0, OFF, True)
        assert seat.relays == (DRIVE if arrival < arrivals else RELAYS_OFF)


@pytest.mark.parametrize("edges", [3, 6, 10])
@pytest.mark.parametrize("window_s", [0.5, 1.0, 2.0])
def test_as_many_edges_within_a_window_are_bounces_and_one_less_in_each_is_wiping(edges, window_s):
    for number in (edges - 1, edges):
        seat = Bench(RelaySettings(bounce_edges=edges, bounce_window_s=window_s))
        seat.play(POLL_S, SLOW, True)
        contact = True
        seat.until(lambda: (seat.now_s + POLL_S) % window_s == 0.0, SLOW, contact)  # noqa: B023
        for _ in range(2):
            for _ in range(number):
                contact = not contact
                seat.play(0.0, SLOW, contact)
            seat.play(window_s - number * POLL_S, SLOW, contact)
        assert (seat.fault is Fault.PARK_BOUNCES) == (number == edges)


def test_a_contact_that_bounces_as_it_opens_is_not_taken_for_park(bench):
    bench.play(0.05, SLOW, True)
    bench.play(0.0, OFF, True)
    for contact in (False, True, False, True, False):
        assert bench.play(0.0, OFF, contact) == DRIVE
    bench.play(1.0, OFF, False)
    assert bench.play(0.0, OFF, True) == RELAYS_OFF
    assert bench.play(0.0, OFF, False) == RELAYS_OFF, "nor is a bounce as it closes taken for standing off park"
    assert bench.play(1.0, OFF, True) == RELAYS_OFF


@pytest.mark.parametrize("interval", INTERVALS)
def test_each_pause_is_as_long_as_its_setting_to_the_poll_even_when_the_switch_is_moved_meanwhile(bench, interval):
    stalk = Stalk(Master.INTERMITTENT, interval)
    bench.play(0.05, stalk, True)
    bench.play(1.0, stalk, False)
    assert bench.play(0.0, stalk, True) == RELAYS_OFF
    other = Stalk(Master.INTERMITTENT, 7 - interval)
    took_s = bench.until(lambda: bench.relays.on, other, True)
    assert took_s == pytest.approx(SETTINGS.pauses_s[interval - 1], abs=POLL_S)


@pytest.mark.parametrize("contact", [True, False])
@pytest.mark.parametrize("moves", [(SLOW,), (SLOW, FAST, OFF)])
def test_driving_without_park_ends_after_its_timeout_whatever_the_stalk_does(bench, contact, moves):
    """A closed contact that never opens, and an open one that never closes."""
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
    seat = Bench(RelaySettings(warm_stall_current_a=4.0, warm_stall_s=0.5))
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


def test_where_the_wiper_rests_with_an_open_contact_a_fault_is_over_after_a_rest_there():
    seat = Bench(RelaySettings(rests_open=True))
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
        bench = Bench()
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
    assert not bench.play(0.0, SLOW, False, 3.0, SETTINGS.brown_out_v - 0.1).on
    assert not bench.play(5.0, SLOW, False, 3.0, SETTINGS.resume_v - 0.1).on
    assert not bench.play(SETTINGS.resume_s - POLL_S, SLOW, False, 3.0, SETTINGS.resume_v).on
    assert not bench.play(0.0, SLOW, False, 3.0, SETTINGS.resume_v - 0.1).on
    took_s = bench.until(lambda: bench.relays.on, SLOW, False, 3.0, SETTINGS.resume_v)
    assert took_s == pytest.approx(SETTINGS.resume_s, abs=2 * POLL_S)


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
