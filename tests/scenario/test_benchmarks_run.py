"""The benchmarks that need no privileges run from end to end and write every figure that is promised."""

from hilplant.cli.actions.perf import measure_and_print


def test_step_simulation_batch_and_tick_are_measured_beside_their_limits() -> None:
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
