"""What the controller makes of its inputs over time: arrivals at park, stalls, a supply that is too low.

Pure: a memory and one look at the inputs in, the next memory out; time is an argument.
"""

import math
from typing import NamedTuple

from hilplant.ecu.vocabulary import EcuInputs, RelaySettings


class Senses(NamedTuple):
    """What is remembered of the inputs.

    `contact` is the park contact as last seen, None while unknown. `opened_s` is when it opened and `closed_s`
    when it closed, infinite while it is in the other position. `away` says that it has been open for longer
    than a bounce, `arrived` that it closed just now after that. `edges` counts its changes since `window_s`.
    `high_s` is since when the current is that of a stall, `warm_s` since when that of a warm motor's stall, `good_s`
    since when the supply is good again.
    """

    contact: bool | None = None
    opened_s: float = math.inf
    closed_s: float = math.inf
    away: bool = False
    arrived: bool = False
    edges: int = 0
    window_s: float = 0.0
    high_s: float = math.inf
    warm_s: float = math.inf
    supply_low: bool = False
    good_s: float = math.inf


def sense(before: Senses, inputs: EcuInputs, now_s: float, settings: RelaySettings) -> Senses:
    """Take one look at the inputs.

    The wiper has arrived at park only when the contact closes after it was open for longer than contacts
    bounce: a wiper that is still leaving the park window, or passing it when it is told to stop, makes its turn
    to the end and stops where the window begins. So it never brakes at the window's far edge and coasts out.
    """
    senses = _watch_contact(before, inputs.park_contact, now_s, settings)
    senses = _count_edges(senses, before.contact, now_s, settings)
    current_a = abs(inputs.current_a)  # nan is above nothing: unknown is not high
    high_s = min(senses.high_s, now_s) if current_a > settings.stall_current_a else math.inf
    warm_s = min(senses.warm_s, now_s) if current_a > settings.warm_stall_current_a else math.inf
    if (high_s, warm_s) != (senses.high_s, senses.warm_s):
        senses = senses._replace(high_s=high_s, warm_s=warm_s)
    return _watch_supply(senses, inputs.supply_v, now_s, settings)


def _watch_contact(before: Senses, contact: bool | None, now_s: float, settings: RelaySettings) -> Senses:
    opened_s = closed_s = math.inf
    away = arrived = False
    if contact:
        closed_s, arrived = min(before.closed_s, now_s), before.away
    elif contact is not None:
        opened_s = min(before.opened_s, now_s)
        away = before.away or now_s - opened_s >= settings.debounce_s
    if before[:5] == (contact, opened_s, closed_s, away, arrived):
        return before
    return before._replace(contact=contact, opened_s=opened_s, closed_s=closed_s, away=away, arrived=arrived)


def _count_edges(senses: Senses, before: bool | None, now_s: float, settings: RelaySettings) -> Senses:
    """Count the changes of the contact in windows that follow each other."""
    if now_s - senses.window_s >= settings.bounce_window_s:
        senses = senses._replace(edges=0, window_s=now_s)
    changed = before is not None and senses.contact is not None and before is not senses.contact
    return senses._replace(edges=senses.edges + 1) if changed else senses


def _watch_supply(senses: Senses, supply_v: float, now_s: float, settings: RelaySettings) -> Senses:
    """Call the supply low below one threshold, and good again after some time above a higher one."""
    if supply_v < settings.brown_out_v:
        return senses._replace(supply_low=True, good_s=math.inf)
    if not senses.supply_low:
        return senses
    if supply_v < settings.resume_v:
        return senses._replace(good_s=math.inf)
    good_s = min(senses.good_s, now_s)
    low = now_s - good_s < settings.resume_s
    return senses._replace(supply_low=low, good_s=good_s if low else math.inf)
