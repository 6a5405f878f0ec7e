"""The benchmarks that need no privileges run from end to end and write every figure that is promised."""

import pytest

from hilplant.cli.actions.perf import measure_and_print
from hilplant.perf import batch_cost, simulate_cost, step_cost


def test_step_simulation_batch_and_tick_are_measured_beside_their_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few rounds and sets: what is said is tested, not how fast this machine is."""
    monkeypatch.setattr(batch_cost, "SETS", 100)
    for part in (batch_cost, simulate_cost, step_cost):
        monkeypatch.setattr(part, "_ROUNDS", 2)
    figures = measure_and_print("step,simulate,batch,tick")
    promised = (
        "step_ratio_to_c", "step_reduced_ratio_to_c", "step_polynomial_ratio_to_c", "simulate_60s_s",
        "simulate_60s_polynomial_s", "batch_steps_per_s", "batch_ratio_to_c", "tick_p50_us", "tick_p99_us",
        "tick_bus_p50_us",
    )  # fmt: skip
    for name in promised:
        value = figures[name]
        assert isinstance(value, float)
        assert value > 0.0
