"""Wires, short circuits and supply resistance against modified nodal analysis.

The oracle lays every wire, conductance, battery and the two armature paths into one matrix and solves it; it knows no
ports, shares or reductions. Ideal wires are equations of their own there, not small resistances.
"""

import math
from itertools import product

import numpy as np
import pytest
from numpy.random import Generator, default_rng

from hilplant.models.circuit import Connection, connect
from hilplant.models.park_switch import Contact
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State, Wire, Wiring
from hilplant.models.wiring import CIRCUITS, Leads, depressed, digital, mechanical
from hilplant.signals import Inputs

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
CASES = tuple(product(CIRCUITS, (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0, 2.0)))


class Netlist:
    """Nodes by name, branches one by one; `solve` returns potentials against the ECU's ground."""

    def __init__(self) -> None:
        self.nodes: dict[str, int] = {}
        self.conductances: list[tuple[str, str, float]] = []
        self.sources: list[tuple[str, str, float, float]] = []  # from, to, volts, ohms in series
        self.currents: list[tuple[str, str, float]] = []

    def solve(self) -> tuple[dict[str, float], list[float]]:
        ends = [(a, b) for a, b, *_ in [*self.conductances, *self.sources, *self.currents]]
        names = sorted({name for pair in ends for name in pair} - {"0"})
        index = {name: place for place, name in enumerate(names)}
        size = len(names) + len(self.sources)
        matrix, right = np.zeros((size, size)), np.zeros(size)

        def stamp(row: str, column: str, value: float) -> None:
            if row != "0" and column != "0":
                matrix[index[row], index[column]] += value

        for a, b, g in self.conductances:
            for one, other in ((a, b), (b, a)):
                stamp(one, one, g)
                stamp(one, other, -g)
        for place, (a, b, volts, ohms) in enumerate(self.sources, start=len(names)):
            for name, sign in ((a, 1.0), (b, -1.0)):
                if name != "0":
                    matrix[index[name], place] -= sign
                    matrix[place, index[name]] += sign
            matrix[place, place] += ohms
            right[place] = volts
        for a, b, amperes in self.currents:
            for name, sign in ((a, -1.0), (b, 1.0)):
                if name != "0":
                    right[index[name]] += sign * amperes
        solution, *_ = np.linalg.lstsq(matrix, right, rcond=1e-13)
        assert np.allclose(matrix @ solution, right, atol=1e-8)
        return {"0": 0.0} | {name: solution[index[name]] for name in names}, list(solution[len(names) :])


def leads_of(circuit: str, inputs: Inputs, contact: Contact, phase: float) -> Leads:
    if circuit == "mechanical":
        return mechanical(inputs, contact)
    return depressed(inputs, contact, phase) if circuit == "depressed" else digital(inputs)


def some_wire(random: Generator) -> Wire:
    ohms = random.choice([0.0, 0.0, 10.0 ** random.uniform(-3, 2)])
    shorts = [random.choice([0.0, 0.0, 10.0 ** random.uniform(-2, 3)]) for _ in range(2)]
    return Wire(ohms, float(random.random() < 0.1), *shorts)


def some_wiring(random: Generator) -> Wiring:
    return Wiring(
        altered=1.0,
        supply_resistance_ohm=random.choice([0.0, 0.15, random.uniform(0.01, 2.0)]),
        ground_offset_v=random.choice([0.0, random.uniform(-1.0, 1.0)]),
        supply_opened=float(random.random() < 0.2),
        brushes_s=random.choice([0.0, 0.0, 10.0 ** random.uniform(-1, 3)]),
        wire_53=some_wire(random),
        wire_53b=some_wire(random),
        wire_53e=some_wire(random),
        wire_31=some_wire(random),
    )


def netlist(leads: Leads, wiring: Wiring, supply_v: float) -> Netlist:
    net = Netlist()
    net.sources.append(("31'", "0", wiring.ground_offset_v, 0.0))
    if wiring.supply_opened < 0.5:
        net.sources.append(("30", "0", supply_v, wiring.supply_resistance_ohm))
    for name, lead, wire in (
        ("53", leads.slow, wiring.wire_53),
        ("53b", leads.fast, wiring.wire_53b),
        ("53e", leads.park, wiring.wire_53e),
        ("31", leads.common, wiring.wire_31),
    ):
        begin = "30" if lead.share > 0.5 else "31'"
        if name == "53" and leads.joined > 0.5:
            begin, driven = "53e", 1.0
        else:
            driven = lead.driven
        if driven > 0.5 and wire.opened < 0.5:
            net.sources.append((begin, name, 0.0, wire.resistance_ohm))
        net.conductances += [(name, "30", wire.to_supply_s), (name, "31'", wire.to_ground_s)]
    net.conductances.append(("53", "53b", wiring.brushes_s))
    return net


def reached(net: Netlist, start: str) -> set[str]:
    """Return the nodes to which a way leads without the motor."""
    joined = [(a, b) for a, b, *_ in net.sources] + [(a, b) for a, b, g in net.conductances if g > 0.0]
    known = {start}
    while True:
        more = {end for pair in joined for end in pair if known & set(pair)} - known
        if not more:
            return known
        known |= more


@pytest.mark.parametrize(("circuit", "on", "fast", "closed", "phase"), CASES)
def test_potentials_currents_and_the_path_that_the_armature_sees(
    circuit: str, on: float, fast: float, closed: float, phase: float
) -> None:
    random = default_rng(abs(hash((CIRCUITS.index(circuit), on, fast, closed, phase))))
    for _ in range(60):
        inputs = Inputs(relay_on=on, relay_fast=fast, supply_v=random.uniform(-16.0, 40.0))
        contact = Contact(closed, random.choice([0.0, 1.0]), 0.0)
        wiring = some_wiring(random)
        state = State(current_a=random.uniform(-20.0, 20.0), motor_speed_rad_s=random.uniform(-300.0, 300.0))
        switch = ParkSwitch(0.0, 0.1, 0.01, 0.0, float(CIRCUITS.index(circuit)), 0.2)
        parameters = Parameters(1e-3, MOTOR, switch, Load(0.0), Arm(0.0, 0.5), Arm(0.0, 0.5), wiring=wiring)
        seen = connect(inputs, parameters, contact, phase, state)
        polarity = -1.0 if circuit == "depressed" else 1.0
        net = netlist(leads_of(circuit, inputs, contact, phase), wiring, inputs.supply_v)
        check(seen, net, state, polarity)


def check(seen: Connection, net: Netlist, state: State, polarity: float) -> None:
    on_net, around, shown = (
        reached(net, "0"),
        reached(net, "31"),
        {"53": seen.terminal_53_v, "53b": seen.terminal_53b_v, "31": seen.terminal_31_v},
    )
    chosen, other = ("53b", "53") if seen.fast > 0.5 else ("53", "53b")
    motors = {"53": MOTOR.slow, "53b": MOTOR.fast}
    assert seen.closed == float(chosen in around)
    speed, current = state.motor_speed_rad_s, state.current_a if seen.closed > 0.5 else 0.0
    if seen.closed > 0.5:
        net.currents.append((chosen, "31", polarity * current))
        if other in around:
            net.sources.append(
                (other, "31", polarity * motors[other].constant_v_s * speed, motors[other].resistance_ohm)
            )
    potentials, through = net.solve()
    paired = seen.closed > 0.5 and other in around
    second = -polarity * through[-1] if paired else 0.0
    for name in {"53", "53b", "31"} & on_net:
        assert shown[name] == pytest.approx(potentials[name], rel=1e-7, abs=1e-6), name
    if "53e" in on_net:
        assert seen.terminal_53e_v == pytest.approx(potentials["53e"], rel=1e-7, abs=1e-6)
    battery = [current for source, current in zip(net.sources, through, strict=True) if source[:2] == ("30", "0")]
    assert seen.supply_current_a == pytest.approx(sum(battery), rel=1e-6, abs=1e-6)
    assert seen.second.current_a == pytest.approx(second, rel=1e-6, abs=1e-6)
    if seen.closed > 0.5:
        first, two = motors[chosen], motors[other]
        lies = polarity * (potentials[chosen] - potentials["31"])
        rising = lies - first.resistance_ohm * current - first.constant_v_s * speed
        path = seen.source_v - seen.brush.resistance_ohm * current - seen.brush.constant_v_s * speed
        assert path == pytest.approx(rising, rel=1e-6, abs=1e-5)
        torque = seen.brush.constant_v_s * current + seen.second.push_n_m - seen.second.damping_n_m_s * speed
        assert torque == pytest.approx(first.constant_v_s * current + two.constant_v_s * second, rel=1e-6, abs=1e-6)


def test_one_resistance_and_one_battery_by_hand() -> None:
    """0.15 ohm before a slow brush of 1.237 ohm at 10 A: 1.5 V less, and a tenth of the path's resistance more."""
    wiring = Wiring(altered=1.0, supply_resistance_ohm=0.15)
    parameters = Parameters(
        1e-3, MOTOR, ParkSwitch(0.0, 0.1, 0.01, 0.0), Load(0.0), Arm(0.0, 0.5), Arm(0.0, 0.5), wiring=wiring
    )
    state = State(current_a=10.0, motor_speed_rad_s=100.0)
    seen = connect(Inputs(relay_on=1.0, supply_v=13.5), parameters, Contact(0.0, 0.0, 0.0), 0.0, state)
    assert seen.supply_v == pytest.approx(12.0) and seen.terminal_v == pytest.approx(12.0)
    assert seen.source_v == 13.5 and math.isclose(seen.brush.resistance_ohm, 1.387)
    assert seen.supply_current_a == pytest.approx(10.0)
    braking = connect(Inputs(supply_v=13.5), parameters, Contact(0.0, 0.0, 0.0), 0.0, state._replace(current_a=-7.0))
    assert braking.supply_current_a == 0.0 and braking.supply_v == 13.5 and braking.closed == 1.0


def test_a_blown_fuse_opens_the_armature_and_a_braking_one_stays_closed() -> None:
    wiring = Wiring(altered=1.0, supply_opened=1.0)
    parameters = Parameters(
        1e-3, MOTOR, ParkSwitch(0.0, 0.1, 0.01, 0.0), Load(0.0), Arm(0.0, 0.5), Arm(0.0, 0.5), wiring=wiring
    )
    state = State(current_a=3.0, motor_speed_rad_s=100.0)
    driving, braking = (
        connect(Inputs(relay_on=on, supply_v=13.5), parameters, Contact(0.0, 0.0, 0.0), 0.0, state) for on in (1.0, 0.0)
    )
    assert (driving.closed, driving.source_v, driving.supply_current_a) == (0.0, 0.0, 0.0)
    assert (braking.closed, braking.source_v, braking.supply_current_a) == (1.0, 0.0, 0.0)
