"""The stalk position `automatic`: the rain sensor's signal chooses among off, the six pauses, slow and fast.

A wipe takes water away, so that the signal falls after each: more rain is obeyed at once, less of it one stage at a
time, each only after the signal has asked for less for some time.
"""

import math
from typing import NamedTuple

from hilplant.ecu.vocabulary import INTERVALS, Master, RelaySettings, Stalk

#: What each stage asks of the chart, from no rain to heavy rain: the longest pause comes first.
STAGES = (
    (Master.OFF, 1),
    *((Master.INTERMITTENT, interval) for interval in reversed(INTERVALS)),
    (Master.SLOW, 1),
    (Master.FAST, 1),
)


class RainStage(NamedTuple):
    """Which of the stages is in force, and since when the signal asks for less."""

    stage: int = 0
    less_s: float = math.inf


def choose_stage(before: RainStage, rain: float, now_s: float, settings: RelaySettings) -> RainStage:
    """Return the stage after one look at the signal, 0 to 1; nan, a signal that is not known, keeps the stage."""
    if math.isnan(rain):
        return RainStage(before.stage)
    wanted = sum(rain >= level for level in settings.rain_levels)
    if wanted >= before.stage:
        return RainStage(wanted)
    less_s = min(before.less_s, now_s)
    if now_s - less_s < settings.rain_hold_s:
        return RainStage(before.stage, less_s)
    return RainStage(before.stage - 1)


def demanded(stalk: Stalk, stage: RainStage, rain: float) -> Stalk:
    """Return the stalk as the chart is to see it; a rain sensor that is silent from the start means intermittent."""
    if not stalk.automatic:
        return stalk
    if math.isnan(rain) and stage.stage == 0:
        return stalk._replace(master=Master.INTERMITTENT)
    master, interval = STAGES[stage.stage]
    return stalk._replace(master=master, interval=interval)
