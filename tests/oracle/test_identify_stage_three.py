"""Stage 3 against what is known in closed form: linear regression, and exact derivatives."""

from types import SimpleNamespace

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.identify.experiment import simulate_run
from hilplant.identify.local_search import left_over, search
from hilplant.identify.parameters import SEVENTEEN, Choice, chosen
from hilplant.identify.profile import profile
from hilplant.identify.residuals import LeastSquares, ResidualNoise, directions, edge_errors_s, expected_noise
from hilplant.identify.run_of_data import make_run
from hilplant.identify.twin import CLEAN, Corruption, TwinCondition, chance, corrupted, played, thesis_conditions
from hilplant.identify.uncertainty import spread, verdicts
from hilplant.thesis.coverage import twin_runs

COUNT, SAMPLES, EDGES = 4, 4000, 40
ONE = ResidualNoise(1.0, 1.0)


class Straight(LeastSquares):
    """Residuals that are linear in the parameters: everything about them is known from the normal equations."""

    def __init__(self, design, data, noise=ONE):
        row = np.ones(60)
        self.choice = Choice(SEVENTEEN[:COUNT], row)
        self.runs = (SimpleNamespace(period_s=0.001, current_a=np.zeros(SAMPLES), valid=np.ones(SAMPLES, bool)),)
        self.design, self.data, self.noise = design, data, noise
        self.parameters, self.scale = COUNT, np.ones(COUNT)

    def start(self, values):
        return np.array(values)

    def bounds(self, low, high):
        return low, high

    def with_noise(self, noise):
        return Straight(self.design, self.data, noise)

    def localised(self, x):
        return self

    def simulated(self, sets):
        weights = np.concatenate([np.full(SAMPLES, self.noise.current_a), np.full(EDGES, self.noise.edge_s)])
        return (sets @ self.design.T - self.data) / weights

    def parts(self):
        return [(slice(0, SAMPLES), slice(SAMPLES, SAMPLES + EDGES))]

    @property
    def moved(self):
        return np.arange(COUNT)

    def _fill_offsets(self, columns):
        pass


@pytest.fixture
def regression():
    random = np.random.default_rng(8)
    design = random.standard_normal((SAMPLES + EDGES, COUNT)) * [1.0, 3.0, 0.5, 1.0]
    design[:, 3] = 0.9 * design[:, 0] + 0.2 * design[:, 3]  # hard to tell from the first
    truth = np.array([1.0, 1.1, 0.9, 1.05])
    return design, design @ truth + random.standard_normal(SAMPLES + EDGES)


def test_a_linear_problem_gives_the_normal_equations(regression):
    """Estimates, standard errors and profile intervals are those of ordinary least squares.

    The weak tie to the start moves what is hardly told by less than a tenth of its standard error.
    """
    design, data = regression
    solution = search(Straight(design, data), np.array([0.8, 1.3, 1.0, 0.9]))
    expected, *_ = np.linalg.lstsq(design, data, rcond=None)
    errors = np.sqrt(np.diag(np.linalg.inv(design.T @ design)))
    assert np.allclose(solution.values, expected, rtol=0.0, atol=0.1 * errors)
    known = spread(solution)
    scale = np.sqrt(np.mean(solution.residuals**2))
    found = np.sqrt(np.diag(known.covariance))
    assert np.all(found > 0.97 * scale * errors)
    assert np.all(found < 1.5 * scale * errors)  # 16 blocks scatter, and only a larger spread than that of noise counts
    assert known.widening == pytest.approx(np.maximum(known.widening, 1.0))
    said = verdicts(solution, known)
    ends = np.array(profile(solution, known, said))
    assert np.allclose(ends[:, 1] - solution.values, 1.96 * found, rtol=0.05)
    assert np.allclose(solution.values - ends[:, 0], 1.96 * found, rtol=0.05)


def test_an_interval_allows_for_what_is_hardly_told(regression):
    """The first parameter is told, but hangs on the last, which is not: ordinary least squares over all says how far.

    A profile along which the last one stayed where it is would be four times too narrow.
    """
    design = regression[0].copy()
    along, across = np.linalg.qr(np.random.default_rng(5).standard_normal((len(design), 2)))[0].T
    design[:, 0], design[:, 3] = 30.0 * along, 3.0 * along + 0.8 * across
    data = design @ np.array([1.0, 1.1, 0.9, 1.05]) + np.random.default_rng(6).standard_normal(len(design))
    solution = search(Straight(design, data), np.array([1.0, 1.1, 0.9, 1.05]))
    known = spread(solution)
    said = verdicts(solution, known)
    assert [each.identifiable for each in said] == [True, True, True, False]
    error = np.sqrt(np.linalg.inv(design.T @ design)[0, 0])
    low, high = profile(solution, known, said)[0]
    assert 1.96 * 0.97 * error < 0.5 * (high - low) < 1.96 * 1.5 * error


def test_residuals_that_hang_together_widen_the_intervals(regression):
    """Noise that stays the same for 50 samples says 50 times less; the intervals must say so too."""
    design, _ = regression
    random = np.random.default_rng(3)
    slow = np.repeat(random.standard_normal((SAMPLES + EDGES) // 40), 40)[: SAMPLES + EDGES]
    smooth = np.repeat(design[::40], 40, axis=0)[: SAMPLES + EDGES]
    truth = np.array([1.0, 1.1, 0.9, 1.05])
    solution = search(Straight(smooth, smooth @ truth + slow), truth)
    known = spread(solution)
    naive = np.sqrt(np.diag(np.linalg.inv(smooth.T @ smooth)))
    assert np.all(np.sqrt(np.diag(known.covariance)) > 2.0 * naive)


def test_what_two_columns_say_together_is_not_told_apart():
    """Two parameters with the same effect: each is named as not told, and with the other."""
    random = np.random.default_rng(1)
    design = random.standard_normal((SAMPLES + EDGES, COUNT))
    design[:, 2] = design[:, 1]
    data = design @ np.array([1.0, 1.1, 0.9, 1.05]) + 0.1 * random.standard_normal(SAMPLES + EDGES)
    solution = search(Straight(design, data), np.array([0.9, 1.0, 1.0, 1.0]))
    said = verdicts(solution, spread(solution))
    assert [each.identifiable for each in said] == [True, False, False, True]
    assert said[1].together == (said[2].name,)
    assert said[2].together == (said[1].name,)
    intervals = profile(solution, spread(solution), said)
    assert intervals[1] == (None, None)


@pytest.fixture(scope="module")
def wipe():
    """One wipe at 14 V, slow and dry, as the plant makes it."""
    bench = load_bench("default")
    data = corrupted(played(bench, TwinCondition(False, 0.0, (14.0,))), CLEAN, 0.001, 0)
    runs = [make_run(data, bench, 0.0)]
    choice = chosen(bench.parameter_row)
    return bench, runs, LeastSquares(runs, choice, bench.tables, ResidualNoise(0.1, 3e-4), np.abs(choice.values))


def test_the_truth_leaves_nothing_but_the_rounding_of_edges(wipe):
    bench, _, problem = wipe
    x = problem.start(chosen(bench.parameter_row).values)
    problem = problem.localised(x)
    left = left_over(problem, problem.residuals(x))
    assert left.current_a < 1e-9
    assert left.edge_s < 0.00051  # half a sample and the curve of the motion


def test_derivatives_agree_with_richardson_extrapolation(wipe):
    """Differences along singular directions give the same as extrapolated ones, where a parameter acts smoothly."""
    bench, _, problem = wipe
    x = problem.start(chosen(bench.parameter_row).values)
    moved = problem.moved
    jacobian = problem.jacobian(x)
    for _ in range(2):
        jacobian = problem.jacobian(x, directions(jacobian[:, moved]))
    for name in ("slow_inductance_henry", "damping_n_m_s", "slow_constant_v_s"):
        place = problem.choice.names.index(name)
        step = np.zeros(len(x))
        step[place] = 4e-4
        coarse, fine = (
            (problem.residuals(x + h * step) - problem.residuals(x - h * step)) / (h * 8e-4) for h in (1.0, 0.5)
        )
        best = (4.0 * fine - coarse) / 3.0
        error = np.linalg.norm(jacobian[:, place] - best) / np.linalg.norm(best)
        assert error < 0.03, name


def test_no_two_noises_share_the_rounding_of_their_park_edges(wipe):
    """Over noises the time error of the true model at each edge is even within half a sample, and of no other edge's.

    Were it the same in all, it would move every estimate the same way, and intervals would seem to hold too seldom.
    """
    bench, *_ = wipe
    errors = []
    for seed in range(40):
        row = []
        for condition in thesis_conditions((12.0, 16.0)):
            drawn = chance(bench, condition, seed)
            run = make_run(corrupted(played(bench, condition, CLEAN, drawn), CLEAN, 0.001, 0), bench, condition.screen)
            made = simulate_run(run, bench.parameter_row[np.newaxis], np.array([drawn.start_rad]), bench.tables)
            assert np.max(np.abs(made.current_a[0] - run.current_a)) < 1e-9
            speeds = (made.phase_rad[0, run.edges] - made.phase_rad[0, run.edges - 1]) / 0.001
            row += list(edge_errors_s(run, made.phase_rad)[0] * run.edge_speeds_rad_s / speeds)
        errors.append(row)
    found = np.array(errors) / 0.001
    assert found.shape == (40, 4)
    assert np.max(np.abs(found)) < 0.51  # the curve of the motion adds a little
    assert np.std(found) == pytest.approx(12.0**-0.5, rel=0.15)
    assert np.all(np.abs(np.mean(found, axis=0)) < 3.0 * 12.0**-0.5 / 40.0**0.5)
    assert np.max(np.abs(np.corrcoef(found.T) - np.eye(4))) < 3.5 / 40.0**0.5


def test_noise_is_seen_from_sample_to_sample(wipe):
    bench, *_ = wipe
    how = Corruption(0.2, 0.01)
    runs = twin_runs(bench, [TwinCondition(False, 0.0, (14.0,))], how, 5)
    assert expected_noise(runs).current_a == pytest.approx(0.2, rel=0.1)
