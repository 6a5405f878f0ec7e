"""The shipped motor of a production car turns as service manuals demand at 12 V without load, and wipes."""

import numpy as np
import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.models.load import LOADS
from hilplant.models.row import pack
from hilplant.signals import OUTPUT_INDEX, Inputs
from hilplant.thesis.solver import run_step
from hilplant.units import TURN_RAD

BENCH = load_bench("production_car")
#: Speeds [rev/min] that three manuals allow: Suzuki Esteem 2002, Aerio 2006, SX4 2012; slow, then fast.
MANUALS = {"esteem": ((47, 57), (70, 84)), "aerio": ((44, 52), (64, 78)), "sx4": ((41, 49), (63, 77))}


def rev_per_minute(model: str, supply_v: float, relay_fast: float, screen: float = 1.0) -> float:
    """Return the mean speed of the crank over the last whole turns of four seconds."""
    parameters = BENCH.parameters._replace(load=BENCH.parameters.load._replace(model=float(LOADS.index(model))))
    row = pack(Inputs(relay_on=1.0, relay_fast=relay_fast, supply_v=supply_v, screen=screen))
    outputs = run_step(parameters, BENCH.tables, np.tile(row, (6000, 1)))
    turned = np.unwrap(outputs[2000:, OUTPUT_INDEX["crank_angle_rad"]])
    whole = int(np.searchsorted(turned, turned[0] + TURN_RAD * ((turned[-1] - turned[0]) // TURN_RAD)))
    return float((turned[whole] - turned[0]) / TURN_RAD / whole * 60_000.0)


def test_check_finds_nothing_wrong() -> None:
    assert check_bench("production_car") == []
    assert BENCH.warnings == ()


@pytest.mark.parametrize("relay_fast", [0.0, 1.0])
def test_the_speed_without_load_is_within_every_manual_s_range(relay_fast: float) -> None:
    speed = rev_per_minute("none", 12.0, relay_fast)
    for car, ranges in MANUALS.items():
        low, high = ranges[int(relay_fast)]
        assert low <= speed <= high, f"{car}: {speed:.2f} rev/min"
    motor = BENCH.parameters.motor
    brush = motor.fast if relay_fast else motor.slow
    k, ohm = brush.constant_v_s, brush.resistance_ohm
    shaft = (12.0 * k - ohm * motor.coulomb_torque_n_m) / (ohm * motor.damping_n_m_s + k * k)
    assert speed == pytest.approx(shaft / motor.gear_ratio * 60.0 / TURN_RAD, rel=1e-4)


def test_it_wipes_a_wet_screen_at_the_rates_of_cars() -> None:
    slow, fast = (rev_per_minute("reduced", 13.5, relay) for relay in (0.0, 1.0))
    assert 40.0 < slow < 60.0 < fast < 90.0
