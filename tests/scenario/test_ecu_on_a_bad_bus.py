"""The ECU as a node on a bus that delays and loses frames: plant loop and ECU node in virtual time.

Truth is the plant's crank. The park switch is sent every 20 ms, the relays every 50 ms, both at once when they change.
"""

import math
import random
from collections import deque

import cantools
import pytest
from support.wire import Wire

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.ecu.chart import Phase
from hilplant.ecu.node import EcuNode
from hilplant.ecu.settings import controller_settings
from hilplant.ecu.stalk import parse_stalk, stalk_at
from hilplant.ecu.vocabulary import Fault
from hilplant.resources import shipped
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.server import build_loop
from hilplant.signals import PUBLISHED_INDEX
from hilplant.units import MILLISECOND_NS, SECOND_NS

DATABASE = cantools.database.load_file(shipped("dbc", "wiper.dbc"))
STALK_OFF = {
    "Master_Input": "Off",
    "Intermittent_Switch": 1,
    "Flick_Wipe": "Released",
    "Wash": "Released",
    "Automatic": "Off",
}
PARK_PERIOD_MS = 20
#: All stages, ended from each of them.
STORY = "0.1:slow,2.5:off,5:fast,9:off,12:i1,17:off,19:flick,22:slow,24:fast,26.5:i2,29:slow,31:off"
STORY_S = 36.0


class Cable:
    """Two ends of a bus with a delay; each frame is lost with some probability, seeded."""

    def __init__(self, delay_ms: float, loss: float, seed: int) -> None:
        self.delay_ns, self.loss, self.chance = round(delay_ms * MILLISECOND_NS), loss, random.Random(seed)
        self.now_ns, self.lost = 0, 0
        self.plant, self.ecu = End(self), End(self)
        self.plant.other, self.ecu.other = self.ecu, self.plant


class End(Wire):
    """One end: a transport."""

    def __init__(self, cable: Cable) -> None:
        super().__init__()
        self.cable, self.other = cable, self
        self.coming: deque[tuple[int, Frame]] = deque()

    def receive(self, limit: int) -> list[Frame]:
        arrived: list[Frame] = []
        while self.coming and len(arrived) < limit and self.coming[0][0] <= self.cable.now_ns:
            arrived.append(self.coming.popleft()[1])
        return arrived

    def send(self, frame: Frame) -> SendResult:
        if self.cable.chance.random() < self.cable.loss:
            self.cable.lost += 1
        else:
            self.other.coming.append((self.cable.now_ns + self.cable.delay_ns, frame))
        return SendResult.SENT


class Bus:
    """Plant and ECU at the ends of a cable, in virtual time."""

    def __init__(self, bench, cable: Cable) -> None:
        self.cable, self.loop = cable, build_loop(bench, cable.plant, VirtualClock())
        self.ecu = EcuNode(bench.ecu_side(), cable.ecu, controller_settings(bench.ecu))
        self.poll_ticks = round(bench.ecu.period_ms)
        self.faults: dict[Fault, None] = {}
        self.turns = self.angle = 0.0
        self.ticks = 0

    def play(self, story: str, seconds: float) -> None:
        turns = parse_stalk(story)
        for _ in range(round(seconds * 1000)):
            self.cable.now_ns = self.ticks * MILLISECOND_NS
            self.loop.tick(self.cable.now_ns)
            if self.ticks % self.poll_ticks == 0:
                self.ecu.poll(self.cable.now_ns, stalk_at(turns, self.cable.now_ns / SECOND_NS))
                self.faults[self.ecu.state.fault] = None
            self.ticks += 1
            angle = self["crank_angle_rad"]
            self.turns += math.remainder(angle - self.angle, 2.0 * math.pi) / (2.0 * math.pi)
            self.angle = angle

    def __getitem__(self, name: str) -> float:
        return self.loop._published[PUBLISHED_INDEX[name]]

    @property
    def parked(self) -> bool:
        at_rest = abs(self["crank_speed_rad_s"]) < 1e-6 and not self["relay_on"]
        return bool(self["park_contact"]) and at_rest and self.ecu.state.phase is Phase.OFF


@pytest.fixture(scope="module")
def bench():
    return load_bench("polynomial")


@pytest.fixture(scope="module")
def protected(tmp_path_factory):
    """The bench with counter and checksum in the relay command, which forgive two lost frames in a row."""
    folder = tmp_path_factory.mktemp("protected")
    database = shipped("dbc", "wiper.dbc").read_text().replace("RelayCommand: 2 ECU", "RelayCommand: 4 ECU")
    (folder / "own.dbc").write_text(database.replace("SG_ RelayOn : 0|1@1+", "SG_ RelayOn : 16|1@1+").replace(
        "SG_ RelayFast : 1|1@1+", "SG_ RelayFast : 17|1@1+"))  # fmt: skip
    path = folder / "bench.yaml"
    path.write_text(
        "extends: polynomial.yaml\nname: protected\nbus:\n  database: own.dbc\n  receive:\n    RelayCommand:\n"
        "      timeout_ms: 500\n      protection: {profile: 1, data_id: 0x123, max_delta_counter: 3}\n"
        "      signals: {RelayOn: relay_on, RelayFast: relay_fast}\n"
    )
    return load_bench(path)


def test_a_delay_of_one_frame_period_each_way_is_tolerated(bench):
    bus = Bus(bench, Cable(PARK_PERIOD_MS, loss=0.0, seed=0))
    bus.play(STORY, STORY_S)
    print(f"{bus.turns:.2f} turns, faults {[fault.value for fault in bus.faults]}")
    assert bus.parked
    assert bus.turns > 10
    assert set(bus.faults) <= {Fault.NONE, Fault.PARK_UNKNOWN, Fault.OFF_PARK}, "unknown before the first frame"


@pytest.mark.parametrize("loss", [0.05, 0.2])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_lost_frames_are_made_good_by_the_next(bench, loss, seed):
    bus = Bus(bench, Cable(0, loss, seed))
    bus.play(STORY, STORY_S)
    print(f"{bus.cable.lost} frames lost, {bus.turns:.2f} turns, faults {[fault.value for fault in bus.faults]}")
    assert bus.cable.lost > 100
    assert bus.parked
    assert bus.turns > 10


@pytest.mark.parametrize("seed", [4, 5])
def test_delay_and_loss_together_with_counter_and_checksum_are_tolerated(protected, seed):
    bus = Bus(protected, Cable(PARK_PERIOD_MS, 0.1, seed))
    bus.play(STORY, STORY_S)
    counts = bus.loop.counts()
    print(f"{bus.cable.lost} frames lost, {bus.turns:.2f} turns, faults {[fault.value for fault in bus.faults]}")
    assert bus.parked
    assert bus.turns > 10
    assert counts["wrong_crc"] == 0


def test_silence_of_the_plant_or_of_the_ecu_releases_the_relays_and_both_go_on_afterwards(bench):
    bus = Bus(bench, Cable(0, 0.0, seed=6))
    bus.play("0:slow", 1.0)
    assert bus["relay_on"]
    bus.cable.loss = 1.0
    bus.play("0:slow", 1.0)
    assert not bus["relay_on"], "the plant lets go after 500 ms without a command"
    assert bus.ecu.state.phase is Phase.BLIND, "the ecu after 200 ms without the park switch"
    bus.cable.loss = 0.0
    bus.play("0:slow", 1.0)
    assert bus["relay_on"]
    bus.play("0:off", 4.0)
    assert bus.parked


def test_the_plant_does_not_count_what_passes_between_the_ecu_and_its_driver(bench):
    bus = Bus(bench, Cable(0, 0.0, seed=7))
    stalk = DATABASE.encode_message("StalkCommand", STALK_OFF)
    for _ in range(100):
        bus.cable.ecu.send(Frame(0x110, stalk))
        bus.play("0:off", 0.01)
    assert bus.loop.counts()["unknown_frame"] == 0
    bus.cable.ecu.send(Frame(0x111, stalk))
    bus.play("0:off", 0.01)
    assert bus.loop.counts()["unknown_frame"] == 1
