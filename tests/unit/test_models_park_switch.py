"""The park switch over the crank angle: window, hysteresis, bounce."""

import math

from hilplant.models.park_switch import cam_closed, contact_now
from hilplant.models.records import ParkSwitch

PARK = 0.05
SWITCH = ParkSwitch(angle_rad=PARK, half_window_rad=0.1, hysteresis_rad=0.02, bounce_ticks=0.0)


def at(distance: float) -> float:
    return (PARK + distance) % (2.0 * math.pi)


def test_the_window_wraps_around_zero() -> None:
    for distance in (-0.099, -0.051, -0.049, 0.0, 0.099):
        assert cam_closed(at(distance), 0.0, SWITCH) == 1.0
    for distance in (-0.101, 0.101, math.pi, 3.0, -3.0):
        assert cam_closed(at(distance), 0.0, SWITCH) == 0.0


def test_between_closing_and_opening_the_contact_stays_as_it_was() -> None:
    for distance in (-0.119, -0.101, 0.101, 0.119):
        assert cam_closed(at(distance), 1.0, SWITCH) == 1.0
        assert cam_closed(at(distance), 0.0, SWITCH) == 0.0
    assert cam_closed(at(0.121), 1.0, SWITCH) == 0.0
    assert cam_closed(at(-0.121), 1.0, SWITCH) == 0.0


def shown(angles: list[float], bounce_ticks: float, closed: float) -> list[float]:
    switch, left, seen = SWITCH._replace(bounce_ticks=bounce_ticks), 0.0, []
    for angle in angles:
        contact = contact_now(angle, closed, left, switch)
        closed, left = contact.closed, contact.bounce_left
        seen.append(contact.shown)
    return seen


def test_without_bounce_the_edge_is_clean() -> None:
    assert shown([at(0.5), at(0.0), at(0.0), at(0.5)], 0.0, closed=0.0) == [0.0, 1.0, 1.0, 0.0]


def test_after_an_edge_the_contact_toggles_for_its_ticks_and_settles() -> None:
    assert shown([at(0.0)] * 7, 3.0, closed=0.0) == [1.0, 0.0, 1.0, 0.0, 1.0, 1.0, 1.0]
    assert shown([at(0.5)] * 7, 4.0, closed=1.0) == [0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0]


def test_a_new_edge_starts_the_bounce_again() -> None:
    assert shown([at(0.0), at(0.0), at(0.5), at(0.5), at(0.5), at(0.5)], 2.0, closed=0.0) == [1, 0, 0, 1, 0, 0]
