"""The three circuits state by state, as sections 3.6.1, 3.6.2 and 7.1.1 of Dooner (2016) tell them.

Each row of the tables below was typed from the text under Figures 3-15, 3-19 and 7-1: B stands for the battery's
potential, G for ground, and a dash for a terminal that nothing drives.
"""

import math
from itertools import product
from typing import NamedTuple

import pytest

from hilplant.models.circuit import CIRCUITS, Connection, connect, next_phase, phase_at_rest
from hilplant.models.park_switch import Contact, turned_back
from hilplant.models.records import Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.signals import Inputs

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
SWITCH = ParkSwitch(angle_rad=0.05, half_window_rad=0.12, hysteresis_rad=0.01, bounce_ticks=0.0, reverse_angle_rad=0.2)
CLOSING = 0.05 - 0.12
WIPING, TURNING_BACK, PARKED = 0.0, 1.0, 2.0
AWAY, AT_PARK = Contact(0.0, 0.0, 0.0), Contact(1.0, 1.0, 0.0)
LIFTED_ON_ARRIVAL, LIFTED_ON_LEAVING = Contact(1.0, 0.0, 2.0), Contact(0.0, 1.0, 2.0)
SUPPLY, SPEED = 13.5, 200.0
MOVING = State(0.0, SPEED, 0.0, 0.0, 0.0, 0.0)


def inputs(on: float, fast: float = 0.0, supply: float = SUPPLY) -> Inputs:
    return Inputs(on, fast, supply, 0.0, 0.0, 0.0)


def connection(
    circuit: str,
    relays: tuple[float, float],
    contact: Contact,
    phase: float = WIPING,
    moving: State = MOVING,
) -> Connection:
    switch = SWITCH._replace(circuit=float(CIRCUITS.index(circuit)))
    parameters = Parameters(1e-3, MOTOR, switch, Load(0.0), Arm(0.0, 0.5), Arm(0.0, 0.5))
    return connect(inputs(*relays), parameters, contact, phase, moving)


def at_speed(speed: float) -> State:
    return MOVING._replace(motor_speed_rad_s=speed)


class Row(NamedTuple):
    """A state by its figure, and what the text says there: terminals 53, 53b, 53e, 31, brush, volts of the drive."""

    figure: str
    circuit: str
    relays: tuple[float, float]
    contact: Contact
    phase: float
    terminals: str
    brush: str
    drive: float


OFF, OFF_FAST, SLOW, FAST = (0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)

TABLE = (
    Row("7-1 slow", "digital", SLOW, AWAY, WIPING, "B--G", "slow", 13.5),
    Row("7-1 slow, at park", "digital", SLOW, AT_PARK, WIPING, "B--G", "slow", 13.5),
    Row("7-1 fast", "digital", FAST, AWAY, WIPING, "-B-G", "fast", 13.5),
    Row("7-1 off", "digital", OFF, AWAY, WIPING, "G--G", "slow", 0.0),
    Row("7-1 off, at park", "digital", OFF, AT_PARK, WIPING, "G--G", "slow", 0.0),
    Row("7-1 off, fast selected", "digital", OFF_FAST, AWAY, WIPING, "-G-G", "fast", 0.0),
    Row("3-15 (a)", "mechanical", FAST, AWAY, WIPING, "-BBG", "fast", 13.5),
    Row("3-15 (a), at park", "mechanical", FAST, AT_PARK, WIPING, "-BGG", "fast", 13.5),
    Row("3-15 (b)", "mechanical", SLOW, AWAY, WIPING, "B-BG", "slow", 13.5),
    Row("3-15 (b), at park", "mechanical", SLOW, AT_PARK, WIPING, "B-GG", "slow", 13.5),
    Row("3-15 (c)", "mechanical", OFF, AWAY, WIPING, "B-BG", "slow", 13.5),
    Row("3-15 (c), fast selected", "mechanical", OFF_FAST, AWAY, WIPING, "B-BG", "slow", 13.5),
    Row("3-15 (d)", "mechanical", OFF, AT_PARK, WIPING, "G-GG", "slow", 0.0),
    Row("3-15 (d), fast selected", "mechanical", OFF_FAST, AT_PARK, WIPING, "G-GG", "slow", 0.0),
    Row("3-19 (a)", "depressed", SLOW, AWAY, WIPING, "G--B", "slow", 13.5),
    Row("3-19 (a), at park", "depressed", SLOW, AT_PARK, WIPING, "G--B", "slow", 13.5),
    Row("3-19 (b)", "depressed", FAST, AWAY, WIPING, "-G-B", "fast", 13.5),
    Row("3-19, off on the way to park", "depressed", OFF, AWAY, WIPING, "G-GB", "slow", 13.5),
    Row("3-19, off on the way, fast selected", "depressed", OFF_FAST, AWAY, WIPING, "G-GB", "slow", 13.5),
    Row("3-19 (c)", "depressed", OFF, AT_PARK, TURNING_BACK, "B-BG", "slow", -13.5),
    Row("3-19 (c), window left", "depressed", OFF, AWAY, TURNING_BACK, "B-BG", "slow", -13.5),
    Row("3-19 (c), fast selected", "depressed", OFF_FAST, AT_PARK, TURNING_BACK, "B-BG", "slow", -13.5),
)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"{row.circuit} {row.figure}")
def test_each_state_of_the_figures_connects_what_the_text_says(row: Row) -> None:
    seen = connection(row.circuit, row.relays, row.contact, row.phase)
    shown = (seen.terminal_53_v, seen.terminal_53b_v, seen.terminal_53e_v, seen.terminal_31_v)
    for terminal, drawn, volts in zip(("53", "53b", "53e", "31"), row.terminals, shown, strict=True):
        if drawn != "-":
            assert volts == {"B": SUPPLY, "G": 0.0}[drawn], terminal
    assert (seen.brush, seen.terminal_v, seen.closed) == (getattr(MOTOR, row.brush), row.drive, 1.0)


@pytest.mark.parametrize("contact", [AWAY, AT_PARK, LIFTED_ON_LEAVING])
def test_the_depressed_motor_is_disconnected_once_parked(contact: Contact) -> None:
    seen = connection("depressed", OFF, contact, PARKED, at_speed(0.0))
    assert (seen.terminal_v, seen.closed) == (0.0, 0.0)
    assert (seen.terminal_53_v, seen.terminal_53b_v, seen.terminal_53e_v, seen.terminal_31_v) == (0, 0, 0, 0)


def test_relays_on_run_the_depressed_motor_whatever_its_contacts_were_at() -> None:
    for phase in (WIPING, TURNING_BACK, PARKED):
        assert connection("depressed", SLOW, AT_PARK, phase).terminal_v == SUPPLY
        assert connection("depressed", FAST, AT_PARK, phase).terminal_v == SUPPLY


def test_an_open_brush_shows_the_common_one_and_the_back_emf_of_its_own_constant() -> None:
    slow_emf, fast_emf = 4.579e-2 * SPEED, 3.412e-2 * SPEED
    assert connection("digital", SLOW, AWAY).terminal_53b_v == pytest.approx(fast_emf)
    assert connection("digital", FAST, AWAY).terminal_53_v == pytest.approx(slow_emf)
    assert connection("mechanical", OFF, AT_PARK).terminal_53b_v == pytest.approx(fast_emf)
    assert connection("depressed", SLOW, AWAY).terminal_53b_v == pytest.approx(SUPPLY - fast_emf)
    assert connection("depressed", FAST, AWAY).terminal_53_v == pytest.approx(SUPPLY - slow_emf)
    assert connection("depressed", OFF, AWAY, TURNING_BACK, at_speed(-SPEED)).terminal_53b_v == pytest.approx(fast_emf)


def test_open_brushes_show_what_people_measure_on_a_three_brush_motor_at_twelve_volts() -> None:
    """As told for a Renault's: slow on 12 V shows 8 V at the fast brush, fast on 12 V shows 16 V at the slow one."""
    for relays, brush, field, told in (
        (SLOW, MOTOR.slow, "terminal_53b_v", 8.0),
        (FAST, MOTOR.fast, "terminal_53_v", 16.0),
    ):
        speed = (12.0 - brush.resistance_ohm * 1.5) / brush.constant_v_s  # 1.5 A without load, Table 5-4
        assert getattr(connection("digital", relays, AWAY, WIPING, at_speed(speed)), field) == pytest.approx(
            told, abs=2.0
        )


@pytest.mark.parametrize("contact", [LIFTED_ON_ARRIVAL, LIFTED_ON_LEAVING])
def test_a_bouncing_contact_interrupts_the_mechanical_circuit_only_when_it_carries_the_current(
    contact: Contact,
) -> None:
    seen = connection("mechanical", OFF, contact)
    assert (seen.terminal_v, seen.closed) == (0.0, 0.0)
    assert seen.terminal_53_v == seen.terminal_53e_v == pytest.approx(4.579e-2 * SPEED)
    running = connection("mechanical", SLOW, contact)
    assert (running.terminal_v, running.closed, running.terminal_53e_v) == (SUPPLY, 1.0, 0.0)


def test_contacts_a_and_b_bounce_where_the_cam_moves_them_and_nowhere_else() -> None:
    assert connection("depressed", OFF, LIFTED_ON_ARRIVAL, TURNING_BACK).closed == 0.0
    assert connection("depressed", OFF, LIFTED_ON_LEAVING, TURNING_BACK).closed == 1.0
    assert connection("depressed", OFF, LIFTED_ON_LEAVING, WIPING).closed == 1.0
    assert connection("depressed", SLOW, LIFTED_ON_ARRIVAL, WIPING).closed == 1.0


def test_the_digital_park_contact_carries_nothing() -> None:
    for relays in (OFF, OFF_FAST, SLOW, FAST):
        states = {connection("digital", relays, contact) for contact in (AWAY, AT_PARK, LIFTED_ON_ARRIVAL)}
        assert len(states) == 1


@pytest.mark.parametrize("circuit", CIRCUITS)
def test_the_guard_cuts_the_armature_out_of_every_circuit(circuit: str) -> None:
    for relays, phase in product((OFF, OFF_FAST, SLOW, FAST), (WIPING, TURNING_BACK, PARKED)):
        free = connection(circuit, relays, AWAY, phase)
        held = connection(circuit, relays, AWAY, phase, MOVING._replace(guard=1.0))
        assert held == free._replace(source_v=0.0, terminal_v=0.0, closed=0.0, supply_current_a=0.0)


DEPRESSED = SWITCH._replace(circuit=2.0)


def phase(on: float, contact: Contact, before: float, angle: float, switch: ParkSwitch = DEPRESSED) -> float:
    return next_phase(inputs(on), switch, contact, before, angle % (2.0 * math.pi))


def test_contacts_a_and_b_go_to_park_back_and_parked_in_turn() -> None:
    assert phase(0.0, AWAY, WIPING, 3.0) == WIPING
    assert phase(0.0, AWAY, WIPING, CLOSING - 0.1) == WIPING  # the turned-back side, but not yet at park
    assert phase(0.0, AT_PARK, WIPING, CLOSING + 0.001) == TURNING_BACK
    assert phase(0.0, LIFTED_ON_ARRIVAL, WIPING, CLOSING + 0.001) == TURNING_BACK
    assert phase(0.0, AWAY, TURNING_BACK, CLOSING - 0.199) == TURNING_BACK
    assert phase(0.0, AWAY, TURNING_BACK, CLOSING - 0.201) == PARKED
    for angle in (CLOSING - 0.3, CLOSING, 0.0, 3.0):
        assert phase(0.0, AT_PARK, PARKED, angle) == PARKED


def test_relays_on_take_contacts_a_and_b_back_to_wiping_from_anywhere() -> None:
    for before in (WIPING, TURNING_BACK, PARKED):
        for contact in (AWAY, AT_PARK):
            assert phase(1.0, contact, before, CLOSING - 0.1) == WIPING


def test_the_other_circuits_have_no_contacts_a_and_b() -> None:
    for circuit in (0.0, 1.0):
        assert phase(0.0, AT_PARK, TURNING_BACK, 0.0, SWITCH._replace(circuit=circuit)) == WIPING
        assert phase_at_rest(CLOSING - 0.25, SWITCH._replace(circuit=circuit)) == WIPING


@pytest.mark.parametrize("park", [0.0, 0.05, 0.119, 0.32, 3.0, 6.2])
@pytest.mark.parametrize("half_window", [0.01, 0.12, 2.9])
def test_the_way_turned_back_is_told_right_across_zero_and_over_the_whole_window(
    park: float, half_window: float
) -> None:
    switch = DEPRESSED._replace(angle_rad=park, half_window_rad=half_window)
    for step in range(-100, 101):
        way = 0.2 * step / 100 if step > 0 else 2.0 * half_window * step / 100
        angle = (park - half_window - way) % (2.0 * math.pi)
        assert turned_back(angle, switch) == pytest.approx(way, abs=1e-12)


def test_a_run_begins_parked_where_turning_back_ends_and_wiping_elsewhere() -> None:
    turn = 2.0 * math.pi
    assert phase_at_rest((CLOSING - 0.2 - 1e-6) % turn, DEPRESSED) == PARKED
    assert phase_at_rest((CLOSING - 0.3) % turn, DEPRESSED) == PARKED
    for angle in (CLOSING - 0.19, CLOSING, 0.0, 0.3, 3.0, CLOSING - 0.5):
        assert phase_at_rest(angle % turn, DEPRESSED) == WIPING
