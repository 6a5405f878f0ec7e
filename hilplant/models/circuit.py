"""Switching circuit of a relay-controlled wiper, section 7.1.1 of Dooner (2016)."""

from hilplant.jit import compiled
from hilplant.models.records import Brush, Inputs, Motor


@compiled
def switch(inputs: Inputs, motor: Motor) -> tuple[Brush, float]:
    """Return the brush in the circuit, and the voltage [V] between its terminal (53 or 53b) and ground (31).

    The ON/OFF relay connects the selected brush to the supply, or to ground: off is a short circuit through the
    armature, which brakes. The brush that is not selected is open, so that one armature current exists in all
    positions of the relays; it carries over when the FAST/SLOW relay changes, as in Appendix A.
    """
    brush = motor.fast if inputs.relay_fast > 0.5 else motor.slow
    terminal_v = inputs.supply_v if inputs.relay_on > 0.5 else 0.0
    return brush, terminal_v
