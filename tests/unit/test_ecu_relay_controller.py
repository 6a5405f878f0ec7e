"""What the controller makes of time: debounce, pauses, counts of edges, to the poll."""

import pytest
from support.ecu_mind import DRIVE, OFF, POLL_S, SETTINGS, SLOW, Mind

from hilplant.ecu.chart import Phase
from hilplant.ecu.vocabulary import INTERVALS, RELAYS_OFF, Fault, Master, RelaySettings, Stalk


@pytest.fixture
def bench() -> Mind:
    return Mind()


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
    seat = Mind(RelaySettings(rests_open=True))
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
    seat = Mind(RelaySettings(rests_open=rests_open))
    seat.play(1.0, OFF, begins)
    seat.play(0.05, SLOW, begins)
    for arrival in range(1, arrivals + 1):
        assert seat.play(0.3, OFF, False) == DRIVE
        seat.play(0.0, OFF, True)
        assert seat.relays == (DRIVE if arrival < arrivals else RELAYS_OFF)


@pytest.mark.parametrize(("polls", "comes_to_park"), [(8, False), (9, True)])
def test_a_contact_that_was_open_for_as_long_as_it_may_bounce_has_been_away(polls, comes_to_park):
    seat = Mind(RelaySettings(debounce_s=8 * POLL_S))
    seat.play(0.05, SLOW, True)
    seat.play(polls * POLL_S, OFF, False)
    assert seat.play(0.0, OFF, True) == (RELAYS_OFF if comes_to_park else DRIVE)


@pytest.mark.parametrize("edges", [3, 6, 10])
@pytest.mark.parametrize("window_s", [0.5, 1.0, 2.0])
def test_as_many_edges_within_a_window_are_bounces_and_one_less_in_each_is_wiping(edges, window_s):
    for number in (edges - 1, edges):
        seat = Mind(RelaySettings(bounce_edges=edges, bounce_window_s=window_s))
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
    assert took_s == SETTINGS.pauses_s[interval - 1]
