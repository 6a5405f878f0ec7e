"""The test sequence steps on at park edges and nowhere else, and its scenario plays the same on the plant."""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from hilplant.failure import Failure
from hilplant.identify.sequence import Player, SequenceStage, advance, figure_5_4, informative, play, scenario_text
from hilplant.identify.sequence_runs import Rig, drive, stages_of, write_scenario
from hilplant.simulation.run import simulate


def test_the_published_sequence() -> None:
    """Slow at 10, 12, 14, 16 V, one turn each, then fast (Figure 5-4)."""
    stages = figure_5_4()
    assert [(stage.fast, stage.voltage_v) for stage in stages[1:-1]] == [
        (fast, volts) for fast in (False, True) for volts in (10.0, 12.0, 14.0, 16.0)
    ]
    assert all(stage.edges == 1 for stage in stages[1:-1]) and not stages[0].on and not stages[-1].on


def test_the_better_one_starts_from_rest_at_each_voltage_in_both_modes() -> None:
    stages = informative((10.0, 14.0))
    starts = [(b.fast, b.voltage_v) for a, b in pairwise(stages) if b.on and not a.on]
    assert starts == [(False, 10.0), (False, 14.0), (True, 10.0), (True, 14.0)]


def test_an_edge_counts_only_after_the_contact_was_open() -> None:
    stages = [SequenceStage(True, False, 12.0, 2, 100.0), SequenceStage(True, False, 14.0, 1, 100.0)]
    player = Player()
    for tick, contact in enumerate([1, 1, 0, 0, 1, 1, 0, 1]):
        before, player = player, advance(player, stages, bool(contact), 0.1 * tick)
        assert player.place == (1 if tick == 7 else 0), before
    assert player.entered_s == pytest.approx(0.7)


def test_a_dead_park_switch_ends_each_stage_in_time() -> None:
    begun = play(
        [SequenceStage(True, False, 12.0, 1, 2.0), SequenceStage(True, True, 12.0, 1, 3.0)], 0.1, lambda _: False
    )
    assert [time_s for time_s, _ in begun] == pytest.approx([0.0, 2.0, 5.0])


def test_the_scenario_names_only_what_changes() -> None:
    off, slow = SequenceStage(False, False, 10.0, 0, 1.0), SequenceStage(True, False, 10.0, 1, 9.0)
    text = scenario_text([(0.0, off), (1.0, slow), (2.5, slow)], "t")
    assert "[1, true]" in text and text.count("- [") == 4 and "seconds: 2.5" in text


@pytest.mark.parametrize("kind", ["figure-5-4", "informative"])
def test_on_the_plant_every_step_while_running_comes_at_a_park_edge(tmp_path: Path, kind: str) -> None:
    """The written scenario, simulated, changes relays and supply in the tick after the contact closes."""
    out = tmp_path / "sequence.yaml"
    write_scenario("default", stages_of(kind, "10,14"), out)
    result = simulate("default", out)
    on, supply, park = (result[name] for name in ("relay_on", "supply_v", "park_contact"))
    moved = np.flatnonzero((np.diff(supply) != 0.0) & (on[:-1] > 0.5) & (on[1:] > 0.5)) + 1
    closings = np.flatnonzero(np.diff(park) > 0.5) + 1
    assert len(moved) >= 2
    assert all(tick - 1 in closings for tick in moved)


def test_wrong_wishes_are_told(tmp_path: Path) -> None:
    with pytest.raises(Failure, match="known: figure-5-4, informative"):
        stages_of("best", "10")
    with pytest.raises(Failure, match="numbers with commas"):
        stages_of("informative", "10;12")
    with pytest.raises(Failure, match="above 0"):
        stages_of("informative", "-3")
    with pytest.raises(Failure, match="too weak"):
        write_scenario("default", stages_of("figure-5-4", "1"), tmp_path / "x.yaml")


class RigOnTheDesk:
    """A node whose rig turns with the voltage it was sent, and whose clock is virtual; also the clock."""

    def __init__(self, dies_at_s: float = math.inf) -> None:
        self.now, self.turned, self.values, self.lost, self.sent = 0, 0.0, [1.0], False, []
        self._dies_ns = dies_at_s * 1e9

    def now_ns(self) -> int:
        return self.now

    def sleep_until_ns(self, deadline_ns: int) -> None:
        volts = self.sent[-1][2] * self.sent[-1][0] if self.sent else 0.0
        self.turned += 0.08 * volts * (deadline_ns - self.now) / 1e9
        self.now = deadline_ns

    def receive(self, now_ns: int) -> None:
        self.values[0] = 1.0 if self.turned % 1.0 < 0.04 else 0.0
        self.lost = now_ns > self._dies_ns

    def send(self, now_ns: int, values: list[float]) -> None:
        self.sent.append(tuple(values))


def test_on_a_rig_the_sequence_goes_through_all_stages_at_its_edges() -> None:
    node, told = RigOnTheDesk(), []
    stages = stages_of("figure-5-4", "10,14")
    drive(Rig(node, [0.0] * 3, [0, 1, 2], 0), stages, node, lambda: False, told.append)
    assert len(told) == len(stages)
    changes = [new for old, new in pairwise(node.sent) if new != old]
    assert changes == [(1, 0, 10), (1, 0, 14), (1, 1, 10), (1, 1, 14), (0, 0, 10)]
    assert node.turned == pytest.approx(4.0, abs=0.01)


def test_a_rig_whose_park_switch_goes_silent_is_left() -> None:
    node = RigOnTheDesk(dies_at_s=2.0)
    with pytest.raises(Failure, match="silent"):
        drive(Rig(node, [0.0] * 3, [0, 1, 2], 0), stages_of("informative", "12"), node, lambda: False, lambda _: None)
    assert 4.0e9 <= node.now < 4.1e9
