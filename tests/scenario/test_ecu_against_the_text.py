"""The controller against Figures 8-7 and 8-8 written down once more, over random hands that aim at the tight moments.

The second model is plain ifs after the text of section 8.4 and docs/ecu.md, for a wiper with nothing wrong. It must
command the same relays at every look: a missed flick, a wrong speed, a pause that its switch changes would show.
"""

import random

import pytest

from hilplant.ecu.relay_controller import ControllerState, advance
from hilplant.ecu.vocabulary import EcuInputs, Fault, Master, RelaySettings, Stalk

LOOKS, LOOK_S = 100_000, 0.005
SETTINGS = RelaySettings(pauses_s=(0.2, 0.35, 0.5, 0.65, 0.8, 0.95))
#: Turns a second of the wiper by its relays, and half the park window in turns.
TURNS_PER_S, HALF_WINDOW = {(False, False): 0.0, (True, False): 0.6, (True, True): 1.0}, 0.02
WAITS = ("wait", "int_wait", "slow_wait", "fast_wait")
STAGES = ("off", "single_wipe", "slow", "fast")


class Text:
    """What the text says: `look` takes the stalk, whether park is reached, and the time; it returns the relays."""

    def __init__(self) -> None:
        self.at, self.fast, self.since_s, self.pause_s, self.left = "off", False, 0.0, 0.0, 0

    def look(self, stalk: Stalk, park: bool, now_s: float) -> tuple[bool, bool]:
        before = self.at
        self.at = self.following(stalk, park, now_s)
        if self.at != before:
            self.since_s = now_s
            self.fast = self.at in ("flick", "fast") or (self.at in WAITS and self.fast)
        return (False, False) if self.at in ("off", "pause") else (True, self.fast)

    def following(self, stalk: Stalk, park: bool, now_s: float) -> str:
        if self.at == "off":
            return "flick" if stalk.flick else "washing" if stalk.wash else STAGES[stalk.master]
        if self.at == "flick":
            return "off" if park and not stalk.flick else "flick"
        if self.at == "pause":
            over = now_s - self.since_s >= self.pause_s
            going = "single_wipe" if over else "pause"
            stage = going if stalk.master == Master.INTERMITTENT else STAGES[stalk.master]
            return "washing" if stalk.wash else stage
        if self.at in ("washing", "wash_wipes"):
            return self.after_wash(stalk, park)
        if park and self.at == "single_wipe":
            return self.pause(stalk)
        if park and self.at in WAITS:
            return STAGES[WAITS.index(self.at)]
        if self.at == "single_wipe" and stalk.wash:
            return "washing"
        own = WAITS.index(self.at) if self.at in WAITS else STAGES.index(self.at)
        return self.at if stalk.master == own else WAITS[stalk.master]

    def after_wash(self, stalk: Stalk, park: bool) -> str:
        if park and self.at == "wash_wipes" and self.left == 1 and stalk.master < Master.SLOW:
            return "off" if stalk.master == Master.OFF else self.pause(stalk)
        if stalk.master >= Master.SLOW:
            return WAITS[stalk.master]
        if self.at == "washing" and not stalk.wash:
            self.left = 3
            return "wash_wipes"
        if stalk.wash:
            return "washing"
        self.left -= park
        return self.at

    def pause(self, stalk: Stalk) -> str:
        self.pause_s = SETTINGS.pauses_s[stalk.interval - 1]
        return "pause"


def hold(chance: random.Random, text: Text, turns: float, now_s: float) -> int:
    """Return for how many looks the hand stays: any, or until about park is reached or the pause is over."""
    to_park_s = (1.0 - HALF_WINDOW - turns % 1.0) / TURNS_PER_S[True, text.fast]
    to_end_s = text.since_s + text.pause_s - now_s if text.at == "pause" else to_park_s
    tight = round(max(0.0, to_end_s) / LOOK_S) + chance.randint(-2, 2)
    return max(1, chance.choice([1, 2, 3, 5, 20, 80, 200, 500, tight, tight, tight]))


def moved(chance: random.Random, stalk: Stalk) -> Stalk:
    """Move one thing at the stalk, or all; intermittent most often."""
    master = Master(chance.choice([0, 1, 1, 1, 2, 3]))
    new = Stalk(master, chance.randint(1, 6), chance.random() < 0.2, chance.random() < 0.2)
    one = chance.choice(["master", "interval", "interval", "flick", "wash"])
    return new if chance.random() < 0.3 else stalk._replace(**{one: getattr(new, one)})


@pytest.mark.parametrize("seed", [1, 2])
def test_the_controller_does_what_the_text_says_at_every_look(seed):
    chance, state, text, stalk, left = random.Random(seed), ControllerState(), Text(), Stalk(), 0
    turns, opened_s, seen, switched = 0.0, None, set(), 0
    for number in range(LOOKS):
        now_s = number * LOOK_S
        if left == 0:
            before, stalk = stalk, moved(chance, stalk)
            switched += text.at == "pause" and before.interval != stalk.interval
            left = hold(chance, text, turns, now_s)
        left -= 1
        closed = abs((turns + 0.5) % 1.0 - 0.5) < HALF_WINDOW
        park = closed and opened_s is not None and now_s - LOOK_S - opened_s >= SETTINGS.debounce_s
        opened_s = None if closed else now_s if opened_s is None else opened_s
        state, relays, fault = advance(state, EcuInputs(stalk, closed, 2.0, 13.5), now_s, SETTINGS)
        expected = text.look(stalk, park, now_s)
        assert tuple(relays) == expected, f"look {number}, {stalk}: {state.phase}, by the text {text.at}"
        assert fault is Fault.NONE
        seen.add(text.at)
        turns += TURNS_PER_S[expected] * LOOK_S
    assert switched > 20, "the switch was moved in pauses"
    assert seen >= {"off", "flick", "pause", "washing", "wash_wipes", *WAITS, *STAGES}
