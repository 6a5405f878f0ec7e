"""Random scenarios find no tick in which the network is active and beyond its bound; a corrupted network is found."""

from dataclasses import replace

from hilplant.bench import load_bench
from hilplant.bench.load_files import TorqueFile
from hilplant.models.row import pack
from hilplant.train.torque_search import Range, TorqueDifferences, search


def searched(scenarios: int, corrupted: float = 0.0) -> TorqueDifferences:
    bench = load_bench("network")
    file = bench.plant.load_file
    assert isinstance(file, TorqueFile)
    numbers = bench.parameters.networks.copy()
    numbers[5] += corrupted
    parameters = bench.parameters._replace(networks=numbers)
    bench = replace(bench, parameters=parameters, parameter_row=pack(parameters))
    return search(bench, (file.bounds.dry_n_m, file.bounds.wet_n_m), Range(scenarios, 5.0, seed=7))


def test_no_scenario_leaves_the_network_in_charge_beyond_its_bound() -> None:
    found = searched(60)
    assert found.beyond_bound == 0 and found.excess <= 1.0
    assert found.ticks_in_charge > 80_000 and found.hand_overs > 100
    assert 0.0 < found.mean_n_m < found.rms_n_m < found.worst_n_m
    assert found.current_rms_a < 0.03 * found.current_range_a


def test_the_search_finds_a_network_that_is_off_by_half_a_newton_metre() -> None:
    found = searched(20, corrupted=0.5)
    assert found.beyond_bound > 0 and found.excess > 1.0 and len(found.where) == 5
