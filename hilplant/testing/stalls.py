"""A warm motor that is stalled, in virtual time: with the simulated ECU as shipped, and blind to warm stalls."""

from dataclasses import replace

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.plots.stall import Stall
from hilplant.simulation.scenario import load_scenario
from hilplant.testing.known_signals import database_signals, protections_of
from hilplant.testing.virtual_bench import VirtualBench
from hilplant.units import SECOND_NS

SCENARIO, BENCH = "warm_stall", "warm_motor"
#: An ECU that takes only the current of a cold stall as one.
_BLIND = f"extends: {BENCH}.yaml\nname: blind\necu: {{warm_stall_current_a: 100}}\n"
_SIGNALS = ("current_a", "winding_temperature_c", "thermal_switch", "crank_speed_rad_s", "EcuState", "EcuFault")


def stalls() -> list[Stall]:
    """Return 40 s with the ECU as shipped, and the whole scenario with one that is blind to warm stalls."""
    titles = ("as shipped: 5.5 A for 4 s is a stall", "without it: driven until the turn takes too long")
    return [_run(BENCH, titles[0], 40.0), _run(_BLIND, titles[1], None)]


def _run(bench_name: str, title: str, seconds: float | None) -> Stall:
    bench, scenario = load_bench(bench_name), load_scenario(SCENARIO)
    if seconds is not None:
        scenario = replace(scenario, seconds=seconds)
    virtual = VirtualBench(bench, scenario)
    virtual.run_scenario()
    evidence, database = virtual.evidence(), database_signals(bench.sources, protections_of(bench))
    signals: dict[str, Floats] = {name: evidence.signal(name, database) for name in _SIGNALS}
    heat, ecu = bench.parameters.heat, bench.ecu
    levels = (ecu.stall_current_a, ecu.warm_stall_current_a), (heat.trip_c, heat.reset_c)
    return Stall(title, bench.step_ns / SECOND_NS, signals, *levels)
