"""The demonstration's figures from columns whose truth is known, and its sequence."""

import math
from itertools import pairwise

import numpy as np
import pytest

from hilplant.demo.figures import COLUMNS, figures
from hilplant.demo.sequence import SHORTEST_S, WHOLE_S, sequence
from hilplant.demo.summary import loop_lines, wiping_lines
from hilplant.ecu.stalk import stalk_at
from hilplant.ecu.vocabulary import Master
from hilplant.failure import Failure
from hilplant.runtime.server import Summary

STEP_S = 0.001


def made_run():
    """Two turns slow at 40 a minute, three fast at 60, then a stop 2 degrees short of park."""
    slow, fast, rest = (round(seconds / STEP_S) for seconds in (3.0, 3.0, 1.0))
    rate = np.concatenate([np.full(slow, 40.0), np.full(fast, 60.0), np.zeros(rest)])
    speed = rate * 2.0 * math.pi / 60.0
    angle = np.cumsum(speed) * STEP_S
    angle[-rest:] = 5.0 * 2.0 * math.pi - math.radians(2.0)
    time_s = np.arange(len(rate)) * STEP_S
    return {
        "time_s": time_s,
        "in_relay_on": (rate > 0.0).astype(float),
        "in_relay_fast": (rate > 50.0).astype(float),
        "crank_angle_rad": angle % (2.0 * math.pi),
        "crank_speed_rad_s": speed,
        "current_a": np.where(time_s < 0.1, 20.0, rate / 10.0),
        "park_contact": (rate == 0.0).astype(float),
    }


def test_figures_of_a_run_with_known_rates_currents_and_stop():
    columns = made_run()
    assert set(columns) == set(COLUMNS)
    found = figures(columns)
    assert found.wipes == 5
    assert found.slow == pytest.approx((40.0, 4.0, 20.0))
    assert found.fast == pytest.approx((60.0, 6.0, 6.0))
    assert [(stop.in_park, round(stop.angle_deg, 6)) for stop in found.stops] == [(True, -2.0)]
    assert found.stops[0].time_s == pytest.approx(6.0)


def test_a_run_in_which_nothing_moved_has_no_rates_and_no_stops():
    columns = {name: np.zeros(100) for name in COLUMNS} | {"time_s": np.arange(100) * STEP_S}
    found = figures(columns)
    assert found.wipes == 0
    assert found.stops == ()
    assert math.isnan(found.slow.cycles_per_min)
    assert wiping_lines(found) == ["wipes         0"]


def test_the_summary_fits_80_columns():
    lines = wiping_lines(figures(made_run()))
    lines += loop_lines(Summary(20_000, 12, 12.3, 456.7, 8000.0, 8532.1))
    assert lines[1] == "slow          40.0 cycles/min, current 4.00 A mean, 20.00 A peak"
    assert lines[3] == "park stop     at   6.00 s, -2.0 deg from park, contact closed"
    assert max(map(len, lines)) <= 80


@pytest.mark.parametrize("seconds", [None, WHOLE_S, 12.0, 3600.0])
def test_the_sequence_shows_every_mode_in_order_within_its_time(seconds):
    plan = sequence(seconds)
    times = [turn.time_s for turn in plan.turns] + [plan.seconds]
    middles = [(earlier + later) / 2.0 for earlier, later in pairwise(times)]
    stages = [stalk_at(plan.turns, at_s).master for at_s in middles]
    assert stages == [Master.OFF, Master.SLOW, Master.FAST, Master.INTERMITTENT, Master.OFF, Master.OFF]
    assert stalk_at(plan.turns, times[-2]).flick
    assert all(later - earlier >= 0.29 for earlier, later in pairwise(times))
    assert plan.seconds == (seconds or 20.0)


@pytest.mark.parametrize("seconds", [SHORTEST_S, 3.0, 7.9])
def test_a_short_demonstration_is_the_beginning_of_the_shortest_whole_one(seconds):
    assert sequence(seconds) == sequence(WHOLE_S)._replace(seconds=seconds)


@pytest.mark.parametrize("seconds", [0.9, 0.0, -1.0, math.nan, math.inf])
def test_a_time_too_short_or_senseless_is_refused_in_one_line(seconds):
    with pytest.raises(Failure, match=r"^demo: --seconds must be from 1 to 86400, not .*$"):
        sequence(seconds)
