"""A bench with a torque network drives the server: the same frames as without it, and the hand-over in one of them."""

from collections import Counter

import numpy as np
import pytest
from support.wire import Wire

from hilplant.bench import load_bench
from hilplant.bus.frame import Frame
from hilplant.bus.transport import SendResult
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.server import build_loop
from hilplant.signals import ACTIVE_MODELS
from hilplant.simulation.bus_run import ROUND_S, drive

RELAY, ENVIRONMENT, LOSS_FAULTS, LINKAGE = 0x120, 0x122, 0x214, 0x202
NETWORK, STANDSTILL, OUTSIDE = (ACTIVE_MODELS.index(name) for name in ("network", "standstill", "outside"))
STEP_NS = 1_000_000


class Sent(Wire):
    """An interface that keeps what is sent, with the tick, and gives what is put into it."""

    def __init__(self) -> None:
        super().__init__()
        self.now, self.frames = 0, []

    def send(self, frame: Frame) -> SendResult:
        self.frames.append((self.now, frame))
        return SendResult.SENT


def run(name: str) -> list[tuple[int, Frame]]:
    """Wipe slowly for 6 s; from 3 s to 4 s the screen is tacky."""
    transport = Sent()
    loop = build_loop(load_bench(name), transport, VirtualClock())
    for tick in range(6000):
        transport.now = tick
        if tick % 50 == 0:
            transport.arriving.append(Frame(RELAY, b"\x01\x00"))
        if tick % 100 == 0:
            tacky = 3000 <= tick < 4000
            transport.arriving.append(Frame(ENVIRONMENT, bytes([2 if tacky else 0, 0, 0])))
        loop.tick(tick * STEP_NS)
    return transport.frames


@pytest.fixture(scope="module")
def runs() -> tuple[list[tuple[int, Frame]], list[tuple[int, Frame]]]:
    return run("network"), run("default")


def test_the_same_frames_come_as_from_the_physical_plant(runs) -> None:
    ours, theirs = (
        [(tick, frame.identifier) for tick, frame in sent if frame.identifier != LOSS_FAULTS] for sent in runs
    )
    changes = Counter(ours), Counter(theirs)
    assert {identifier for _, identifier in ours} == {identifier for _, identifier in theirs}
    # frames that also come when the park contact changes may do so a few ticks apart; all others agree to the tick
    apart = (changes[0] - changes[1]).total() + (changes[1] - changes[0]).total()
    assert apart < 0.01 * len(theirs)


def test_the_hand_over_is_told_in_the_tick_in_which_it_happens(runs) -> None:
    told = [(tick, frame.data[6] >> 1 & 3) for tick, frame in runs[0] if frame.identifier == LOSS_FAULTS]
    modes = dict(told)
    assert modes[3000] == OUTSIDE and modes[4000] == NETWORK
    assert {mode for tick, mode in told if 1500 <= tick < 3000} == {NETWORK}
    assert {mode for tick, mode in told if tick < 2} == {STANDSTILL}
    assert {frame.data[6] >> 1 & 3 for _, frame in runs[1] if frame.identifier == LOSS_FAULTS} == {0}


def test_the_arms_stay_together(runs) -> None:
    angles = [
        np.array([int.from_bytes(frame.data[:2], "little") for _, frame in sent if frame.identifier == LINKAGE])
        for sent in runs
    ]
    assert len(angles[0]) == len(angles[1]) and np.ptp(angles[1]) > 1000
    turn = 2.0 * np.pi / 1e-4
    away = np.abs(np.remainder(angles[0] - angles[1] + turn / 2, turn) - turn / 2) * 1e-4
    assert away.max() < np.radians(4.0)


@pytest.mark.parametrize("name", ["polynomial", "linkage_alone_polynomial"])
def test_a_polynomial_parks_where_the_linkage_alone_does(name: str) -> None:
    """Two rounds of all stages, by the ECU on a bus: as many stops, within 1 deg, current within 3 % of its range."""
    ours, physical = (drive(load_bench(bench), 2.0 * ROUND_S, look_ms=1.0) for bench in (name, "linkage_alone"))
    assert ours.frames.keys() == physical.frames.keys()
    assert len(ours.stops()) == len(physical.stops()) > 8
    assert np.degrees(np.abs(ours.stops() - physical.stops())).max() < 1.0
    error = np.sqrt(np.mean((ours["current_a"] - physical["current_a"]) ** 2))
    assert error < 0.03 * np.ptp(physical["current_a"])
