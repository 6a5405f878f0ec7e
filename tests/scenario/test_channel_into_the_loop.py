"""Commands beside the bus: applied at a tick's start, answered, outranked, released, recorded, and replayed."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.channel_rig import Run
from support.loop_rig import SLOW, STEP_NS, SUPPLY, ListedTransport

from hilplant.models.records import PARAMETER_INDEX
from hilplant.runtime import commands as c
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.commands import ChannelCommand
from hilplant.runtime.follower import Follower
from hilplant.runtime.mailbox import MOST_A_TICK
from hilplant.runtime.ownership import Ownership
from hilplant.runtime.ring import Ring
from hilplant.runtime.row import ROW_WIDTH
from hilplant.runtime.server import build_loop
from hilplant.signals import INPUT_INDEX, INPUTS

RELAY_ON, SUPPLY_V, SCREEN = (INPUT_INDEX[name] for name in ("relay_on", "supply_v", "screen"))
_OUTPUT = 2 + len(INPUTS)


@pytest.fixture
def run() -> Iterator[Run]:
    run = Run()
    yield run
    run.close()


def supply_frame(run: Run) -> object:
    """Return the frame by which the bench's ECU sets the supply."""
    message = next(each for each in run.bench.ecu_side().send if SUPPLY_V in each.sources)
    values = [0.0] * 64
    values[SUPPLY_V] = 11.0
    from hilplant.bus.frame import Frame

    assert message.identifier == SUPPLY
    return Frame(message.identifier, message.encode(values)[0])


def test_a_set_value_is_there_in_the_next_tick_and_answered_with_it(run: Run) -> None:
    run.tick(3)
    run.post(c.SET, SUPPLY_V, 9.5, number=7)
    run.tick()
    assert run.input(SUPPLY_V) == 9.5
    assert run.owner(SUPPLY_V) == "hand"
    answer = run.follower.events().records
    assert (answer["tick"], answer["client"], answer["number"]) == (3, 1, 7)


def test_a_set_value_gives_way_to_the_next_frame_also_if_that_says_the_same(run: Run) -> None:
    run.post(c.SET, SUPPLY_V, 11.0)
    run.tick()
    assert run.owner(SUPPLY_V) == "hand"
    run.transport.arrived.append(supply_frame(run))
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (11.0, "bus")


def test_an_override_stands_against_a_controller_in_the_loop_until_it_is_released(run: Run) -> None:
    def control(_now_ns: int, _state: object, inputs: np.ndarray, _parameters: object) -> bool:
        inputs[SUPPLY_V] = 12.0
        return True

    run.loop.control = control
    run.transport.arrived.append(SLOW)
    run.tick()
    assert run.input(SUPPLY_V) == 12.0
    run.post(c.OVERRIDE, SUPPLY_V, 8.0)
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (8.0, "hand")
    run.post(c.RELEASE, SUPPLY_V)
    run.tick()
    assert run.input(SUPPLY_V) == 12.0


def test_an_override_stands_against_frames_until_it_is_released(run: Run) -> None:
    run.post(c.OVERRIDE, SUPPLY_V, 8.0)
    run.transport.arrived.append(supply_frame(run))
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (8.0, "hand")
    run.post(c.RELEASE, SUPPLY_V)
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (11.0, "bus")


def test_a_hand_outranks_the_scenario_and_the_scenario_the_bus(run: Run) -> None:
    run.post(c.OVERRIDE, SUPPLY_V, 10.0, owner=c.SCENARIO, client=0)
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (10.0, "scenario")
    run.post(c.SET, SUPPLY_V, 7.0)
    run.post(c.OVERRIDE, SUPPLY_V, 8.0)
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (8.0, "hand")
    assert [outcome for *_, outcome in run.events()] == ["applied", "held by the scenario", "applied"]
    run.post(c.RELEASE, SUPPLY_V)
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (10.0, "scenario")


def test_the_safe_state_stands_above_every_owner(run: Run) -> None:
    run.post(c.OVERRIDE, RELAY_ON, 1.0)
    run.tick()
    assert (run.input(RELAY_ON), run.owner(RELAY_ON)) == (0.0, "safe")
    run.tick(5, command_every=1)
    assert (run.input(RELAY_ON), run.owner(RELAY_ON)) == (1.0, "hand")
    run.post(c.RELEASE, RELAY_ON)
    run.tick(2, command_every=1)
    assert run.owner(RELAY_ON) == "bus"


def test_what_is_held_is_released_when_its_client_is_silent_for_the_lease_and_that_is_said(run: Run) -> None:
    lease_ticks = 50
    run.post(c.OVERRIDE, SUPPLY_V, 8.0, lease_ns=lease_ticks * STEP_NS)
    run.tick(30)
    run.post(c.ALIVE)  # in tick 30
    run.post(c.ALIVE, client=2)
    run.tick(lease_ticks)
    assert run.owner(SUPPLY_V) == "hand"
    run.tick()
    assert (run.input(SUPPLY_V), run.owner(SUPPLY_V)) == (13.5, "bus")
    assert run.events() == [(0, "override", "applied"), (80, "release", "lease over")]


def test_one_client_cannot_take_what_another_holds(run: Run) -> None:
    run.post(c.OVERRIDE, SCREEN, 1.0)
    for kind in (c.OVERRIDE, c.RELEASE, c.SET):
        run.post(kind, SCREEN, 0.5, client=2)
    run.tick()
    assert run.input(SCREEN) == 1.0
    assert [outcome for *_, outcome in run.events()] == ["applied"] + ["held by another client"] * 3


@pytest.mark.parametrize("value", [math.nan, math.inf, -16.1, 100.1])
def test_a_wrong_value_is_refused_by_the_loop_too(run: Run, value: float) -> None:
    run.post(c.OVERRIDE, SUPPLY_V, value)
    run.post(c.OVERRIDE, RELAY_ON, 0.5)
    run.post(c.SET, 99, 1.0)
    run.post(c.PARAMETER, len(PARAMETER_INDEX), 1.0)
    run.post(c.PARAMETER, 0, math.nan)
    run.post(c.REFERENCE, 0, 3.0)
    run.post(200)
    run.post(c.OVERRIDE, SUPPLY_V, 9.0, owner=9)
    run.tick()
    assert [outcome for *_, outcome in run.events()] == [
        *("out of range", "out of range", "no such element", "no such element", "out of range", "no controller"),
        *("no such element", "no such element"),
    ]
    assert run.input(SUPPLY_V) == 13.5


def test_parameters_of_one_group_change_in_one_tick_however_much_waits_before_them(run: Run) -> None:
    damping, inertia = PARAMETER_INDEX["motor.damping_n_m_s"], PARAMETER_INDEX["motor.inertia_kg_m2"]
    for _ in range(MOST_A_TICK - 1):
        run.post(c.MARK)
    group = [ChannelCommand(client=1, kind=c.PARAMETER, element=element, value=1e-4) for element in (damping, inertia)]
    assert run.ring.mailbox.post(group)
    run.post(c.MARK)
    run.tick(2)
    ticks = [tick for tick, kind, _ in run.events() if kind == "parameter"]
    assert ticks == [0, 0]
    assert run.loop._parameters[[damping, inertia]].tolist() == [1e-4, 1e-4]
    assert run.bench.parameter_row[inertia] != 1e-4


def test_a_full_mailbox_takes_no_part_of_a_group(run: Run) -> None:
    mark = ChannelCommand(client=1, kind=c.MARK)
    room = 512
    assert all(run.ring.mailbox.post([mark] * 8) for _ in range(room // 8 - 1))
    assert run.ring.mailbox.post([mark] * 7)
    assert not run.ring.mailbox.post([mark] * 2)
    assert run.ring.mailbox.post([mark])
    run.tick(room // MOST_A_TICK)
    assert len(run.events()) == room


def test_a_run_without_commands_is_what_it_was_without_the_channel(run: Run) -> None:
    plain = build_loop(
        run.bench, transport := ListedTransport(), VirtualClock(), ring := Ring.create(ROW_WIDTH, 128, 64)
    )
    for tick in range(40):
        transport.arrived.extend([SLOW] if tick % 20 == 0 else [])
        plain.tick(tick * STEP_NS)
    assert run.tick(40, command_every=20).tobytes() == ring.latest().tobytes()
    ring.close()


def test_followers_have_places_of_their_own_and_are_told_what_they_missed() -> None:
    ring = Ring.create(3, rows=16, frames=4)
    early, late = Follower(ring.name), Follower(ring.name)
    for tick in range(40):
        ring.next_row()[:] = tick
        ring.commit()
        if tick % 10 == 9:
            taken = early.rows()
            assert taken.records[:, 0].tolist() == list(range(tick - 9, tick + 1))
            assert taken.lost == 0
    taken = late.rows()
    assert taken.lost + len(taken.records) == 40
    assert taken.records[:, 0].tolist() == list(range(40 - len(taken.records), 40))
    assert len(taken.records) >= 14
    assert ring.lost == 0
    assert len(late.rows().records) == 0
    for each in (early, late):
        each.close()
    ring.close()


@given(
    st.lists(
        st.tuples(
            st.sampled_from("OR"), st.sampled_from((1, 2)), st.sampled_from((c.SCENARIO, c.HAND)), st.integers(0, 2)
        )
    )
)
def test_whatever_is_done_the_strongest_holder_stands(steps: list[tuple[str, int, int, int]]) -> None:
    """The truth beside it: a plain list of who holds what."""
    bus, row, inputs = [0.0] * 3, np.zeros(3), np.zeros(3)
    ownership, held = Ownership(bus, row), {}
    for number, (what, client, owner, index) in enumerate(steps, 1):
        command = ChannelCommand(client=client, owner=owner, element=index, value=float(number))
        holder = held.get((owner, index))
        if what == "O":
            outcome = ownership.hold(command, 0)
            assert (outcome == c.APPLIED) is (holder is None or holder[0] == client)
            if outcome == c.APPLIED:
                held[owner, index] = (client, float(number))
        elif what == "R":
            outcome = ownership.release(command)
            assert (outcome == c.APPLIED) is (holder is not None and holder[0] == client)
            if outcome == c.APPLIED:
                del held[owner, index]
        inputs[:] = bus
        ownership.impose(inputs)
        for place in range(3):
            owners = [owner for owner in (c.HAND, c.SCENARIO) if (owner, place) in held]
            assert row[place] == (owners[0] if owners else c.BUS)
            assert inputs[place] == (held[owners[0], place][1] if owners else 0.0)
