"""What a bench adds to an ideal plant: supply, wires, relays and heat, and that nothing is altered where nothing is."""

import numpy as np
import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.models.mechanical_records import LinkageCondition, Obstacles, SideObstacles
from hilplant.models.plant import simulate_rows
from hilplant.models.records import STATE_INDEX, Parameters, Relays, RelayTiming, Wiring
from hilplant.models.slow_records import Heat, Water, Wear
from hilplant.signals import ACTIVE_MODELS, INPUT_INDEX, OUTPUT_INDEX, OUTPUTS

HEAD = "extends: default.yaml\nname: x\n"
HEAT = "winding_j_k: 150, case_j_k: 450, winding_to_case_w_k: 0.6, case_to_ambient_w_k: 0.4"


def built(plant: str) -> Parameters:
    return load_bench(f"{HEAD}plant: {plant}\n").parameters


def test_an_ideal_plant_is_not_altered() -> None:
    ideal = "supply: {resistance_ohm: 0}, wires: {}, relays: {relay_on: {bounce_ms: 0}}, obstacles: {slip_deg: 3}"
    ideal += ", backlash: {angle_deg: 0}"
    for plant in ("{}", f"{{{ideal}}}"):
        parameters = built(plant)
        assert (parameters.wiring, parameters.relays, parameters.heat) == (Wiring(), Relays(), Heat())
        assert (parameters.obstacles, parameters.linkage) == (Obstacles(), LinkageCondition())
        assert (parameters.wear, parameters.water) == (Wear(), Water())


def test_play_and_wear_are_told_by_crank_angle_and_by_a_thousand_wipes() -> None:
    parameters = built("{backlash: {angle_deg: 2}, wear: {blades_percent: 5, brushes_ohm: 0.01, cam_deg: 0.2}}")
    assert parameters.linkage == pytest.approx(LinkageCondition(1.0, 0.0, 0.0, np.radians(2.0)))
    assert parameters.wear == pytest.approx(Wear(1.0, 5e-5, 1e-5, np.radians(2e-4), 0.0))


def test_obstacles_stand_at_their_side_and_end_in_radians() -> None:
    end = "{angle_deg: 90, stiffness_n_m_rad: 40}"
    made = built(f"{{obstacles: {{left: {{above: {end}}}, right: {{below: {end}, rebound: 1, frozen_n_m: 12}}, "
                 "slip_deg: 3, jam: {angle_deg: 180, width_deg: 20, torque_n_m: 50}}}").obstacles  # fmt: skip
    assert made.left == pytest.approx(SideObstacles(0.0, 0.0, np.pi / 2.0, 40.0, 0.0, 0.0))
    assert made.right == pytest.approx(SideObstacles(np.pi / 2.0, 40.0, 0.0, 0.0, 1.0, 12.0))
    jammed = (made.altered, made.slip_rad, made.jam_rad, made.jam_half_rad, made.jam_n_m)
    assert jammed == pytest.approx((1.0, np.radians(3.0), np.pi, np.radians(10.0), 50.0))


@pytest.mark.parametrize("terminal", ["53", "53b", "53e", "31"])
def test_the_resistance_of_each_wire_stands_at_its_terminal(terminal: str) -> None:
    wiring = built(f"{{supply: {{resistance_ohm: 0.15}}, wires: {{terminal_{terminal}_ohm: 0.25}}}}").wiring
    assert (wiring.altered, wiring.supply_resistance_ohm) == (1.0, 0.15)
    found = {name: getattr(wiring, f"wire_{name}").resistance_ohm for name in ("53", "53b", "53e", "31")}
    assert found == {name: 0.25 if name == terminal else 0.0 for name in found}


def test_times_of_relays_are_rounded_to_ticks() -> None:
    relays = built("{relays: {relay_fast: {operate_ms: 4.6, release_ms: 2.4, transfer_ms: 1, bounce_ms: 3}}}").relays
    assert relays == Relays(1.0, RelayTiming(), RelayTiming(5.0, 2.0, 1.0, 3.0))


def test_heat_begins_at_its_temperature_and_a_motor_that_begins_too_hot_begins_tripped() -> None:
    bench = load_bench(f"{HEAD}plant: {{heat: {{{HEAT}, start_c: 160, trip_c: 150, reset_c: 110}}}}\n")
    heat = bench.parameters.heat
    assert (heat.altered, heat.has_switch, heat.trip_c, heat.reset_c) == (1.0, 1.0, 150.0, 110.0)
    assert (heat.resistance_per_k, heat.constant_per_k) == pytest.approx((0.0039, -0.002))
    start = [bench.state_row[STATE_INDEX[f"heat.{name}"]] for name in ("winding_c", "case_c", "opened")]
    assert start == [160.0, 160.0, 1.0]


def test_a_motor_network_that_was_trained_cold_does_not_move_a_motor_with_heat() -> None:
    modes = []
    for heat in ("", f"plant: {{heat: {{{HEAT}}}}}\n"):
        bench = load_bench(f"extends: networks.yaml\nname: x\n{heat}")
        row, inputs = bench.state_row.copy(), np.tile(bench.input_row, (1000, 1))
        inputs[:, INPUT_INDEX["relay_on"]], inputs[:, INPUT_INDEX["screen"]] = 1.0, 1.0
        outputs = np.empty((len(inputs), len(OUTPUTS)))
        simulate_rows(row, inputs, bench.parameter_row, bench.tables, outputs)
        modes.append({ACTIVE_MODELS[int(mode)] for mode in outputs[:, OUTPUT_INDEX["motor_mode"]]})
    cold, warm = modes
    assert "network" in cold and "network" not in warm and "outside" in warm


@pytest.mark.parametrize(
    ("plant", "said"),
    [
        ("supply: {resistance_ohm: -1}", "resistance_ohm"),
        ("wires: {terminal_30_ohm: 1}", "unknown key 'terminal_30_ohm'"),
        ("relays: {relay_on: {operate_ms: -3}}", "operate_ms"),
        (f"heat: {{{HEAT}, trip_c: 150}}", "trip_c and reset_c are given together"),
        (f"heat: {{{HEAT}, trip_c: 110, reset_c: 150}}", "reset_c must be below trip_c, 110"),
        ("heat: {winding_j_k: 150}", "case_j_k"),
        ("backlash: {angle_deg: 40}", "angle_deg"),
        ("wear: {blades: 3}", "unknown key 'blades'"),
        ("water: {washer_mm_s: 1}", "runoff_percent_s"),
        ("obstacles: {left: {above: {angle_deg: 90}}}", "stiffness_n_m_rad"),
        ("obstacles: {right: {rebound: 2}}", "rebound"),
        ("obstacles: {jam: {angle_deg: 400}}", "angle_deg"),
    ],
)
def test_what_cannot_be_is_refused_at_its_line(plant: str, said: str) -> None:
    problems = check_bench(f"{HEAD}plant: {{{plant}}}\n")
    assert problems and any(said in problem.text for problem in problems) and all(p.line == 3 for p in problems)
