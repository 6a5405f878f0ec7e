"""Typical values of a two-speed wiper motor for 12 V, each with its standard error, for what readings do not tell."""

from functools import cache
from types import MappingProxyType
from typing import Annotated

from pydantic import Field
from uncertainties import UFloat

from hilplant import resources
from hilplant.bench.parts import Sourced
from hilplant.checked_yaml.checked import Checked, Positive
from hilplant.motor_bench.bench_measurements import quantity
from hilplant.motor_bench.no_load_fit import STAGES, read_described

#: Value and standard error, or lowest and highest.
Pair = Annotated[list[Positive], Field(min_length=2, max_length=2)]


class TypicalMode(Checked):
    """Of one brush; the no-load current is at the speed of the sheet, whatever that is."""

    resistance_ohm: Pair
    inductance_henry: Pair
    no_load_current_a: Pair


class TypicalMotor(Sourced):
    """Both brushes and what they share; `voltage_v` is the range of the motors that it stands for."""

    voltage_v: Pair
    slow: TypicalMode
    fast: TypicalMode
    inertia_kg_m2: Pair
    gear_ratio: Pair

    @property
    def values(self) -> dict[str, UFloat]:
        """Each value with its standard error by a flat name, those of a brush as in ``slow_resistance_ohm``."""
        flat = {"inertia_kg_m2": self.inertia_kg_m2, "gear_ratio": self.gear_ratio}
        for stage, mode in zip(STAGES, (self.slow, self.fast), strict=True):
            flat |= {f"{stage}_{name}": pair for name, pair in mode}
        return {name: quantity(*pair) for name, pair in flat.items()}


@cache
def typical_motor() -> TypicalMotor:
    """Return the shipped one."""
    return read_described(resources.named("measurements", "typical_motor"), TypicalMotor)


#: For which parameters of a motor a value of a sheet stands in the end, where that is not of the same name.
LEADS_TO = MappingProxyType({f"{stage}_no_load_current_a": ("damping_n_m_s", "coulomb_torque_n_m") for stage in STAGES})
