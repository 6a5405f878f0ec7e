"""Section 7.6 in the loop and on the bus, in virtual time: the fast brush is taken when it is needed, and given back.

The truth is the plant's own speed and relay.
"""

import math
from typing import Any

import numpy as np
import pytest
from support.driven_wiper import BENCH, in_the_loop, mean_of_turns, on_the_bus

from hilplant.control.catalogue import controller_named, with_stages
from hilplant.signals import INPUT_INDEX
from hilplant.thesis.control_test import SpeedProfile, run_drive

SLOW, FAST = 3.14, 7.0
REFERENCE = f"0:{SLOW},3:{FAST},8:{SLOW}"
SECONDS = 14


@pytest.mark.parametrize("run", [in_the_loop, on_the_bus])
@pytest.mark.parametrize("name", ["cascade", "pid", "hebb_fuzzy"])
def test_the_fast_brush_is_taken_once_reaches_the_speed_and_is_given_back_once(run: Any, name: str):
    speed, fast = run(name, REFERENCE, 1.0, SECONDS)
    changes = np.flatnonzero(np.diff(fast))
    assert len(changes) == 2, changes
    up_s, back_s = changes / 1000.0
    assert 3.19 <= up_s < 3.5, "0.2 s above 18 V"
    assert 7.99 + 2.0 * math.pi / SLOW <= back_s < 11.0, "a whole turn below the threshold"
    assert mean_of_turns(speed[5000:8000]) == pytest.approx(FAST, rel=0.02)
    assert mean_of_turns(speed[11000:]) == pytest.approx(SLOW, rel=0.02)


@pytest.mark.parametrize(("wet", "speed"), [(0.0, 3.6), (0.5, 3.4)])
def test_where_a_wipe_goes_over_both_thresholds_the_brush_still_does_not_cycle(wet: float, speed: float):
    """Here the voltage is above 18 V and below 12 V within each half turn."""
    found, fast = in_the_loop("cascade", str(speed), wet, 8.0)
    assert np.count_nonzero(np.diff(fast)) == 1
    assert mean_of_turns(found[3000:]) == pytest.approx(speed, rel=0.02)


def test_the_loop_does_what_the_study_does_bit_for_bit():
    ticks = 5000
    speed, _ = in_the_loop("cascade", str(FAST), 1.0, ticks / 1000)
    rows = np.tile(BENCH.input_row, (ticks, 1))
    rows[:, INPUT_INDEX["screen"]] = 1.0
    controller = with_stages(controller_named("cascade", BENCH.parameters.motor, 0.001), BENCH.parameters.motor)
    study = run_drive(BENCH, controller, SpeedProfile(np.full(ticks, FAST), rows, 0.0))
    assert np.array_equal(study["crank_speed_rad_s"], speed)
