"""Channels of the tables over the crank angle: what construction time writes there and the step reads.

A table is an array [knots + 1, channels, 2] of 64-bit floats, C-contiguous: at even steps of the crank angle over
one turn, the value of each channel and its derivative by the crank angle. The last knot equals the first.
"""

LEFT_ROCKER = 0  #: angle of the left rocker [rad]
RIGHT_ROCKER = 1  #: angle of the right rocker [rad]
INERTIA = 2  #: inertia of linkage, arms and blades seen at the crank [kg m2]
GRAVITY = 3  #: torque of gravity at the crank [N m], positive when it opposes positive crank speed
DRAG = 4  #: torque of drag at the crank by the square of the air speed [N m s2/m2], signed as gravity
LEFT_LIFT = 5  #: lift of the left blade by the square of the air speed [N s2/m2], positive away from the screen
RIGHT_LIFT = 6  #: the same of the right blade
DAMPING = 7  #: viscous damping of the pivots seen at the crank [N m s/rad]
POINTS = 8  #: first of the left blade's points, then those of the right: way by crank angle [m/rad], signed

#: Behind the points: what arm and blade of one side have of INERTIA, GRAVITY and DRAG; left, then right.
SIDE_CHANNELS = 3


def channels(points: int) -> int:
    """Return the number of channels when friction acts at `points` points of each blade."""
    return POINTS + 2 * points + 2 * SIDE_CHANNELS
