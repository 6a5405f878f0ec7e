"""Continuous speed from two brushes, the chart of section 7.6 of Dooner (2016)."""

from hilplant.control.records import Controller, Stage
from hilplant.jit import compiled
from hilplant.units import TURN_RAD


@compiled
def choose_stage(stage: Stage, voltage_v: float, reference_rad_s: float, controller: Controller) -> tuple[Stage, float]:
    """Return the brush to use from now on, and the factor by which the voltage changes with it (1 if it stays).

    The fast brush is taken after the voltage was above the upper threshold for a while, the slow one after it was
    below the lower threshold for a whole turn of the crank at the reference. The thesis names the upper threshold
    alone, 18 V. The rest is ours: the while keeps a start at full voltage from changing the brush. The load goes up and
    down twice a turn, so anything shorter than a turn on the way back would change the brush with each wipe. With the
    factor, the ratio of the brushes' constants, the motor feels no jump of its no-load speed.
    """
    stages = controller.stages
    on_fast = stage.fast > 0.5
    beyond = voltage_v < stages.down_v if on_fast else voltage_v > stages.up_v
    share = reference_rad_s * controller.period_s / TURN_RAD if on_fast else controller.period_s / stages.hold_s
    waited = stage.waited + share if beyond else 0.0
    if waited < 1.0:
        return Stage(stage.fast, waited), 1.0
    return Stage(1.0 - stage.fast, 0.0), 1.0 / stages.factor if on_fast else stages.factor
