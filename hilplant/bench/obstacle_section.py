"""What a bench says about obstacles in the arms' way; whatever is left out is not there."""

from typing import Annotated

from pydantic import Field

from hilplant.bench.parts import WithAssumptions
from hilplant.checked_yaml.checked import Checked, NotNegative, Positive
from hilplant.models.mechanical_records import Obstacles, SideObstacles
from hilplant.units import RAD_PER_DEG

ArmAngle = Annotated[float, Field(ge=-360, le=360)]
#: Beyond this the step of 1 ms no longer follows a stop [N m/rad].
STIFFEST_N_M_RAD = 1e4
Stiffness = Annotated[float, Field(ge=0, le=STIFFEST_N_M_RAD)]


class EndEntry(WithAssumptions):
    """Something that an arm pushes against beyond an angle."""

    angle_deg: ArmAngle = Field(description="arm angle at which it begins, as left_arm_rad or right_arm_rad shows it")
    stiffness_n_m_rad: Stiffness = Field(description="torque at the arm by arm angle")


class SideObstaclesEntry(WithAssumptions):
    """What one arm meets."""

    above: EndEntry | None = Field(default=None, description="what it pushes against above an angle")
    below: EndEntry | None = Field(default=None, description="what it pushes against below an angle")
    rebound: Annotated[float, Field(ge=0, le=1)] = Field(
        default=0.0, description="part of the torque with which that pushes back: 0 snow, 1 a stop or spring"
    )
    frozen_n_m: NotNegative = Field(default=0.0, description="torque at the arm with which ice holds the blade")

    def record(self) -> SideObstacles:
        """Return the parameters as the models take them."""
        low, high = (entry or EndEntry(angle_deg=0.0, stiffness_n_m_rad=0.0) for entry in (self.below, self.above))
        return SideObstacles(
            low_rad=low.angle_deg * RAD_PER_DEG,
            low_n_m_rad=low.stiffness_n_m_rad,
            high_rad=high.angle_deg * RAD_PER_DEG,
            high_n_m_rad=high.stiffness_n_m_rad,
            rebound=self.rebound,
            frozen_n_m=self.frozen_n_m,
        )


class JamEntry(WithAssumptions):
    """Something jammed at a crank angle."""

    angle_deg: Annotated[float, Field(ge=0, le=360)] = Field(description="crank angle from park in its middle")
    width_deg: Annotated[float, Field(gt=0, le=360)] = Field(default=10.0, description="over which angle it is")
    torque_n_m: NotNegative = Field(default=1000.0, description="dry friction at the crank; a large one blocks it")


class ObstaclesSection(Checked):
    """What stands in the arms' way."""

    left: SideObstaclesEntry = Field(default=SideObstaclesEntry(), description="the left arm")
    right: SideObstaclesEntry = Field(default=SideObstaclesEntry(), description="the right arm")
    slip_deg: Positive = Field(default=2.0, description="how far an arm turns until its blade has left the ice")
    jam: JamEntry | None = Field(default=None, description="something jammed at a crank angle")

    def record(self) -> Obstacles:
        """Return the parameters as the models take them; where nothing is in the way they are not altered."""
        left, right, jam = self.left.record(), self.right.record(), self.jam
        made = Obstacles(
            slip_rad=self.slip_deg * RAD_PER_DEG,
            jam_rad=jam.angle_deg * RAD_PER_DEG if jam is not None else 0.0,
            jam_half_rad=0.5 * jam.width_deg * RAD_PER_DEG if jam is not None else 0.0,
            jam_n_m=jam.torque_n_m if jam is not None else 0.0,
            left=left,
            right=right,
        )
        hinders = jam is not None or (left, right) != (SideObstacles(), SideObstacles())
        return made._replace(altered=1.0) if hinders else Obstacles()
