"""Where populations are evaluated: on this machine's processors, or on a Dask cluster.

An executor takes a cost and sets, and returns the costs in order. All give the same bits: a set is simulated by itself.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from hilplant.arrays import Floats
from hilplant.extras import need
from hilplant.failure import Failure
from hilplant.identify.cost import Cost


class Executor(Protocol):
    """Evaluates sets [sets, parameters] by a cost."""

    def __call__(self, cost: Cost, sets: Floats) -> Floats:
        """Return the cost of each set."""


def here(cost: Cost, sets: Floats) -> Floats:
    """Evaluate on all processors of this machine; the compiled step needs no processes for that."""
    return cost(sets)


class OnDask:
    """Evaluates on a Dask cluster: the data go there once, then only sets and costs."""

    def __init__(self, client: Any) -> None:
        self._client = client
        self._sent: tuple[Cost, Any] | None = None

    def __call__(self, cost: Cost, sets: Floats) -> Floats:
        """Return the cost of each set; each worker thread takes a few at a time."""
        if self._sent is None or self._sent[0] is not cost:
            self._sent = cost, self._client.scatter(replace(cost, threads=1), broadcast=True)
        lanes = max(1, sum(self._client.nthreads().values()))
        shares = np.array_split(sets, min(len(sets), 2 * lanes))
        return np.concatenate(self._client.gather(self._client.map(_of_share, shares, cost=self._sent[1], pure=False)))

    def __enter__(self) -> "OnDask":
        """Use it for a while."""
        return self

    def __exit__(self, *_: object) -> None:
        """Leave the cluster; it goes on."""
        self._client.close()


def _of_share(sets: Floats, cost: Cost) -> Floats:
    return cost(sets)


def on_cluster(address: str) -> OnDask:
    """Connect to a Dask scheduler, such as tcp://10.0.0.5:8786; its workers need hilplant installed.

    Raises
    ------
    Failure
        When Dask is not installed or the scheduler does not answer.

    """
    need("dask")
    from distributed import Client

    try:
        client: Any = Client(address, timeout="10s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TimeoutError) as error:
        raise Failure(f"{address}: no Dask scheduler answers there ({type(error).__name__})") from error
    if not client.nthreads():
        client.close()
        raise Failure(f"{address}: the Dask scheduler has no workers")
    return OnDask(client)


def evaluator(cost: Cost, executor: Executor = here) -> Callable[[Floats], Floats]:
    """Return a cost as a search calls it."""
    return lambda sets: executor(cost, sets)
