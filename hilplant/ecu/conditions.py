"""The questions that the chart asks; each has the words under which the chart shows it."""

from collections.abc import Callable
from typing import NamedTuple

from hilplant.ecu.sensing import Senses
from hilplant.ecu.vocabulary import INTERVALS, Master, RelaySettings, Stalk


class View(NamedTuple):
    """What a condition may look at; times [s] count from now backwards.

    `in_phase_s` since the phase began, `turning_s` since the wiper last came to park or began to be driven.
    `latched_demand` is whether the driver wanted something when the controller locked itself out.
    """

    stalk: Stalk
    senses: Senses
    settings: RelaySettings
    now_s: float
    in_phase_s: float
    turning_s: float
    wipes_left: int
    tries: int
    latched_demand: bool


class Condition(NamedTuple):
    """A question and its words."""

    words: str
    holds: Callable[[View], bool]

    def __and__(self, other: "Condition") -> "Condition":
        """Return the condition that both hold."""
        first, second = self.holds, other.holds
        return Condition(f"{self.words} and {other.words}", lambda view: first(view) and second(view))


FLICK = Condition("flick", lambda view: view.stalk.flick)
NO_FLICK = Condition("flick released", lambda view: not view.stalk.flick)
WASH = Condition("wash", lambda view: view.stalk.wash)
NO_WASH = Condition("wash released", lambda view: not view.stalk.wash)
WANTED_OR_RESTED = Condition(
    "(wanted or at rest for long)",
    lambda view: view.stalk.demands or (view.in_phase_s >= view.settings.settle_s and not view.settings.rests_open),
)

PARK = Condition("park reached", lambda view: view.senses.arrived)
LAST_WIPE = Condition("last", lambda view: view.wipes_left <= 1)
AWAY = Condition("contact stays open", lambda view: view.senses.away and not view.settings.rests_open)
OPEN = Condition("contact open", lambda view: view.senses.contact is False)
CLOSED = Condition("contact closed", lambda view: view.senses.contact is True)
UNKNOWN = Condition("contact unknown", lambda view: view.senses.contact is None)

SUPPLY_LOW = Condition("supply low", lambda view: view.senses.supply_low)
SUPPLY_BACK = Condition("supply back", lambda view: not view.senses.supply_low)
WANTED_OR_AWAY = Condition(
    "supply low and (wanted or contact open)",
    lambda view: view.senses.supply_low and (view.stalk.demands or AWAY.holds(view)),
)

STALLED = Condition(
    "current high",
    lambda view: (
        view.now_s - view.senses.high_s >= view.settings.stall_s
        or view.now_s - view.senses.warm_s >= view.settings.warm_stall_s
    ),
)
BOUNCES = Condition("contact bounces", lambda view: view.senses.edges >= view.settings.bounce_edges)
NEVER_OPENS = Condition(
    "contact does not open",
    lambda view: min(view.turning_s, view.now_s - view.senses.closed_s) > view.settings.leave_timeout_s,
)
NEVER_CLOSES = Condition("park not reached", lambda view: view.turning_s > view.settings.turn_timeout_s)

TRIED_OUT = Condition("tried out", lambda view: view.tries >= view.settings.tries)
RETRY_DUE = Condition(
    "rested", lambda view: view.in_phase_s >= view.settings.retry_pause_s and not view.senses.supply_low
)
DRIVER_RESETS = Condition("stalk off or on again", lambda view: view.stalk.demands is not view.latched_demand)


def master(position: Master) -> Condition:
    """Ask whether the stalk stands in a position."""
    return Condition(f"master {position.name.lower()}", lambda view: view.stalk.master is position)


def interval(number: int) -> Condition:
    """Ask whether the intermittent switch stands at a number."""
    return Condition(f"interval {number}", lambda view: view.stalk.interval == number)


def pause_over(number: int) -> Condition:
    """Ask whether the pause of a number has passed."""
    index = INTERVALS.index(number)
    return Condition("pause over", lambda view: view.in_phase_s >= view.settings.pauses_s[index])
