"""Whether load and motor are still those for which the networks of a bench were trained.

A fault, wear, heat or a command from beside the run may change any of their parameters. A sum over all of them tells,
by whatever it was changed, and without a list that someone could forget to keep.
"""

from hilplant.jit import compiled
from hilplant.models.records import Load, Motor, Parameters
from hilplant.models.row import summed


@compiled
def load_mark(load: Load) -> float:
    """Return a number that changes with everything that the torque of a load depends on, its model apart."""
    blades = 3.0 * summed(load.left_blade) + 5.0 * summed(load.right_blade)
    return summed(load.friction) + blades + 7.0 * load.points


@compiled
def motor_mark(motor: Motor) -> float:
    """Return a number that changes with any parameter of a motor; what its gear loses the network does not contain."""
    shaft = 5.0 * motor.inertia_kg_m2 + 7.0 * motor.damping_n_m_s + 11.0 * motor.coulomb_torque_n_m
    return summed(motor.slow) + 3.0 * summed(motor.fast) + shaft + 13.0 * motor.gear_ratio


@compiled
def load_altered(parameters: Parameters) -> bool:
    """Return whether the load has obstacles, lost arms, play, or other parameters than in the training."""
    around = parameters.obstacles.altered > 0.5 or parameters.linkage.altered > 0.5
    other = parameters.trained_load != 0.0 and load_mark(parameters.load) != parameters.trained_load
    return bool(around or other)


@compiled
def motor_altered(parameters: Parameters) -> bool:
    """Return whether motor and wires are others than in the training, which knows a cold motor on ideal wires."""
    around = parameters.wiring.altered > 0.5 or parameters.heat.altered > 0.5 or parameters.linkage.altered > 0.5
    other = parameters.trained_motor != 0.0 and motor_mark(parameters.motor) != parameters.trained_motor
    return bool(around or other or parameters.obstacles.altered > 0.5)
