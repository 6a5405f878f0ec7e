"""Every shipped supply profile as `simulate` records it in `supply_v`: limits, edges, ripple and energy.

The truth is written here by hand from the published figures, as pieces with integrals on paper; docs/bench.md shows
the same figures. `python tests/scenario/test_supply_profiles.py` prints its rows.
"""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.resources import shipped
from hilplant.simulation.run import simulate
from hilplant.simulation.scenario import load_scenario

#: The profile begins so many ticks after the recording, and so many are recorded after its end.
BEFORE = AFTER = 100


@dataclass(frozen=True)
class Piece:
    """Seconds from one voltage straight to another, or with a sine about their mean that begins at its lowest."""

    seconds: float
    first_v: float
    last_v: float
    ripple_v_pp: float = 0.0
    ripple_hz: float = 0.0

    @property
    def energy(self) -> float:
        """Integral of the voltage's square [V^2 s]; a ripple makes whole periods."""
        a, b = self.first_v, self.last_v
        return self.seconds * ((a * a + a * b + b * b) / 3.0 + self.ripple_v_pp**2 / 8.0)

    def at(self, time_s: Floats) -> Floats:
        ripple = -0.5 * self.ripple_v_pp * np.cos(2.0 * np.pi * self.ripple_hz * time_s)
        return np.asarray(self.first_v + (self.last_v - self.first_v) * time_s / max(self.seconds, 1e-12) + ripple)

    @property
    def begins_v(self) -> float:
        return self.first_v - 0.5 * self.ripple_v_pp

    @property
    def ends_v(self) -> float:
        return self.last_v - 0.5 * self.ripple_v_pp


def hold(volts: float, seconds: float) -> Piece:
    return Piece(seconds, volts, volts)


def ripple(mean_v: float, v_pp: float, hz: float, seconds: float) -> Piece:
    return Piece(seconds, mean_v, mean_v, v_pp, hz)


def slope(first_v: float, last_v: float, seconds: float) -> Piece:
    return Piece(seconds, first_v, last_v)


@dataclass(frozen=True)
class Truth:
    """The voltage before, the pieces of a round, how many rounds, and the pause between two of them."""

    before_v: float
    pieces: tuple[Piece, ...]
    times: int = 1
    pause_s: float = 0.0

    @property
    def whole(self) -> list[Piece]:
        """All pieces of all rounds with the pauses between them."""
        pause = hold(self.pieces[-1].last_v, self.pause_s)
        return [*[*self.pieces, pause] * (self.times - 1), *self.pieces]

    @property
    def seconds(self) -> float:
        return sum(piece.seconds for piece in self.whole)


#: Load dump A falls to a tenth in 400 ms, (10 % to 10 % of 65.5 V); the file has twenty straight pieces of it.
DECAY = tuple(13.5 + 65.5 * 10.0 ** (-0.026 * k / 0.4) for k in range(21))
#: E-10: 1 to 10 ms by 1, to 100 ms by 10, to 2 s by 100, with 10 s between.
INTERRUPTIONS = [*np.arange(1, 11) * 1e-3, *np.arange(20, 101, 10) * 1e-3, *np.arange(200, 2001, 100) * 1e-3]


def start(lowest_v: float, mean_v: float, seconds: float, back_s: float) -> Truth:
    """ISO 16750-2: 12 V; 5 ms down, 15 ms; 50 ms up to the ripple of 2 V peak to peak, 2 Hz, and back; ten times."""
    low = mean_v - 1.0
    fall = (slope(12.0, lowest_v, 0.005), hold(lowest_v, 0.015), slope(lowest_v, low, 0.05))
    return Truth(12.0, (*fall, ripple(mean_v, 2.0, 2.0, seconds), slope(low, 12.0, back_s)), 10, 2.0)


TRUTH = {
    "lv124_e01_long_overvoltage": Truth(14.0, (hold(17.0, 3600.0), hold(14.0, 1.0))),
    "lv124_e02_transient_overvoltage": Truth(16.0, (
        slope(16.0, 18.0, 1e-3), hold(18.0, 0.4), slope(18.0, 17.0, 1e-3), hold(17.0, 0.6), slope(17.0, 16.0, 1e-3),
    ), 3, 2.0),
    "lv124_e03_transient_undervoltage": Truth(10.8, (
        slope(10.8, 9.0, 1.8e-3), hold(9.0, 0.5), slope(9.0, 10.8, 1.8e-3)), 3, 1.0),
    "lv124_e04_jump_start": Truth(10.8, (
        slope(10.8, 26.0, 0.01), hold(26.0, 60.0), slope(26.0, 10.8, 0.01), hold(10.8, 1.0))),
    "lv124_e05_load_dump": Truth(13.5, (
        slope(13.5, 27.0, 1e-3), hold(27.0, 0.3), slope(27.0, 13.5, 0.01)), 10, 60.0),
    **{f"lv124_e06_ripple_{n}v": Truth(16.0, (ripple(16.0, float(n), 15.0, 30.0),)) for n in (2, 3, 6)},
    "lv124_e07_slow_fall_and_rise": Truth(16.0, (slope(16.0, 0.0, 32 * 60.0), slope(0.0, 16.0, 32 * 60.0))),
    "lv124_e08_slow_fall_fast_rise": Truth(16.0, (
        slope(16.0, 6.0, 1200.0), hold(6.0, 60.0), slope(6.0, 0.0, 720.0), hold(0.0, 60.0), slope(0.0, 16.0, 0.4),
        hold(16.0, 1.0))),
    "lv124_e09_reset": Truth(6.0, (hold(6.0, 10.0), *(
        piece for k in range(1, 13) for piece in (hold(6.0 - 0.5 * k, 5.0), hold(6.0, 10.0))))),
    "lv124_e10_short_interruptions": Truth(12.0, (hold(12.0, 10.0), *(
        piece for seconds in INTERRUPTIONS for piece in (hold(0.0, float(seconds)), hold(12.0, 10.0))))),
    "lv124_e11_cold_normal": Truth(11.0, (
        hold(4.5, 0.019), slope(4.5, 6.5, 0.05), ripple(7.5, 2.0, 2.0, 10.0), slope(6.5, 11.0, 0.1)), 10, 2.0),
    "lv124_e11_cold_severe": Truth(11.0, (
        hold(3.2, 0.019), hold(5.0, 0.329), slope(5.0, 6.0, 0.05), ripple(7.0, 2.0, 2.0, 10.0), slope(6.0, 11.0, 0.1),
    ), 10, 2.0),
    "lv124_e11_warm_long": Truth(11.0, (
        hold(7.0, 0.015), slope(7.0, 8.0, 0.075), hold(8.0, 0.24), slope(8.0, 9.0, 0.07), hold(9.0, 0.6),
        hold(11.0, 19.0)), 100),
    "lv124_e15_reverse_polarity": Truth(0.0, (hold(-14.0, 60.0), hold(0.0, 1.0)), 3),
    "iso16750_start_1": start(8.0, 10.5, 1.0, 0.04),
    "iso16750_start_2": start(4.5, 7.5, 10.0, 0.1),
    "iso16750_start_3": start(3.0, 6.0, 1.0, 0.1),
    "iso16750_start_4": start(6.0, 7.5, 10.0, 0.1),
    "iso16750_load_dump_a": Truth(13.5, (
        slope(13.5, 79.0, 0.005), *(slope(a, b, 0.026) for a, b in pairwise(DECAY)), slope(DECAY[-1], 13.5, 0.05),
        hold(13.5, 0.1)), 10, 60.0),
    "iso16750_load_dump_b": Truth(13.5, (slope(13.5, 35.0, 0.01), hold(35.0, 0.35), slope(35.0, 13.5, 0.1)), 5, 60.0),
}  # fmt: skip
NAMES = list(TRUTH)


@pytest.fixture(scope="module", params=NAMES)
def run(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Floats]:
    """A profile, and `supply_v` as `simulate` records it while the wiper runs."""
    name: str = request.param
    truth, path = TRUTH[name], tmp_path_factory.mktemp("driven") / "driven.yaml"
    seconds = round(truth.seconds + 1e-3 * (BEFORE + AFTER), 3)
    supply = f"[[0, {truth.before_v}], [{1e-3 * BEFORE}, {{profile: {name}}}]]"
    path.write_text(f"seconds: {seconds}\nsignals:\n  relay_on: [[0, true]]\n  supply_v: {supply}\n", encoding="utf-8")
    return name, simulate(load_bench("default"), load_scenario(path))["supply_v"].copy()


def began(truth: Truth) -> list[float]:
    """Return when each piece begins [s], from the recording's first tick on, and when the last one ends."""
    seconds = [1e-3 * BEFORE, *(piece.seconds for piece in truth.whole)]
    return [round(float(each), 9) for each in np.cumsum(seconds)]


def test_it_stays_within_its_limits_and_reaches_them(run: tuple[str, Floats]) -> None:
    truth, volts = TRUTH[run[0]], run[1]
    ends = np.ravel([(piece.begins_v, piece.ends_v) for piece in truth.pieces])
    tops = [piece.first_v + 0.5 * piece.ripple_v_pp for piece in truth.pieces]
    ripple = max(0.5 * p.ripple_v_pp * (1.0 - np.cos(np.pi * p.ripple_hz * 1e-3)) for p in truth.pieces)
    assert volts.min() == pytest.approx(min(truth.before_v, *ends), abs=1e-9)
    assert volts.max() == pytest.approx(max(truth.before_v, *ends, *tops), abs=ripple + 1e-9)


def test_every_edge_of_every_round_comes_and_takes_as_long_as_it_should(run: tuple[str, Floats]) -> None:
    truth, volts = TRUTH[run[0]], run[1]
    before, edges, times = truth.before_v, 0, began(truth)
    for piece, at_s, end_s in zip(truth.whole, times[:-1], times[1:], strict=True):
        first, last = int(np.ceil(at_s * 1e3 - 1e-6)), int(np.ceil(end_s * 1e3 - 1e-6))
        if abs(piece.begins_v - before) > 1e-9:  # a jump: in one tick
            assert volts[first - 1 : first + 1] == pytest.approx([before, piece.begins_v], abs=1e-9)
            edges += 1
        if piece.begins_v != piece.ends_v:  # a slope: leaves, goes one way only, arrives
            way = np.sign(piece.ends_v - piece.begins_v)
            assert (way * np.diff(volts[first:last]) > 0.0).all() and way * (piece.ends_v - volts[last - 1]) > 0.0
            edges += 1
        before = piece.ends_v
    assert volts[-AFTER:] == pytest.approx(np.full(AFTER, truth.pieces[-1].last_v), abs=1e-9)
    assert edges >= truth.times


def test_every_tick_is_on_its_curve(run: tuple[str, Floats]) -> None:
    truth, volts = TRUTH[run[0]], run[1]
    expected, times = np.full(len(volts), truth.before_v), began(truth)
    for piece, at_s in zip(truth.whole, times, strict=False):
        first, last = (int(np.ceil(s * 1e3 - 1e-6)) for s in (at_s, at_s + piece.seconds))
        expected[first:last] = piece.at(np.arange(first, last) * 1e-3 - at_s)
    expected[int(np.ceil(times[-1] * 1e3 - 1e-6)) :] = truth.pieces[-1].last_v
    assert np.abs(volts - expected).max() < (
        1e-3 if run[0].endswith("dump_a") else 1e-9
    )  # that file has three decimals


def test_its_energy_is_that_on_paper(run: tuple[str, Floats]) -> None:
    truth, volts = TRUTH[run[0]], run[1]
    square = volts[BEFORE : BEFORE + round(truth.seconds * 1e3)] ** 2
    paper = sum(piece.energy for piece in truth.whole)
    ends = [truth.before_v, *(volt for piece in truth.whole for volt in (piece.begins_v, piece.ends_v))]
    edges = 0.5e-3 * np.abs(np.diff(np.square(ends))).sum()  # half a tick's width at each edge
    print(f"{run[0]}: {square.sum() * 1e-3:.7g} V^2 s recorded, {paper:.7g} on paper")
    assert square.sum() * 1e-3 == pytest.approx(paper, abs=edges + 1e-6 * paper)
    assert edges < 5e-3 * paper


def test_load_dump_a_falls_as_an_exponential_to_half_a_percent_of_its_energy() -> None:
    rate, seconds, top = np.log(10.0) / 0.4, 0.52, 65.5
    part = (1.0 - np.exp(-rate * seconds)) / rate, (1.0 - np.exp(-2.0 * rate * seconds)) / (2.0 * rate)
    paper = 13.5**2 * seconds + 2.0 * 13.5 * top * part[0] + top**2 * part[1]
    assert sum(slope(a, b, 0.026).energy for a, b in pairwise(DECAY)) == pytest.approx(paper, rel=5e-3)


def test_every_shipped_profile_is_here_and_told_in_the_docs_with_its_figures() -> None:
    assert sorted(NAMES) == sorted(path.stem for path in shipped("config", "profiles").glob("*.yaml"))
    page = (Path(__file__).parents[2] / "docs" / "bench.md").read_text(encoding="utf-8")
    for name in NAMES:
        assert told(name) in page, told(name)


def told(name: str) -> str:
    """Return the row of the docs' table: limits [V], length [s], edges [s], energy [V^2 s]."""
    truth = TRUTH[name]
    tops = [piece.first_v + 0.5 * piece.ripple_v_pp for piece in truth.pieces]
    ends = [truth.before_v, *(v for piece in truth.pieces for v in (piece.begins_v, piece.ends_v))]
    slopes = sorted({p.seconds for p in truth.pieces if p.begins_v != p.ends_v})
    before = [truth.before_v, *(piece.ends_v for piece in truth.pieces)]
    jumps = any(piece.begins_v != volts for piece, volts in zip(truth.pieces, before, strict=False))
    edges = ", ".join([*(["a tick"] if jumps else []), *(f"{seconds:g}" for seconds in slopes)])
    energy = sum(piece.energy for piece in truth.whole)
    return f"| `{name}` | {min(ends):g} | {max(*ends, *tops):g} | {truth.seconds:g} | {edges} | {energy:.0f} |"


if __name__ == "__main__":
    print("\n".join(told(name) for name in NAMES))
