"""What a bench becomes: the shipped ones, the rows for compiled code, the messages of both sides."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hilplant import load_bench
from hilplant.bench import Bench, check_bench
from hilplant.models.circuit import CIRCUITS
from hilplant.models.friction import coefficient
from hilplant.models.load import LOADS
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack, unpack
from hilplant.models.tables import LEFT_LIFT, RIGHT_LIFT, channels
from hilplant.resources import named, shipped
from hilplant.signals import INPUT_INDEX, INPUTS

BENCHES = sorted(path.stem for path in shipped("config", "benches").glob("*.yaml"))


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


@pytest.mark.parametrize("name", BENCHES)
def test_every_shipped_bench_loads_by_its_name(name: str) -> None:
    assert load_bench(name).name == name


def test_the_default_bench_holds_what_its_file_says(bench: Bench) -> None:
    assert bench.step_ns == 1_000_000
    assert bench.parameters.step_s == 0.001
    assert bench.parameters.motor.gear_ratio == 63.0
    load = bench.parameters.load
    assert (LOADS[int(load.model)], load.points) == ("reduced", 1.0)
    assert load.left_blade == load.right_blade == (7.615, 1.0)
    assert np.degrees(bench.parameters.park_switch[:3]).tolist() == pytest.approx([0.0, 7.0, 0.5])
    assert bench.parameters.park_switch[4:] == (0.0, 0.0)
    assert bench.interface == {"interface": "socketcan", "channel": "vcan0"}
    assert bench.safe == ((INPUT_INDEX["relay_on"], 0.0), (INPUT_INDEX["relay_fast"], 0.0))
    assert bench.input_row[INPUT_INDEX["supply_v"]] == 13.5
    assert bench.loop.reopen_ms == (100, 2000)


def test_the_default_friction_is_table_5_9_with_the_rules_that_tables_4_1_and_4_2_show(bench: Bench) -> None:
    friction = bench.parameters.load.friction
    assert friction[:4] == pytest.approx((0.3186, 0.1238, 1.996, 19.96))
    assert friction[4:11] == pytest.approx((0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3))
    assert friction.velocity_limit_mm_s == 1000.0
    peak, settled = friction.tacky_1 + friction.tacky_3, friction.dry_1 + friction.dry_3
    assert peak > friction.tacky_1 > settled > friction.wet_4, "tacky above dry above wet"


def test_the_polynomial_bench_is_the_default_one_with_another_load(bench: Bench) -> None:
    other = load_bench("polynomial")
    assert other.parameters.load[:3] == (1.0, 0.0035, 0.2738)
    assert other.parameters.motor == bench.parameters.motor
    assert other.tables[:, :2].tolist() == bench.tables[:, :2].tolist()


@pytest.mark.parametrize("points", [1, 5])
def test_rows_and_tables_are_what_compiled_code_takes(tmp_path: Path, points: int) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{load: {{model: reduced, points: {points}}}}}\n")
    bench = load_bench(path)
    parameters, state = pack(unpack(Parameters, bench.parameter_row)), pack(unpack(State, bench.state_row))
    assert (len(bench.parameter_row), len(bench.state_row)) == (len(parameters), len(state))
    assert parameters.tolist() == pack(bench.parameters).tolist()
    for row in (bench.parameter_row, bench.state_row, bench.input_row):
        assert row.dtype == np.float64
        assert row.ndim == 1
    assert bench.input_row.shape == (len(INPUTS),)
    assert bench.tables.dtype == np.float64
    assert bench.tables.flags.c_contiguous
    assert bench.tables.shape == (bench.tables.shape[0], channels(points), 2)
    assert bench.tables[0].tolist() == bench.tables[-1].tolist()


def test_what_the_files_say_reaches_the_records(tmp_path: Path) -> None:
    motor = shipped("config", "motors", "table_5_9.yaml").read_text()
    (tmp_path / "motor.yaml").write_text(motor + "gear_efficiency: 0.6\ngear_back_efficiency: 0.1\n")
    path = tmp_path / "bench.yaml"
    path.write_text(
        """
extends: default.yaml
name: x
plant:
  motor: motor.yaml
  screen: screens/table_4_2_friction_5.yaml
  blades:
    left: {force_n: 8, wear: 1.5, area_m2: 0.05, drag: 0.2, lift: [[90, 0.01], [135, 0.05], [200, 0.02]]}
    right: {force_n: 6}
  park_switch: {park_angle_deg: 0, window_deg: 10, circuit: depressed, reverse_angle_deg: 20}
inputs: {screen: tacky, left_screen: wet, right_screen: 0.25, right_wear: 3}
"""
    )
    bench = load_bench(path)
    load, motor_record = bench.parameters.load, bench.parameters.motor
    assert (motor_record.gear_efficiency, motor_record.gear_back_efficiency) == (0.6, 0.1)
    assert (load.left_blade, load.right_blade) == ((8.0, 1.5), (6.0, 1.0))
    assert load.friction.wet_7 == 0.05
    assert CIRCUITS[int(bench.parameters.park_switch.circuit)] == "depressed"
    assert np.degrees(bench.parameters.park_switch.reverse_angle_rad) == pytest.approx(20.0)
    inputs = {name: bench.input_row[index] for name, index in INPUT_INDEX.items()}
    assert [inputs[name] for name in ("screen", "left_screen", "right_screen", "right_wear")] == [0.5, 1.0, 0.25, 3.0]
    lift = bench.tables[:, LEFT_LIFT, 0]
    half_rho_area = 0.5 * 1.225 * 0.05
    assert lift.max() == pytest.approx(0.05 * half_rho_area, rel=1e-3), "the left arm passes 135 deg"
    assert not bench.tables[:, RIGHT_LIFT].any(), "no area, no lift"


@pytest.mark.parametrize("screen", sorted(path.stem for path in shipped("config", "screens").glob("*.yaml")))
def test_every_shipped_screen_keeps_the_rules_of_its_source_and_is_tackiest_with_little_water(
    tmp_path: Path, screen: str
) -> None:
    """mu_dry_4, mu_wet_2, mu_wet_5 are ten times another one; tacky friction is above dry at every speed."""
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{screen: screens/{screen}.yaml}}\n")
    friction = load_bench(path).parameters.load.friction
    ruled = (friction.dry_4, friction.wet_2, friction.wet_5)
    assert ruled == pytest.approx((10 * friction.dry_3, 10 * friction.wet_1, 10 * friction.wet_4))
    for speed_mm_s in (0.1, 1.0, 10.0, 100.0, 1000.0, 3000.0):
        dry, tacky = (coefficient(speed_mm_s, wetness, 10.0, friction)[0] for wetness in (0.0, 0.5))
        assert tacky > dry > 0.0


@pytest.mark.parametrize("motor", sorted(path.stem for path in shipped("config", "motors").glob("*.yaml")))
def test_every_shipped_motor_is_sound(tmp_path: Path, motor: str) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{motor: motors/{motor}.yaml}}\n")
    assert check_bench(path) == []


@pytest.mark.parametrize("linkage", sorted(path.stem for path in shipped("config", "linkages").glob("*.yaml")))
def test_every_shipped_linkage_is_sound_with_the_whole_load(tmp_path: Path, linkage: str) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text(f"extends: default.yaml\nname: x\nplant: {{linkage: linkages/{linkage}.yaml}}\n")
    assert check_bench(path) == []


def test_a_parked_wiper_begins_with_its_contact_closed_and_another_one_does_not(tmp_path: Path) -> None:
    contacts = []
    for angle in (0.0, 0.12, 0.13, 3.0, 6.2):
        path = tmp_path / "bench.yaml"
        path.write_text(f"extends: default.yaml\nname: x\ninitial: {{crank_angle_rad: {angle}}}\n")
        contacts.append(load_bench(path).state_row[3])
    assert contacts == [1.0, 1.0, 0.0, 0.0, 1.0]


def test_the_text_of_every_file_is_kept_for_the_recording() -> None:
    sources = load_bench("virtual").sources
    names = {Path(name).name for name in sources}
    assert names == {"virtual.yaml", "default.yaml", "table_5_9.yaml", "rhd_slave_driven.yaml", "wiper.dbc"}
    assert sources[next(name for name in sources if name.endswith("virtual.yaml"))].startswith("#")


def test_an_own_interface_does_not_inherit_arguments_of_another(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: vector.yaml\nname: x\nbus:\n  interface: {interface: virtual, on: off}\n")
    assert load_bench(path).interface == {"interface": "virtual", "on": "off"}


def test_an_extending_bench_changes_one_key_of_a_section_and_keeps_the_others(tmp_path: Path) -> None:
    path = tmp_path / "bench.yaml"
    path.write_text("extends: default.yaml\nname: x\nplant: {load: {model: none}}\ninputs: {supply_v: 12}\n")
    bench = load_bench(path)
    assert bench.parameters.load.model == 0.0
    assert bench.parameters.motor == load_bench("default").parameters.motor
    assert bench.input_row[INPUT_INDEX["supply_v"]] == 12.0


def test_a_name_is_a_path_first_and_a_shipped_file_otherwise(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert named("benches", "default") == shipped("config", "benches", "default.yaml")
    assert named("benches", "default.yaml") == shipped("config", "benches", "default.yaml")
    (tmp_path / "default").write_text("")
    assert named("benches", "default") == Path("default")


def test_importing_the_package_loads_neither_compiler_nor_database_reader() -> None:
    code = "import sys, hilplant; print([m for m in ('numba', 'numpy', 'cantools', 'pydantic') if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"
