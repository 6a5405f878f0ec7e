"""What the controller sees, decides and is set to: plain records without behaviour."""

import math
from enum import Enum, IntEnum
from typing import NamedTuple

INTERVALS = (1, 2, 3, 4, 5, 6)


class Master(IntEnum):
    """Where the stalk stands; the numbers are those of `Master_Input`, section 8.4 of Dooner (2016)."""

    OFF = 0
    INTERMITTENT = 1
    SLOW = 2
    FAST = 3


class Stalk(NamedTuple):
    """What the driver's hand does.

    `interval` is `Intermittent_Switch`, 1 to 6; `flick` and `wash` are true while they are pressed.
    `automatic` says that the rain sensor decides in the place of `master` and `interval`.
    """

    master: Master = Master.OFF
    interval: int = 1
    flick: bool = False
    wash: bool = False
    automatic: bool = False

    @property
    def demands(self) -> bool:
        """Whether the driver wants the wiper to move."""
        return self.master is not Master.OFF or self.flick or self.wash


class EcuInputs(NamedTuple):
    """One look at the world: `park_contact` is None, and a number nan, while it is not known."""

    stalk: Stalk
    park_contact: bool | None
    current_a: float = math.nan
    supply_v: float = math.nan
    rain: float = math.nan


class RelayCommand(NamedTuple):
    """The command to the plant: ON/OFF relay and FAST/SLOW relay."""

    on: bool
    fast: bool


RELAYS_OFF = RelayCommand(False, False)


class Fault(Enum):
    """What the controller reports."""

    NONE = "none"
    STALL = "stall"  # the motor's current stayed high
    PARK_NEVER_CLOSES = "park_never_closes"  # driven for too long without coming to park
    PARK_NEVER_OPENS = "park_never_opens"  # driven for too long without leaving park
    PARK_BOUNCES = "park_bounces"  # too many edges for a wiper
    OFF_PARK = "off_park"  # stands outside the park window without having been stopped there
    PARK_UNKNOWN = "park_unknown"  # the park switch is silent
    BROWN_OUT = "brown_out"  # the supply is too low to drive
    STALK_LOST = "stalk_lost"  # the stalk's message stays away; the node finds this, not the controller


class RelaySettings(NamedTuple):
    """Times and thresholds; `docs/ecu.md` tells where each comes from.

    `rests_open` says that the wiper rests outside the park window, as the depressed circuit leaves it.
    """

    pauses_s: tuple[float, ...] = (1.0, 2.0, 4.0, 7.0, 12.0, 18.0)
    wash_wipes: int = 3
    debounce_s: float = 0.02
    turn_timeout_s: float = 10.0
    leave_timeout_s: float = 2.0
    bounce_edges: int = 10
    bounce_window_s: float = 1.0
    stall_current_a: float = 10.0
    stall_s: float = 0.5
    warm_stall_current_a: float = 5.5
    warm_stall_s: float = 4.0
    brown_out_v: float = 6.0
    resume_v: float = 8.0
    resume_s: float = 0.5
    tries: int = 3
    retry_pause_s: float = 2.0
    settle_s: float = 0.5
    rests_open: bool = False
    rain_levels: tuple[float, ...] = (0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.6, 0.8)
    rain_hold_s: float = 5.0
