"""PID control of the crank's speed, (7.1) of Dooner (2016), in discrete time."""

from hilplant.control.records import Controller, PidMemory
from hilplant.jit import compiled


@compiled
def pid(
    memory: PidMemory, speed_rad_s: float, reference_rad_s: float, controller: Controller
) -> tuple[PidMemory, float]:
    """Return the memory, and the voltage [V] within the limits.

    The integral is a sum of rectangles. Anti-windup: the integral does not move on in the direction of a
    limit that the voltage has reached (conditional integration).
    """
    gains, period = controller.pid, controller.period_s
    error = reference_rad_s - speed_rad_s
    step = gains.integral * error * period
    direct = gains.proportional * (gains.weight * reference_rad_s - speed_rad_s)
    direct += gains.derivative * (error - memory.error) / period
    integral = memory.integral_v + step
    if step > 0.0:
        integral = max(memory.integral_v, min(integral, controller.highest_v - direct))
    else:
        integral = min(memory.integral_v, max(integral, controller.lowest_v - direct))
    voltage = min(max(direct + integral, controller.lowest_v), controller.highest_v)
    return PidMemory(integral, error), voltage
