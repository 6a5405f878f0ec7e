"""What the crank has to move: the load models by number, and the worm gear that lets none of them drive the motor."""

from hilplant.jit import compiled
from hilplant.models.polynomial import torque_over_speed
from hilplant.models.records import Load

#: Names of the models; ``Load.model`` is the place in this list.
LOADS = ("none", "polynomial")

POLYNOMIAL = LOADS.index("polynomial")


@compiled
def load_damping(crank_angle_rad: float, crank_speed_rad_s: float, load: Load) -> float:
    """Return the load torque at the crank over the crank's speed [N m s/rad], never negative.

    The worm gear is self-locking (footnote 16 of Dooner 2016): a torque in the direction of motion does not reach
    the motor. As a quotient that cannot become negative the load takes energy out at every speed, also when the
    step holds the quotient fixed and lets the speed change.
    """
    if load.model == POLYNOMIAL:
        return max(0.0, torque_over_speed(crank_angle_rad, crank_speed_rad_s, load.c1, load.c2))
    return 0.0


@compiled
def load_torque(crank_angle_rad: float, crank_speed_rad_s: float, load: Load, brake_torque_n_m: float) -> float:
    """Return the torque at the crank [N m], the brake's included, positive when it opposes the motion; 0 at rest."""
    if crank_speed_rad_s == 0.0:
        return 0.0
    damping = load_damping(crank_angle_rad, crank_speed_rad_s, load)
    return damping * abs(crank_speed_rad_s) + brake_torque_n_m
