"""A network of one layer of tanh neurons with linear outputs, and what a least-squares fit of it needs.

The weights are one row: for each neuron its input weights and its bias, then for each output its weights of the
neurons and its bias. The Jacobian is analytic. An output depends only on its own row of output weights, so J'J is put
together from one block for each output.
"""

from dataclasses import dataclass

import numpy as np

from hilplant.arrays import Floats, Whole


@dataclass(frozen=True, slots=True)
class Samples:
    """Inputs [m, inputs] and targets [m, outputs], both scaled."""

    inputs: Floats
    targets: Floats

    def taken(self, rows: Whole) -> "Samples":
        """Return some of them."""
        return Samples(self.inputs[rows], self.targets[rows])


@dataclass(frozen=True, slots=True)
class TanhNetwork:
    """How many inputs, neurons and outputs there are."""

    inputs: int
    neurons: int
    outputs: int

    @property
    def size(self) -> int:
        """Number of all weights."""
        return self.neurons * (self.inputs + 1) + self.outputs * (self.neurons + 1)

    def parts(self, weights: Floats) -> tuple[Floats, Floats]:
        """Return hidden weights [neurons, inputs + 1] and output weights [outputs, neurons + 1], biases last."""
        border = self.neurons * (self.inputs + 1)
        hidden = weights[:border].reshape(self.neurons, self.inputs + 1)
        return hidden, weights[border:].reshape(self.outputs, self.neurons + 1)

    def answer(self, weights: Floats, inputs: Floats) -> Floats:
        """Return the outputs [m, outputs]."""
        output = self.parts(weights)[1]
        return self.bent(weights, inputs) @ output[:, :-1].T + output[:, -1]

    def bent(self, weights: Floats, inputs: Floats) -> Floats:
        """Return what the neurons give [m, neurons]."""
        hidden = self.parts(weights)[0]
        bent: Floats = np.tanh(inputs @ hidden[:, :-1].T + hidden[:, -1])
        return bent

    def start(self, random: np.random.Generator) -> Floats:
        """Return weights to begin with, after Nguyen and Widrow: the neurons' bends lie spread over the inputs."""
        length = 0.7 * self.neurons ** (1.0 / self.inputs)
        hidden = random.normal(size=(self.neurons, self.inputs))
        hidden *= length / np.linalg.norm(hidden, axis=1, keepdims=True)
        biases = length * np.linspace(-1.0, 1.0, self.neurons) * np.sign(hidden[:, 0])
        output = random.uniform(-0.5, 0.5, self.outputs * (self.neurons + 1))
        return np.concatenate([np.column_stack([hidden, biases]).ravel(), output])

    def jacobian(self, weights: Floats, inputs: Floats, output: int) -> Floats:
        """Return the derivatives [m, size] of one output by all weights."""
        whole = np.zeros((len(inputs), self.size))
        columns = self.columns(output)
        whole[:, columns] = self.own_jacobian(weights, inputs, output)
        return whole

    def columns(self, output: int) -> Whole:
        """Return the places of the weights that an output depends on."""
        border = self.neurons * (self.inputs + 1)
        first = border + output * (self.neurons + 1)
        return np.concatenate([np.arange(border), np.arange(first, first + self.neurons + 1)])

    def own_jacobian(self, weights: Floats, inputs: Floats, output: int) -> Floats:
        """Return the derivatives of one output by the weights that it depends on."""
        bent, strengths = self.bent(weights, inputs), self.parts(weights)[1][output, :-1]
        ones = np.ones((len(inputs), 1))
        slopes = (1.0 - bent * bent) * strengths
        hidden = slopes[:, :, np.newaxis] * np.column_stack([inputs, ones])[:, np.newaxis, :]
        return np.column_stack([hidden.reshape(len(inputs), -1), bent, ones])


@dataclass(frozen=True, slots=True)
class NetworkFit:
    """A network with the samples that it is fitted to, and those by which it is judged."""

    network: TanhNetwork
    training: Samples
    judging: Samples

    def cost(self, weights: Floats) -> float:
        """Return the sum of the squared residuals."""
        return float(np.sum(self._residuals(weights, self.training) ** 2))

    def judged(self, weights: Floats) -> float:
        """Return the mean squared error on the samples kept back."""
        return float(np.mean(self._residuals(weights, self.judging) ** 2))

    def normal(self, weights: Floats) -> tuple[float, Floats, Floats]:
        """Return the sum of the squared residuals, J'J and J'r."""
        network, residuals = self.network, self._residuals(weights, self.training)
        hessian, gradient = np.zeros((network.size, network.size)), np.zeros(network.size)
        for output in range(network.outputs):
            columns = network.columns(output)
            jacobian = network.own_jacobian(weights, self.training.inputs, output)
            hessian[np.ix_(columns, columns)] += jacobian.T @ jacobian
            gradient[columns] += jacobian.T @ residuals[:, output]
        return float(np.sum(residuals**2)), hessian, gradient

    def _residuals(self, weights: Floats, samples: Samples) -> Floats:
        return self.network.answer(weights, samples.inputs) - samples.targets
