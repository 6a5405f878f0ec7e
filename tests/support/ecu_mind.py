"""The relay controller by itself: inputs that a test holds for a while, and its answers."""

import math

from hilplant.ecu.relay_controller import ControllerState, advance
from hilplant.ecu.vocabulary import RELAYS_OFF, EcuInputs, Fault, Master, RelayCommand, RelaySettings, Stalk

POLL_S = 1.0 / 256.0  # sums of it are exact
SETTINGS = RelaySettings()
OFF, SLOW, FAST = Stalk(), Stalk(Master.SLOW), Stalk(Master.FAST)
DRIVE = RelayCommand(on=True, fast=False)


class Mind:
    """Plays inputs to a controller and keeps its answers."""

    def __init__(self, settings: RelaySettings = SETTINGS) -> None:
        self.settings = settings
        self.state, self.relays, self.fault, self.now_s = ControllerState(), RELAYS_OFF, Fault.NONE, 0.0

    def play(
        self, seconds: float, stalk: Stalk, contact: bool | None, current_a=math.nan, supply_v=math.nan
    ) -> RelayCommand:
        """Hold the inputs for a while, at least for one poll."""
        for _ in range(max(1, round(seconds / POLL_S))):
            self.now_s += POLL_S
            inputs = EcuInputs(stalk, contact, current_a, supply_v)
            self.state, self.relays, self.fault = advance(self.state, inputs, self.now_s, self.settings)
        return self.relays

    def until(self, condition, *inputs) -> float:
        """Hold the inputs until the condition holds; return how long that took."""
        begin_s = self.now_s
        while not condition():
            self.play(0.0, *inputs)
            assert self.now_s - begin_s < 60.0
        return self.now_s - begin_s
