"""Compile what most tests call, once and before them: each of their processes would else compile it anew.

::

    python tests/compile_first.py
"""

from contextlib import closing

import numpy as np

from hilplant.bench import load_bench
from hilplant.bus.transport import open_transport
from hilplant.runtime.clock import VirtualClock
from hilplant.runtime.server import build_loop
from hilplant.signals import OUTPUTS
from hilplant.simulation.batch import simulate_batch
from hilplant.simulation.run import simulate


def main() -> None:
    """Take one step in the loop, in a simulation and in a batch."""
    bench = load_bench("virtual")
    with closing(open_transport(bench.interface)) as transport:
        build_loop(bench, transport, VirtualClock()).tick(0)
    simulate(bench, "slow_fast_park")
    states, parameters = bench.state_row[np.newaxis].copy(), bench.parameter_row[np.newaxis]
    simulate_batch(states, bench.input_row[np.newaxis], parameters, bench.tables, [OUTPUTS[0].name])


if __name__ == "__main__":
    main()
