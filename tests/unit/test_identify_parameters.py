"""Parameters by name: in the right places of the row, linked as in Tables 4-1 and 4-2, with the space of (5.22)."""

import numpy as np
import pytest

from hilplant.bench import load_bench
from hilplant.declaration import declared
from hilplant.failure import Failure
from hilplant.identify.parameters import SEVENTEEN, chosen, search_space
from hilplant.models.records import PARAMETER_INDEX, STATE_INDEX, Parameters, State
from hilplant.models.row import unpack


@pytest.fixture(scope="module")
def bench():
    return load_bench("default")


def test_places_are_those_of_the_packed_row(bench):
    """Every element that has a name in the record is found at its place in the row, however the record is nested."""
    for name, place in PARAMETER_INDEX.items():
        record = bench.parameters
        for part in name.split("."):
            record = getattr(record, part)
        assert bench.parameter_row[place] == record, name
    assert list(STATE_INDEX) == [signal.name for signal in declared(State)]


def test_the_seventeen_have_the_values_of_table_5_9(bench):
    choice = chosen(bench.parameter_row)
    assert len(choice) == len(SEVENTEEN) == 17
    expected = [1.237, 1.026, 3.148e-3, 2.571e-3, 4.579e-2, 3.412e-2, 1.582e-4, 1.983e-5]
    expected += [0.3186, 0.1238, 1.996, 0.4454, 7.578e-3, 0.6756, 2.795e-4, 3.456e-3, 7.615]
    assert choice.values.tolist() == expected


def test_linked_coefficients_follow_and_nothing_else_moves(bench):
    choice = chosen(bench.parameter_row)
    moved = choice.values * 1.5
    friction = unpack(Parameters, choice.rows(moved[np.newaxis])[0]).load
    assert friction.friction.dry_4 == pytest.approx(10.0 * 1.5 * 1.996)
    assert friction.friction.wet_2 == pytest.approx(10.0 * 1.5 * 0.4454)
    assert friction.friction.wet_5 == pytest.approx(10.0 * 1.5 * 0.6756)
    assert friction.left_blade.force_n == friction.right_blade.force_n == pytest.approx(1.5 * 7.615)
    same = choice.rows(choice.values[np.newaxis])[0]
    assert np.allclose(same, bench.parameter_row, rtol=1e-15)


def test_a_linked_coefficient_that_is_looked_for_itself_is_not_moved_by_the_other(bench):
    choice = chosen(bench.parameter_row, extra=["mu_dry_4"])
    values = choice.values
    values[choice.names.index("mu_dry_3")] *= 2.0
    row = choice.rows(values[np.newaxis])[0]
    assert unpack(Parameters, row).load.friction.dry_4 == bench.parameters.load.friction.dry_4


def test_held_parameters_are_not_looked_for(bench):
    assert "force_n" not in chosen(bench.parameter_row, held=["force_n"]).names
    with pytest.raises(Failure, match="no parameter 'forse'; known: slow_resistance_ohm"):
        chosen(bench.parameter_row, held=["forse"])


def test_the_search_space_is_that_of_5_22(bench):
    """Half to twice, for inductances a quarter to four times; a signed one may change its sign; 0 means unknown."""
    choice = chosen(bench.parameter_row, extra=["coulomb_torque_n_m", "gear_efficiency"])
    low, high = search_space(choice, choice.values)
    at = {name: (low[place], high[place]) for place, name in enumerate(choice.names)}
    assert at["slow_resistance_ohm"] == pytest.approx((0.5 * 1.237, 2.0 * 1.237))
    assert at["slow_inductance_henry"] == pytest.approx((0.25 * 3.148e-3, 4.0 * 3.148e-3))
    assert at["coulomb_torque_n_m"] == (0.0, 0.08)
    assert at["gear_efficiency"] == (0.5, 1.0)
    assert at["mu_wet_7"][0] == -at["mu_wet_7"][1] < 0.0
