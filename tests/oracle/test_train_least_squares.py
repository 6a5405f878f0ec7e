"""The training's Jacobian against the complex step, its sums against whole matrices, its fits against closed forms."""

import numpy as np
import pytest
from numpy.typing import NDArray

from hilplant.train.levenberg_marquardt import DescentSettings, minimise
from hilplant.train.tanh_network import NetworkFit, Samples, TanhNetwork

NETWORK = TanhNetwork(3, 4, 2)


def problem(seed: int) -> tuple[NetworkFit, NDArray[np.float64]]:
    random = np.random.default_rng(seed)
    inputs, targets = random.uniform(-1, 1, (50, 3)), random.uniform(-1, 1, (50, 2))
    samples = Samples(inputs, targets)
    return NetworkFit(NETWORK, samples.taken(np.arange(35)), samples.taken(np.arange(35, 50))), NETWORK.start(random)


def test_the_jacobian_is_that_of_the_complex_step() -> None:
    fit, weights = problem(1)
    inputs = fit.training.inputs
    for output in range(2):
        ours = NETWORK.jacobian(weights, inputs, output)
        for k in range(NETWORK.size):
            stepped = weights.astype(complex)
            stepped[k] += 1e-30j
            theirs = NETWORK.answer(stepped, inputs)[:, output].imag / 1e-30
            assert ours[:, k] == pytest.approx(theirs, rel=1e-12, abs=1e-14)


def test_the_sums_are_those_of_the_whole_matrices() -> None:
    fit, weights = problem(2)
    inputs, targets = fit.training.inputs, fit.training.targets
    whole = np.concatenate([NETWORK.jacobian(weights, inputs, output) for output in range(2)])
    residuals = (NETWORK.answer(weights, inputs) - targets).T.ravel()
    error, hessian, gradient = fit.normal(weights)
    assert error == pytest.approx(residuals @ residuals) == pytest.approx(fit.cost(weights))
    assert hessian == pytest.approx(whole.T @ whole, rel=1e-10, abs=1e-12)
    assert gradient == pytest.approx(whole.T @ residuals, rel=1e-10, abs=1e-12)


class Line:
    """A straight line through points: least squares whose answer is known in closed form."""

    def __init__(self) -> None:
        random = np.random.default_rng(3)
        self.matrix, self.wanted = random.normal(size=(40, 3)), random.normal(size=40)

    def cost(self, weights: NDArray[np.float64]) -> float:
        return float(np.sum((self.matrix @ weights - self.wanted) ** 2))

    def judged(self, weights: NDArray[np.float64]) -> float:
        return self.cost(weights) / 40.0

    def normal(self, weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
        residuals = self.matrix @ weights - self.wanted
        return self.cost(weights), self.matrix.T @ self.matrix, self.matrix.T @ residuals


@pytest.mark.parametrize("decay", [0.0, 3.0])
def test_a_linear_problem_ends_in_its_closed_form(decay: float) -> None:
    line = Line()
    found = minimise(line, np.full(3, 5.0), DescentSettings(decay=decay, tolerance=0.0, patience=400))
    ridge = np.linalg.solve(line.matrix.T @ line.matrix + decay * np.eye(3), line.matrix.T @ line.wanted)
    if decay == 0.0:
        assert found.weights == pytest.approx(ridge, rel=1e-7)
    else:  # the judged error has no decay in it, so what is kept lies on the way to the ridge
        assert line.judged(found.weights) <= line.judged(ridge) * (1.0 + 1e-9)


def test_a_decay_that_falls_first_bends_little_and_ends_where_the_fit_without_it_ends() -> None:
    line = Line()
    sizes: list[float] = []

    class Watched(Line):
        def judged(self, weights: NDArray[np.float64]) -> float:
            sizes.append(float(np.linalg.norm(weights)))
            return super().judged(weights)

    settings = DescentSettings(decay=0.0, first_decay=1e4, decay_falls=0.9, tolerance=0.0, patience=400)
    found = minimise(Watched(), np.full(3, 5.0), settings)
    least = np.linalg.lstsq(line.matrix, line.wanted, rcond=None)[0]
    assert found.weights == pytest.approx(least, rel=1e-5)
    assert min(sizes[:20]) < 0.05 * np.linalg.norm(least)


def test_a_network_finds_another_one_of_its_size() -> None:
    random = np.random.default_rng(4)
    teacher = random.normal(size=NETWORK.size)
    inputs = random.uniform(-1, 1, (400, 3))
    samples = Samples(inputs, NETWORK.answer(teacher, inputs))
    fit = NetworkFit(NETWORK, samples.taken(np.arange(300)), samples.taken(np.arange(300, 400)))
    best = min(
        minimise(fit, NETWORK.start(random), DescentSettings(decay=0.0, epochs=600, tolerance=0.0)).judged
        for _ in range(6)
    )
    assert best < 1e-8


def test_training_stops_when_the_judged_error_has_risen_for_long() -> None:
    fit, weights = problem(5)
    seen: list[float] = []
    settings = DescentSettings(decay=0.0, patience=7, tolerance=0.0)
    found = minimise(fit, weights, settings, lambda epoch, judged: seen.append(judged))
    best = int(np.argmin(seen))
    assert len(seen) == best + 1 + 7 == found.epochs
    assert found.judged == min(seen) == fit.judged(found.weights)


def test_an_interrupt_keeps_the_best_so_far() -> None:
    fit, weights = problem(6)
    seen: list[float] = []

    def interrupting(epoch: int, judged: float) -> None:
        seen.append(judged)
        if epoch == 4:
            raise KeyboardInterrupt

    found = minimise(fit, weights, DescentSettings(), interrupting)
    assert found.interrupted and len(seen) == 4
    assert found.judged == min([fit.judged(weights), *seen]) == fit.judged(found.weights)
