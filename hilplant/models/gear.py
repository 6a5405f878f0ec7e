"""The worm gear between motor and crank: what of the load reaches the motor shaft, and what a standing shaft holds.

While the motor drives the load, efficiency e passes from the motor to the crank. While the load drives, the part eb
of its torque passes to the motor; 0 is a self-locking worm. In the direction of motion, with the motor's own torque f
(friction deducted), the torque r of the load without its inertia M, and the ratio N,

    driving: (J + M/(N^2 e)) dw/dt = f - r/(N e)    while    M f/N + r J >= 0, and else
    driven:  (J + eb M/N^2) dw/dt = f - eb r/N.

Where one changes into the other no torque passes, and both give the same acceleration.
"""

from hilplant.jit import compiled
from hilplant.models.armature import ArmatureDrive, ArmatureMotion
from hilplant.models.circuit import Connection
from hilplant.models.records import Motor
from hilplant.models.resistance import Resistance


@compiled
def through_gear(
    load: Resistance, direction: float, motion: ArmatureMotion, connection: Connection, motor: Motor
) -> ArmatureDrive:
    """Return what acts on the armature, seen at its shaft, while it turns in `direction`, +1 or -1.

    Which of the two holds is decided by `motion`, its current and speed.
    """
    ratio, alone = motor.gear_ratio, unloaded(connection, motor)
    pull = alone.constant * motion.current + alone.push - alone.damping * motion.speed
    torque = direction * pull - motor.coulomb_torque_n_m
    dry = direction * load.bias + load.dry
    driving = (
        load.inertia * torque / ratio + (dry + load.slope * abs(motion.speed) / ratio) * motor.inertia_kg_m2 >= 0.0
    )
    passing = 1.0 / (ratio * motor.gear_efficiency) if driving else motor.gear_back_efficiency / ratio
    return ArmatureDrive(
        voltage=alone.voltage,
        resistance=alone.resistance,
        inductance=alone.inductance,
        constant=alone.constant,
        inertia=motor.inertia_kg_m2 + load.inertia * passing / ratio,
        damping=alone.damping + load.slope * passing / ratio,
        dry_torque=motor.coulomb_torque_n_m + dry * passing,
        push=alone.push,
    )


@compiled
def unloaded(connection: Connection, motor: Motor) -> ArmatureDrive:
    """Return what acts on the armature where nothing is behind the gear."""
    brush, closed = connection.brush, connection.closed > 0.5
    return ArmatureDrive(
        voltage=connection.source_v if closed else 0.0,
        resistance=brush.resistance_ohm,
        inductance=brush.inductance_henry,
        constant=brush.constant_v_s if closed else 0.0,
        inertia=motor.inertia_kg_m2,
        damping=motor.damping_n_m_s + connection.second.damping_n_m_s,
        dry_torque=motor.coulomb_torque_n_m,
        push=connection.second.push_n_m,
    )


@compiled
def held_torque(load: Resistance, direction: float, motor: Motor) -> float:
    """Return the torque of the motor [N m] from which a standing shaft breaks away in `direction`.

    A load that pulls in that direction lowers it only as far as the worm lets it: not at all when self-locking.
    """
    torque = direction * load.bias + load.dry
    if torque > 0.0:
        return motor.coulomb_torque_n_m + torque / (motor.gear_ratio * motor.gear_efficiency)
    return motor.coulomb_torque_n_m + torque * motor.gear_back_efficiency / motor.gear_ratio
