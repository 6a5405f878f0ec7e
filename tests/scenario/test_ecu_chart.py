"""Every state and every transition of the ECU's chart, each provoked from outside and compared with what is written
here by hand: section 8.4 of the thesis for the driver's part, docs/ecu.md for the rest. The last test counts that
nothing in the table was left out.
"""

from collections.abc import Callable

import pytest

from hilplant.ecu.chart import CHART, EXITS, Phase
from hilplant.ecu.relay_controller import ControllerState, advance, take
from hilplant.ecu.stalk import move_named, moved
from hilplant.ecu.vocabulary import RELAYS_OFF, EcuInputs, Fault, RelayCommand, RelaySettings, Stalk

POLL_S = 0.005
SETTINGS = RelaySettings(
    pauses_s=(0.2, 0.3, 0.4, 0.5, 0.6, 0.7), turn_timeout_s=3.0, leave_timeout_s=1.0, retry_pause_s=0.5, tries=3
)
SLOW, FAST = RelayCommand(on=True, fast=False), RelayCommand(on=True, fast=True)
CONTACTS = {"closed": True, "open": False, "unknown": None}

#: How to come into each phase: `contact stalk seconds [stall|low]`, line by line; {c} is the contact while wiping.
WIPING = {
    "flick": "closed off+flick .05; {c} off .1",
    "single_wipe": "closed i1 .05; {c} i1 .1",
    "slow": "closed slow .05; {c} slow .1",
    "fast": "closed fast .05; {c} fast .1",
    "wait": "closed slow .05; {c} slow .1; {c} off .05",
    "int_wait": "closed slow .05; {c} slow .1; {c} i1 .05",
    "slow_wait": "closed fast .05; {c} fast .1; {c} slow .05",
    "fast_wait": "closed slow .05; {c} slow .1; {c} fast .05",
    "washing": "closed off+wash .05; {c} off+wash .1",
    "wash_wipes": "closed off+wash .05; {c} off+wash .05; {c} off .05",
}
HELD = {
    "flick": "off", "single_wipe": "i1", "slow": "slow", "fast": "fast", "wait": "off", "int_wait": "i1",
    "slow_wait": "slow", "fast_wait": "fast", "washing": "off+wash", "wash_wipes": "off",
}  # fmt: skip
SPEED = dict.fromkeys(WIPING, SLOW) | dict.fromkeys(("flick", "fast", "slow_wait"), FAST)
STALL = "open slow .1; open slow .55 stall"
RESTING = {"off": "closed off 1"}
RESTING |= {f"pause_{k}": f"closed i{k} .05; open i{k} .3; closed i{k} .02" for k in range(1, 7)}
TROUBLED = {
    "blind": WIPING["slow"].format(c="open") + "; unknown slow .05",
    "brown_out": WIPING["slow"].format(c="open") + "; open slow .05 low",
    "retry": f"closed slow .05; {STALL}",
    "lockout": f"closed slow .05; {STALL}; open slow .5; {STALL}; open slow .5; {STALL}",
}
REACH = {name: words.format(c="open") for name, words in WIPING.items()} | RESTING | TROUBLED
#: A wipe too quick to be forgiven for, so that tries add up.
WIPE = "open {s} .3; closed {s} .005"


class Seat:
    """Plays inputs to a controller and notes what it does."""

    def __init__(self) -> None:
        self.state, self.relays, self.fault, self.now_s = ControllerState(), RELAYS_OFF, Fault.NONE, 0.0
        self.taken: list[tuple[Phase, int]] = []

    def play(self, story: str, until: Callable[[], bool] = lambda: False) -> None:
        """Play line by line, and stop within the last one as soon as `until` says so."""
        lines = story.split(";")
        for index, line in enumerate(lines):
            contact, stalk, seconds, *extra = line.split()
            for number in range(max(1, round(float(seconds) / POLL_S))):
                if index == len(lines) - 1 and until():
                    return
                closed = number % 2 == 0 if contact == "bounces" else CONTACTS[contact]
                current_a, supply_v = 11.0 if "stall" in extra else 2.0, 5.0 if "low" in extra else 13.5
                self.look(EcuInputs(stalk_of(stalk), closed, current_a, supply_v))

    def look(self, inputs: EcuInputs) -> None:
        self.now_s += POLL_S
        _, row = take(self.state, inputs, self.now_s, SETTINGS)
        if row is not None:
            self.taken.append((self.state.phase, CHART.index(row)))
        self.state, self.relays, self.fault = advance(self.state, inputs, self.now_s, SETTINGS)


def stalk_of(words: str) -> Stalk:
    stalk = Stalk()
    for word in words.split("+"):
        move = move_named(word)
        assert move is not None
        stalk = moved(stalk, move, 0.0)
    return stalk


def cases():
    """Return (phase, how it is reached, what happens then, the phase that follows, the fault reported then).

    It is reached at the end of the way, or where that ends with !, in its last line.
    """
    for name, words in WIPING.items():
        held = HELD[name]
        reached, leaving = words.format(c="open"), words.format(c="closed")
        yield name, reached, f"open {held} .005 low", "brown_out", "brown_out"
        yield name, reached, f"unknown {held} .005", "blind", "park_unknown"
        yield name, reached, f"open {held} .51 stall", "retry", "stall"
        yield name, leaving, f"bounces {held} .06", "retry", "park_bounces"
        yield name, leaving, f"closed {held} 1", "retry", "park_never_opens"
        yield name, reached, f"open {held} 3", "retry", "park_never_closes"
    for name, words in RESTING.items():
        held = "off" if name == "off" else f"i{name[-1]}"
        wanted = "slow" if name == "off" else held
        yield name, words, f"closed {wanted} .005 low", "brown_out", "brown_out"
        yield name, words, f"unknown {wanted} .005", "blind", "park_unknown"
        if name == "off":
            yield name, words, "unknown off .6", "blind", "park_unknown"
        yield name, words, f"open {held} .03", "wait", "off_park"
        begin = words if name == "off" else f"closed {held} .05; " + WIPE.format(s=held)
        missed = "; ".join([f"open {held} .03; {WIPE.format(s='off')}; closed {held} .005; {WIPE.format(s=held)}"] * 3)
        missed = missed if name != "off" else "; ".join([f"open off .03; {WIPE.format(s='off')}"] * 3)
        yield name, f"{begin}; {missed}", f"open {held} .03", "lockout", "off_park"
    yield from moves()
    yield from arrivals()
    yield from recoveries()


def moves():
    """What the driver's hand does: 8.4, and washing."""
    from_thesis = {
        "off": {"off+flick": "flick", "i1": "single_wipe", "slow": "slow", "fast": "fast", "off+wash": "washing"},
        "slow": {"off": "wait", "i1": "int_wait", "fast": "fast_wait"},
        "fast": {"off": "wait", "i1": "int_wait", "slow": "slow_wait"},
        "single_wipe": {"off": "wait", "slow": "slow_wait", "fast": "fast_wait", "i1+wash": "washing"},
        "wait": {"i1": "int_wait", "slow": "slow_wait", "fast": "fast_wait"},
        "int_wait": {"off": "wait", "slow": "slow_wait", "fast": "fast_wait"},
        "slow_wait": {"off": "wait", "i1": "int_wait", "fast": "fast_wait"},
        "fast_wait": {"off": "wait", "i1": "int_wait", "slow": "slow_wait"},
        "washing": {"slow+wash": "slow_wait", "fast+wash": "fast_wait", "off": "wash_wipes"},
        "wash_wipes": {"slow": "slow_wait", "fast": "fast_wait", "off+wash": "washing"},
    }
    for k in range(1, 7):
        from_thesis[f"pause_{k}"] = {"off": "off", "slow": "slow", "fast": "fast", f"i{k}+wash": "washing"}
    for name, following in from_thesis.items():
        contact = "closed" if name in RESTING else "open"
        for stalk, phase in following.items():
            yield name, REACH[name], f"{contact} {stalk} .005", phase, "none"
    for k in range(1, 7):
        yield f"pause_{k}", REACH[f"pause_{k}"], f"closed i{k} {0.2 + 0.1 * k:g}", "single_wipe", "none"


def arrivals():
    """What happens at the park switch."""
    for name, phase in {
        "flick": "off", "wait": "off", "int_wait": "single_wipe", "slow_wait": "slow", "fast_wait": "fast"
    }.items():  # fmt: skip
        yield name, REACH[name], f"closed {HELD[name]} .005", phase, "none"
    for k in range(1, 7):
        yield "single_wipe", REACH["single_wipe"], f"closed i{k} .005", f"pause_{k}", "none"
        washed = f"closed i{k}+wash .05; open i{k}+wash .05; open i{k} .05"
        yield "wash_wipes", washed, "; ".join([WIPE.format(s=f"i{k}")] * 3), f"pause_{k}", "none"
    yield "wash_wipes", REACH["wash_wipes"], "; ".join([WIPE.format(s="off")] * 3), "off", "none"


def recoveries():
    """How it goes on after trouble."""
    contacts = (("closed", "off"), ("open", "wait"), ("unknown", "blind"))
    yield "blind", REACH["blind"], "unknown slow .005 low", "brown_out", "brown_out"
    for contact, phase in contacts[:2]:
        yield "blind", REACH["blind"], f"{contact} slow .005", phase, "park_unknown"
    for contact, phase in contacts:
        fault = "park_unknown" if phase == "blind" else "brown_out"
        yield "brown_out", REACH["brown_out"], f"{contact} slow .6", phase, fault
        fault = "park_unknown" if phase == "blind" else "stall"
        yield "retry", REACH["retry"], f"{contact} slow .6", phase, fault
    third = REACH["lockout"].rsplit(";", 1)[0] + "; open slow .6 stall!"
    yield "retry", third, "open slow .005", "lockout", "stall"
    yield "lockout", REACH["lockout"], "open off .005", "off", "stall"


CASES = list(cases())


def run(case) -> tuple[Seat, tuple[Phase, int]]:
    """Play a case; return the seat and the first transition out of the phase that it is about."""
    name, reached, then, _, _ = case
    seat = Seat()
    seat.play(reached.rstrip("!"), until=lambda: reached.endswith("!") and seat.state.phase.value == name)
    assert seat.state.phase.value == name, f"{name} is not reached by {reached!r}"
    before = len(seat.taken)
    seat.play(then, until=lambda: len(seat.taken) > before)
    assert len(seat.taken) == before + 1, f"{name}: {then!r} takes {seat.taken[before:]}"
    return seat, seat.taken[before]


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case[0]}-{case[3]}-{case[2]}"[:60])
def test_each_transition_leads_where_the_text_says(case):
    seat, _ = run(case)
    assert seat.state.phase.value == case[3]
    assert seat.fault.value == case[4]


@pytest.mark.parametrize("name", REACH)
def test_each_state_drives_or_rests_as_the_text_says(name):
    seat = Seat()
    seat.play(REACH[name])
    assert seat.state.phase.value == name
    assert seat.relays == SPEED.get(name, RELAYS_OFF)


def test_nothing_in_the_table_is_left_out():
    covered = {run(case)[1] for case in CASES}
    every = {(phase, number) for number, row in enumerate(CHART) for phase in row.sources}
    missing = [f"{phase.value} --[{CHART[number].condition.words}]--> {CHART[number].target.value}"
               for phase, number in every - covered]  # fmt: skip
    print(f"{len(REACH)} states, {len(covered)} of {len(every)} transitions covered")
    assert not missing, "\n".join(sorted(missing))
    assert set(REACH) == {phase.value for phase in Phase} == {phase.value for phase in EXITS}
