"""The circuits against a netlist of their switches and contacts, solved by following the wires.

The netlist below lists which two wires each switch and each park contact joins in each of its positions, as the text
of sections 3.6.1, 3.6.2 and 7.1.1 of Dooner (2016) says; it knows nothing of states, figures or priorities. What it
joins has one potential. Battery and ground must never be joined: a current between them flows through the armature.
"""

from itertools import product

import pytest

from hilplant.models.circuit import CIRCUITS, connect
from hilplant.models.park_switch import Contact
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.signals import Inputs

Wires = tuple[tuple[str, str], ...]

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
SUPPLY, SPEED = 13.5, 170.0
STATE = State(0.0, SPEED, 0.0, 0.0, 0.0, 0.0)

DIGITAL: dict[str, dict[str, Wires]] = {
    "on/off relay": {"on": (("battery", "relay"),), "off": (("ground", "relay"),)},
    "fast/slow relay": {"slow": (("relay", "53"),), "fast": (("relay", "53b"),)},
    "chassis": {"always": (("31", "ground"),)},
}
MECHANICAL: dict[str, dict[str, Wires]] = {
    "switch 1": {"off": (), "slow": (("battery", "53"),), "fast": (("battery", "53b"),)},
    "switch 2": {"off": (("53e", "53"),), "slow": (), "fast": ()},
    "park switch": {"away": (("battery", "53e"),), "park": (("ground", "53e"),), "lifted": ()},
    "chassis": {"always": (("31", "ground"),)},
}
DEPRESSED: dict[str, dict[str, Wires]] = {
    "switch 1": {"off": (("53e", "53"),), "slow": (), "fast": ()},
    "switch 2": {"off": (("B on", "ground"),), "slow": (("53", "ground"),), "fast": (("53b", "ground"),)},
    "switch 3": {"off": (("A", "31"),), "slow": (("battery", "31"),), "fast": (("battery", "31"),)},
    "park switch A": {"on": (("battery", "A"),), "parking": (("A", "ground"),), "parked": (), "lifted": ()},
    "park switch B": {"on": (("53e", "B on"),), "parking": (("battery", "53e"),), "parked": (), "lifted": ()},
}


def joined(netlist: dict[str, dict[str, Wires]], positions: dict[str, str]) -> dict[str, set[str]]:
    """Return for each wire all the wires that it is joined with."""
    groups = {name: {name} for name in ("battery", "ground", "53", "53b", "53e", "31", "relay", "A", "B on")}
    for part, by_position in netlist.items():
        for one, other in by_position[positions[part]]:
            whole = groups[one] | groups[other]
            for name in whole:
                groups[name] = whole
    return groups


def positions_of(circuit: str, relays: tuple[float, float], contact: Contact, phase: int) -> dict[str, str]:
    on, fast = relays
    selector = ("fast" if fast else "slow") if on else "off"
    lifted = contact.shown != contact.closed
    if circuit == "digital":
        return {
            "on/off relay": "on" if on else "off",
            "fast/slow relay": "fast" if fast else "slow",
            "chassis": "always",
        }
    if circuit == "mechanical":
        park = "lifted" if lifted else "park" if contact.closed else "away"
        return {"switch 1": selector, "switch 2": selector, "park switch": park, "chassis": "always"}
    park = ("on", "lifted" if lifted and contact.closed else "parking", "parked")[phase]
    return {f"switch {n}": selector for n in (1, 2, 3)} | {"park switch A": park, "park switch B": park}


NETLISTS = {"digital": DIGITAL, "mechanical": MECHANICAL, "depressed": DEPRESSED}
RELAYS = ((0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0))
CONTACTS = tuple(Contact(closed, shown, 0.0) for closed, shown in product((0.0, 1.0), repeat=2))
STATES = tuple(product(CIRCUITS, RELAYS, CONTACTS, (0, 1, 2)))


@pytest.mark.parametrize("circuit", CIRCUITS)
def test_every_state_has_the_potentials_of_the_netlist(circuit: str) -> None:
    polarity = -1.0 if circuit == "depressed" else 1.0
    switch = ParkSwitch(0.0, 0.1, 0.01, 0.0, float(CIRCUITS.index(circuit)), 0.2)
    parameters = Parameters(1e-3, MOTOR, switch, Load(0.0), Arm(0.0, 0.5), Arm(0.0, 0.5))
    for _, relays, contact, phase in (state for state in STATES if state[0] == circuit):
        groups = joined(NETLISTS[circuit], positions_of(circuit, relays, contact, phase))

        def potential(wire: str, groups: dict[str, set[str]] = groups) -> float | None:
            return SUPPLY if "battery" in groups[wire] else 0.0 if "ground" in groups[wire] else None

        seen = connect(Inputs(*relays, SUPPLY, 0.0, 0.0, 0.0), parameters, contact, float(phase), STATE)
        slow, fast, common = potential("53"), potential("53b"), potential("31")
        common_v = common or 0.0
        emf = {"53": MOTOR.slow.constant_v_s * SPEED, "53b": MOTOR.fast.constant_v_s * SPEED}
        open_v = {name: common_v + polarity * volts for name, volts in emf.items()}
        assert seen.terminal_31_v == common_v
        assert seen.terminal_53_v == pytest.approx(open_v["53"] if slow is None else slow)
        assert seen.terminal_53b_v == pytest.approx(open_v["53b"] if fast is None else fast)
        park = potential("53e")
        idle = seen.terminal_53_v if "53" in groups["53e"] else 0.0
        assert seen.terminal_53e_v == pytest.approx(idle if park is None else park)
        fed = [(brush, volts) for brush, volts in ((MOTOR.slow, slow), (MOTOR.fast, fast)) if volts is not None]
        assert len(fed) <= 1, "one brush is in the circuit"
        if fed and common is not None:
            brush, volts = fed[0]
            assert (seen.brush, seen.closed) == (brush, 1.0)
            assert seen.terminal_v == pytest.approx(polarity * (volts - common))
        else:
            assert (seen.terminal_v, seen.closed) == (0.0, 0.0)


@pytest.mark.parametrize(("circuit", "relays", "contact", "phase"), STATES)
def test_battery_and_ground_meet_only_through_the_armature(
    circuit: str, relays: tuple[float, float], contact: Contact, phase: int
) -> None:
    groups = joined(NETLISTS[circuit], positions_of(circuit, relays, contact, phase))
    assert "ground" not in groups["battery"]


def test_switch_2_straight_to_the_slow_brush_would_short_the_battery() -> None:
    """Why the way to ground leads through contact B, which the text does not say: without it, (c) is a short."""
    straight = DEPRESSED | {"switch 2": DEPRESSED["switch 2"] | {"off": (("53", "ground"),)}}
    groups = joined(straight, positions_of("depressed", (0.0, 0.0), CONTACTS[3], 1))
    assert "ground" in groups["battery"]
