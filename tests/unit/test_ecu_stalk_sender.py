"""The stalk on the bus: what a hand sends is what the ECU hears, for each position that the stalk has."""

import asyncio
from pathlib import Path

import cantools
import pytest
from support.wire import Wire

from hilplant.bench import Bench, load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.in_memory import InMemoryBus
from hilplant.ecu.node import EcuNode, EcuReport
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import PRESSES_S, WORDS, Move, move_named, moved
from hilplant.ecu.stalk_sender import StalkSender
from hilplant.ecu.vocabulary import Master, Stalk
from hilplant.operator_page import stalk as page
from hilplant.operator_page.stalk import StalkOnBus
from hilplant.resources import shipped
from hilplant.units import MILLISECOND_NS

MOVES = (*WORDS, *(f"intermittent{pause}" for pause in range(1, 7)))
STALKS = [moved(Stalk(), move, ago_s) for word in MOVES if (move := move_named(word)) for ago_s in (0.0, 1.0)]
INVERTED = """extends: default.yaml
name: x
ecu:
  receive:
    StalkCommand:
      signals:
        Master_Input: {signal: master_input, choices: {Fast: off, Slow: intermittent, Intermittent: slow, Off: fast}}
        Intermittent_Switch: intermittent_switch
        Flick_Wipe: {signal: flick_wipe, invert: true}
        Wash: wash
        Automatic: {signal: automatic, invert: true}
"""


class Seat:
    """An ECU and a hand on one bus."""

    def __init__(self, bench: Bench) -> None:
        self.bus = InMemoryBus()
        self.node = EcuNode(bench.ecu_side(), self.bus.end(), controller_settings(bench.ecu))
        self.node.report = self.note
        self.heard: list[EcuReport] = []
        self.now_ns = 0

    def note(self, report: EcuReport) -> None:
        self.heard.append(report)

    def hears(self) -> Stalk:
        self.now_ns += MILLISECOND_NS
        self.node.poll(self.now_ns, Stalk(Master.OFF, 6))
        return self.heard[-1].stalk


@pytest.fixture(scope="module", params=["default", "inverted"])
def bench(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Bench:
    if request.param == "default":
        return load_bench()
    path: Path = tmp_path_factory.mktemp("bench") / "own.yaml"
    path.write_text(INVERTED)
    return load_bench(path)


def test_the_ecu_hears_each_stalk_as_the_hand_has_it(bench: Bench) -> None:
    seat = Seat(bench)
    sender = StalkSender(bench.ecu_messages.driver, seat.bus.end())
    for at, stalk in enumerate(STALKS):
        sender.act(at * MILLISECOND_NS, stalk)
        assert seat.hears() == stalk


def test_a_stalk_is_sent_when_it_changes_and_at_its_cycle_time_and_not_else(bench: Bench) -> None:
    bus = InMemoryBus()
    sender, ear = StalkSender(bench.ecu_messages.driver, bus.end()), bus.end()
    sent = []
    for at in range(250):
        sender.act(at * MILLISECOND_NS, Stalk(Master.SLOW if at >= 130 else Master.OFF))
        sent += [(at, frame.data) for frame in ear.receive(10)]
    assert [at for at, _ in sent] == [0, 100, 130, 200]


def test_what_others_say_does_not_pile_up_at_the_hand_s_interface(bench: Bench) -> None:
    wire = Wire()
    wire.arriving = [Frame(0x7FF, b"junk")] * 3
    StalkSender(bench.ecu_messages.driver, wire).act(0, Stalk())
    assert not wire.arriving


def test_leaving_gives_the_interface_back(bench: Bench) -> None:
    wire = Wire()
    StalkSender(bench.ecu_messages.driver, wire).close()
    assert wire.closed


def test_the_shipped_database_reads_what_the_hand_sends() -> None:
    bus = InMemoryBus()
    sender, ear = StalkSender(load_bench().ecu_messages.driver, bus.end()), bus.end()
    sender.act(0, Stalk(Master.FAST, 5, wash=True, automatic=True))
    (frame,) = ear.receive(10)
    told = cantools.database.load_file(shipped("dbc", "wiper.dbc")).decode_message(frame.identifier, frame.data)
    assert [str(told[name]) for name in ("Master_Input", "Intermittent_Switch", "Flick_Wipe", "Wash", "Automatic")] == [
        "Fast", "5", "Released", "Pressed", "On",
    ]  # fmt: skip


@pytest.mark.parametrize("word", MOVES)
def test_the_pages_hand_moves_the_stalk_on_the_bus(word: str, monkeypatch: pytest.MonkeyPatch) -> None:
    bench = load_bench()
    seat = Seat(bench)
    monkeypatch.setattr(page, "open_transport", lambda _: seat.bus.end())

    async def moves() -> None:
        hand = StalkOnBus(bench)
        work = asyncio.create_task(hand.work())
        move = move_named(word)
        assert move is not None
        hand.move(word)
        assert seat.hears() == moved(Stalk(), move, 0.0)
        await asyncio.sleep(PRESSES_S.get(word, 0.0) + 0.05)
        assert seat.hears() == moved(Stalk(), move._replace(press=None), 0.0)
        assert not work.done()
        work.cancel()

    asyncio.run(moves())


@pytest.mark.parametrize("word", MOVES)
def test_a_movement_is_written_as_it_is_read(word: str) -> None:
    move = move_named(word)
    assert isinstance(move, Move)
    assert move_named(move.words) == move
