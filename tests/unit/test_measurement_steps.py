"""Steps of the voltage by their definition, one place after the other: two quiet levels with a jump between them."""

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.measurements.alignment import AFTER_S, BEFORE_S, STEP_PART, voltage_steps


def by_definition(volts: Floats, period_s: float) -> list[int]:
    before, after, most = round(BEFORE_S / period_s), round(AFTER_S / period_s), float(np.ptp(volts))
    found: list[int] = []
    for place in range(before + 1, len(volts) - after):
        left, right = volts[place - before : place - 1], volts[place + 1 : place + after]
        level = abs(np.median(right) - np.median(left))
        jump = abs(volts[place] - volts[place - 1])
        if min(jump, level) > STEP_PART * most and max(np.std(left), np.std(right)) < 0.1 * level:
            found.append(place)
    return [place for place in found if not any(0 < place - other <= 2 for other in found)]


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("period_s", [1e-3, 2.5e-4])
def test_steps_are_those_of_the_definition(seed: int, period_s: float) -> None:
    chance = np.random.default_rng(seed)
    levels = chance.choice([0.0, 3.0, 9.0, 12.0, 13.5, -12.0], 12)
    volts = np.repeat(levels, chance.integers(20, 160, 12) * round(1e-3 / period_s))
    volts = volts + chance.normal(0.0, (0.0, 0.05, 0.3)[seed % 3], len(volts))
    volts += (0.0, 2.0)[seed % 2] * (np.arange(len(volts)) % 7 == 0)  # ripple
    volts[chance.integers(0, len(volts), 5)] += 6.0  # single wrong samples
    expected = by_definition(volts, period_s)
    assert voltage_steps(volts, period_s) == expected
    assert expected or seed % 2, "without ripple there are steps"
