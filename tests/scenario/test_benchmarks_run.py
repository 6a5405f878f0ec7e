"""The benchmarks that need no privileges run from end to end and write every figure that is promised."""

from hilplant.benchmarks.perf import measure_and_print


def test_step_simulation_and_tick_are_measured_beside_their_limits() -> None:
    figures = measure_and_print("step,simulate,tick")
    for name in ("step_ratio_to_c", "simulate_60s_s", "tick_p50_us", "tick_p99_us", "tick_bus_p50_us"):
        value = figures[name]
        assert isinstance(value, float)
        assert value > 0.0
