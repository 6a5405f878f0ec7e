"""The relay controller state by state, in virtual time, with a park contact that the test plays by hand."""

import pytest

from hilplant.ecu.relay_controller import RELAYS_OFF, Phase, Relays, Settings, Stalk, State, advance

POLL_S = 0.005
SETTINGS = Settings(pause_s=2.0, park_timeout_s=8.0, debounce_s=0.02)
SLOW = Relays(on=True, fast=False)
FAST = Relays(on=True, fast=True)


class Bench:
    """Plays stalk and park contact to a controller and keeps its answers."""

    def __init__(self) -> None:
        self.state = State()
        self.now_s = 0.0
        self.relays = RELAYS_OFF

    def play(self, seconds: float, stalk: Stalk, contact: bool | None) -> Relays:
        """Hold stalk and contact for a while, at least for one poll."""
        for _ in range(max(1, round(seconds / POLL_S))):
            self.now_s += POLL_S
            self.state, self.relays = advance(self.state, stalk, contact, self.now_s, SETTINGS)
        return self.relays


@pytest.fixture
def bench() -> Bench:
    return Bench()


@pytest.mark.parametrize("contact", [True, False, None])
def test_it_begins_off_and_stays_off_wherever_the_wiper_stands(bench, contact):
    assert bench.play(30.0, Stalk.OFF, contact) == RELAYS_OFF
    assert bench.state.phase is Phase.OFF


def test_slow_and_fast_take_effect_at_once_in_both_directions(bench):
    assert bench.play(0.0, Stalk.SLOW, True) == SLOW
    assert bench.play(0.5, Stalk.SLOW, False) == SLOW
    assert bench.play(0.0, Stalk.FAST, False) == FAST
    assert bench.play(0.0, Stalk.SLOW, False) == SLOW


def test_off_goes_on_slowly_until_the_park_contact_closes(bench):
    bench.play(0.1, Stalk.FAST, True)
    bench.play(0.5, Stalk.FAST, False)
    assert bench.play(0.7, Stalk.OFF, False) == SLOW
    assert bench.play(0.0, Stalk.OFF, True) == RELAYS_OFF
    assert bench.play(5.0, Stalk.OFF, True) == RELAYS_OFF


def test_off_while_the_wiper_is_still_in_the_park_window_makes_one_whole_turn(bench):
    bench.play(0.05, Stalk.SLOW, True)
    assert bench.play(0.05, Stalk.OFF, True) == SLOW
    assert bench.play(1.0, Stalk.OFF, False) == SLOW
    assert bench.play(0.0, Stalk.OFF, True) == RELAYS_OFF


def test_off_while_the_wiper_passes_park_makes_one_more_turn(bench):
    bench.play(1.0, Stalk.SLOW, False)
    bench.play(0.01, Stalk.SLOW, True)
    assert bench.play(0.02, Stalk.OFF, True) == SLOW
    bench.play(1.0, Stalk.OFF, False)
    assert bench.play(0.0, Stalk.OFF, True) == RELAYS_OFF


def test_a_contact_that_bounces_as_it_opens_is_not_taken_for_park(bench):
    bench.play(0.05, Stalk.SLOW, True)
    bench.play(0.0, Stalk.OFF, True)
    for contact in (False, True, False, True, False):
        assert bench.play(0.0, Stalk.OFF, contact) == SLOW
    bench.play(1.0, Stalk.OFF, False)
    assert bench.play(0.0, Stalk.OFF, True) == RELAYS_OFF
    assert bench.play(0.0, Stalk.OFF, False) == RELAYS_OFF
    assert bench.play(1.0, Stalk.OFF, True) == RELAYS_OFF


def test_moving_the_stalk_while_parking_drives_on(bench):
    bench.play(0.5, Stalk.SLOW, False)
    bench.play(0.2, Stalk.OFF, False)
    assert bench.play(0.0, Stalk.FAST, False) == FAST


def test_intermittent_wipes_once_and_rests_for_the_pause(bench):
    for _ in range(3):
        assert bench.play(0.1, Stalk.INTERMITTENT, True) == SLOW
        assert bench.play(1.4, Stalk.INTERMITTENT, False) == SLOW
        assert bench.play(0.0, Stalk.INTERMITTENT, True) == RELAYS_OFF
        assert bench.play(SETTINGS.pause_s - POLL_S, Stalk.INTERMITTENT, True) == RELAYS_OFF


@pytest.mark.parametrize(("stalk", "relays"), [(Stalk.SLOW, SLOW), (Stalk.FAST, FAST), (Stalk.OFF, RELAYS_OFF)])
def test_a_pause_ends_as_soon_as_the_stalk_moves(bench, stalk, relays):
    bench.play(1.0, Stalk.INTERMITTENT, False)
    assert bench.play(0.5, Stalk.INTERMITTENT, True) == RELAYS_OFF
    assert bench.play(0.0, stalk, True) == relays


@pytest.mark.parametrize("stalk", [Stalk.SLOW, Stalk.FAST, Stalk.INTERMITTENT, Stalk.OFF])
@pytest.mark.parametrize("contact", [True, False])
def test_a_park_contact_that_never_changes_ends_the_drive_in_a_fault(bench, stalk, contact):
    bench.play(0.0, Stalk.SLOW, contact)
    assert bench.play(SETTINGS.park_timeout_s - 0.1, stalk, contact).on
    assert bench.play(0.2, stalk, contact) == RELAYS_OFF
    assert bench.state.phase is Phase.FAULT
    assert bench.play(60.0, stalk, contact) == RELAYS_OFF


def test_minutes_of_wiping_with_a_sound_park_switch_are_no_fault(bench):
    for _ in range(100):
        bench.play(0.2, Stalk.SLOW, True)
        assert bench.play(1.2, Stalk.SLOW, False) == SLOW


def test_moving_the_stalk_after_a_fault_tries_again(bench):
    bench.play(9.0, Stalk.SLOW, False)
    assert bench.play(0.0, Stalk.OFF, False) == RELAYS_OFF
    bench.play(0.0, Stalk.SLOW, False)
    assert bench.play(0.0, Stalk.SLOW, False) == SLOW


def test_a_silent_park_switch_releases_the_relays_at_once_and_slow_resumes_with_it(bench):
    bench.play(0.5, Stalk.SLOW, False)
    assert bench.play(0.0, Stalk.SLOW, None) == RELAYS_OFF
    assert bench.play(20.0, Stalk.SLOW, None) == RELAYS_OFF
    assert bench.play(0.0, Stalk.SLOW, False) == SLOW


def test_a_wiper_left_on_the_screen_by_a_silent_park_switch_is_parked_when_it_speaks_again(bench):
    bench.play(0.5, Stalk.SLOW, False)
    bench.play(0.5, Stalk.OFF, None)
    assert bench.play(0.5, Stalk.OFF, False) == SLOW
    assert bench.play(0.0, Stalk.OFF, True) == RELAYS_OFF


def test_a_wiper_that_stands_in_park_after_the_silence_stays_there(bench):
    bench.play(0.5, Stalk.SLOW, False)
    bench.play(0.5, Stalk.OFF, None)
    assert bench.play(1.0, Stalk.OFF, True) == RELAYS_OFF
