"""Continuous speed from two brushes, the chart of section 7.6 of Dooner (2016)."""

from hilplant.control.records import Controller, Stage
from hilplant.jit import compiled


@compiled
def choose_stage(stage: Stage, voltage_v: float, controller: Controller) -> tuple[Stage, float]:
    """Return the brush to use from now on, and the factor by which the voltage changes with it (1 if it stays).

    The fast brush is taken after the voltage was above the upper threshold for a while, the slow one after it was
    below the lower threshold as long. The source names the upper threshold alone, 18 V. The lower one and the time
    are ours: they keep a start at full voltage, or the ripple of a wipe, from changing the brush. With the factor, the
    ratio of the brushes' constants, the motor feels no jump of its no-load speed.
    """
    stages = controller.stages
    on_fast = stage.fast > 0.5
    beyond = voltage_v < stages.down_v if on_fast else voltage_v > stages.up_v
    waited = stage.waited_s + controller.period_s if beyond else 0.0
    if not beyond or waited < stages.hold_s:
        return Stage(stage.fast, waited), 1.0
    return Stage(1.0 - stage.fast, 0.0), 1.0 / stages.factor if on_fast else stages.factor
