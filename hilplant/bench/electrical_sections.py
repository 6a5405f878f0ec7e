"""What a bench says about supply, wires and relays; whatever is left out is ideal."""

from typing import Annotated

from pydantic import Field

from hilplant.bench.durations import Milliseconds
from hilplant.bench.parts import WithAssumptions
from hilplant.checked_yaml.checked import Checked, NotNegative
from hilplant.models.records import Relays, RelayTiming, Sensors, Wire, Wiring
from hilplant.units import MILLISECOND_NS


class SupplySection(WithAssumptions):
    """Between the battery and terminal 30."""

    resistance_ohm: NotNegative = Field(description="resistance of battery and harness")


class WiresSection(WithAssumptions):
    """Resistances of the wires between the switches and the motor."""

    terminal_53_ohm: NotNegative = Field(default=0.0, description="wire to the slow brush")
    terminal_53b_ohm: NotNegative = Field(default=0.0, description="wire to the fast brush")
    terminal_53e_ohm: NotNegative = Field(default=0.0, description="wire from the park contact")
    terminal_31_ohm: NotNegative = Field(default=0.0, description="wire from the common brush to ground")


class RelayEntry(WithAssumptions):
    """How a relay follows its command; times are rounded to ticks."""

    operate_ms: Milliseconds = Field(default=0.0, description="from the command to the leaving of the contact, on")
    release_ms: Milliseconds = Field(default=0.0, description="the same, off")
    transfer_ms: Milliseconds = Field(default=0.0, description="between the contacts, where the current is interrupted")
    bounce_ms: Milliseconds = Field(default=0.0, description="for how long the contact bounces after it was made")

    def record(self, step_ns: int) -> RelayTiming:
        """Return the times in ticks, as the models take them."""
        times_ms = (self.operate_ms, self.release_ms, self.transfer_ms, self.bounce_ms)
        return RelayTiming(*(float(round(time_ms * MILLISECOND_NS / step_ns)) for time_ms in times_ms))


class RelaysSection(Checked):
    """The two relays between the commands and the motor."""

    relay_on: RelayEntry = Field(default=RelayEntry(), description="the ON/OFF relay")
    relay_fast: RelayEntry = Field(default=RelayEntry(), description="the FAST/SLOW relay")

    def record(self, step_ns: int) -> Relays:
        """Return the parameters as the models take them; ideal relays are not altered."""
        on, fast = self.relay_on.record(step_ns), self.relay_fast.record(step_ns)
        return Relays(float((on, fast) != (RelayTiming(), RelayTiming())), on, fast)


class CurrentSensorSection(WithAssumptions):
    """How the motor current is measured: `measured_current_a`, and what a controller inside the loop sees."""

    noise_a: NotNegative = Field(default=0.0, description="standard deviation of its white noise")
    ripple: Annotated[float, Field(ge=0, le=1)] = Field(
        default=0.0, description="height of the commutator's ripple, as a part of the current"
    )
    ripples_a_turn: NotNegative = Field(
        default=0.0,
        description="how many in a turn of the motor shaft: the commutator's bars, twice them if odd",
    )

    def record(self) -> Sensors:
        """Return the parameters as the models take them; an ideal sensor is not altered."""
        made = Sensors(current_noise_a=self.noise_a, current_ripple=self.ripple, ripples_a_turn=self.ripples_a_turn)
        return made._replace(altered=float(made != Sensors()))


def wiring(supply: SupplySection | None, wires: WiresSection | None) -> Wiring:
    """Return supply and wires as the models take them; where all is ideal they are not altered."""
    resistance_ohm = supply.resistance_ohm if supply is not None else 0.0
    of = wires if wires is not None else WiresSection()
    each = (of.terminal_53_ohm, of.terminal_53b_ohm, of.terminal_53e_ohm, of.terminal_31_ohm)
    made = Wiring(0.0, resistance_ohm, 0.0, 0.0, 0.0, *(Wire(ohm) for ohm in each))
    return made._replace(altered=float(made != Wiring()))
