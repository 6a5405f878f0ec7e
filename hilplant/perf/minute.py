"""What is run to measure the step: a minute of a wiper's life, and the default bench with each load."""

from dataclasses import replace

from hilplant.bench import Bench, load_bench
from hilplant.models.load import LOADS
from hilplant.models.polynomial import C1, C2
from hilplant.models.row import pack
from hilplant.signals import INPUT_INDEX
from hilplant.simulation.entries import Entry
from hilplant.simulation.scenario import Scenario

#: At most this many times C; the same in milliseconds for 60 simulated seconds; and what the thesis needed for them:
#: its rigid-body model, and its polynomial one (section 6.3).
RATIO_GOALS = {"reduced": 1.2, "polynomial": 1.15}
MINUTE_GOALS_MS = {"reduced": 30.0, "polynomial": 10.0}
THESIS_S = {"reduced": 86.0, "polynomial": 4.0}

_SIGNALS = {
    "relay_on": ((1.0, 1.0), (26.0, 0.0), (30.0, 1.0), (44.0, 0.0), (46.0, 1.0), (58.0, 0.0)),
    "relay_fast": ((14.0, 1.0), (26.0, 0.0), (34.0, 1.0), (44.0, 0.0)),
    "supply_v": ((8.0, 9.0, 0.5), (10.0, 13.5, 0.5)),
    "screen": ((0.0, 0.0), (12.0, 1.0, 8.0), (38.0, 0.5), (42.0, 1.0)),
    "vehicle_speed_m_s": ((20.0, 30.0, 5.0), (48.0, 0.0, 4.0)),
}


def mixed_minute() -> Scenario:
    """Return 60 s: at rest, slow, a brown-out, fast, off, and again; a screen dry, wetted, tacky and wet; wind."""
    entries = {name: tuple(Entry(*entry) for entry in row) for name, row in _SIGNALS.items()}
    return Scenario(60.0, {}, {INPUT_INDEX[name]: row for name, row in entries.items()})


def bench_with(load: str) -> Bench:
    """Return the default bench with the load of that name, the polynomial as the thesis gives it."""
    bench = load_bench("default")
    carried = bench.parameters.load._replace(model=float(LOADS.index(load)), c1=C1, c2=C2)
    parameters = bench.parameters._replace(load=carried)
    return replace(bench, parameters=parameters, parameter_row=pack(parameters))
