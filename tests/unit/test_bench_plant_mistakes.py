"""What is said about single mistakes in the plant of a bench: linkage, blades, load, screen, gear, park switch."""

from pathlib import Path

import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.resources import shipped

LINKAGE = shipped("config", "linkages", "rhd_slave_driven.yaml").read_text()
SCREEN = shipped("config", "screens", "table_5_9.yaml").read_text()


def mistakes(folder: Path, text: str) -> list[str]:
    """Return the problems of a bench that differs from the default one by `text`, as "file:line: text"."""
    bench = folder / "bench.yaml"
    bench.write_text("extends: default.yaml\nname: test\n" + text)
    return [f"{Path(problem.file).name}:{problem.line}: {problem.text}" for problem in check_bench(bench)]


def the_mistake(folder: Path, text: str) -> str:
    found = mistakes(folder, text)
    assert len(found) == 1, found
    return found[0]


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [
        ("A: [0.0445, 0.0055, 0.0]", "A: [0.2, 0.0055, 0.0]", "points_m: #"),
        ("F: [0.2030, 0.0270, 0.0]", "F: [0.2030]", "F: ["),
        ("kind: bent", "kind: straight", "    O: [0.0, 0.0, 0.0]\n    A: [-0.3000"),
        ("kind: slave_driven", "kind: centre_driven", "points_m: #"),
        ("C: [-0.6900, 0.0500, 0.0]", "C: [0.6900, 0.0500, 0.0]", "    O: [0.0, 0.0, 0.0]\n    A: [-0.5700"),
        ("kind: slave_driven", "kind: slave_drivn", "kind: slave"),
        ("kind: slave_driven", "kind: assembly", "kind: slave"),
        ("kind: slave_driven", "kind: slave_driven\ncrank: handle", "crank: handle"),
        ("masses_kg: {crank: 0.0845,", "masses_kg: {krank: 0.0845,", "masses_kg: {"),
        ("masses_kg: {crank: 0.0845,", "masses_kg: {crank: -1,", "masses_kg: {"),
        ("kind: straight\n  mass_kg: 0.5\n  assumed: [mass_kg]", "kind: straight", "left_arm:"),
        ("kind: slave_driven", "least_transmission_deg: 60\nkind: slave_driven", "points_m: #"),
        ("kind: slave_driven", "least_clearance_m: 0.25\nkind: slave_driven", "least_clearance_m"),
        (
            "left_blade:\n  mass_kg: 0.3\n  assumed: [mass_kg]",
            "left_blade:\n  assumed: [mass_kg]",
            "  assumed: [mass_kg]\n  points_m:\n    O: [0.0, 0.0, 0.0]\n    A: [0.5000",
        ),
    ],
)
def test_a_linkage_that_cannot_work_is_told_in_its_own_file(tmp_path: Path, right: str, wrong: str, line: str) -> None:
    assert LINKAGE.count(right) == 1
    own = LINKAGE.replace(right, wrong)
    (tmp_path / "own.yaml").write_text(own)
    shown = line if line in own else wrong.splitlines()[0]
    number = own[: own.index(shown)].count("\n") + 1
    number -= line.startswith("    O")  # the arm's points are one group, told at its head
    found = the_mistake(tmp_path, "plant: {linkage: own.yaml}\n")
    assert found.startswith(f"own.yaml:{number}: ")


@pytest.mark.parametrize(
    ("key", "message"),
    [
        ("screen: ~", "3: the reduced load needs screen beside it"),
        ("blades: ~", "3: the reduced load needs blades beside it"),
        ("screen: screens/no.yaml", "3: no file 'screens/no.yaml'; looked in "),
        ("load: {model: reduced, points: 0}", "3: points must be greater than or equal to 1, not 0"),
        ("load: {model: reduced, points: 1.5}", "3: points must be a whole number, not 1.5"),
        ("load: {model: reduced, c1: 1}", "3: unknown key 'c1'; known: model, points"),
        ("blades: {left: {force_n: 7}}", "3: key 'right' is missing"),
        ("blades: {left: {force_n: 7}, right: {force_n: -7}}", "3: force_n must be greater than or equal to 0, not -7"),
        ("blades: {left: {force_n: 7}, right: {force: 7}}", "3: key 'force_n' is missing"),
        (
            "blades: {left: {force_n: 7, lift: high}, right: {force_n: 7}}",
            "3: drag and lift are each a number, or a list",
        ),
        (
            "blades: {left: {force_n: 7, lift: [[0, 1, 2]]}, right: {force_n: 7}}",
            "3: drag and lift are each a number, or",
        ),
        (
            "blades: {left: {force_n: 7, area_m2: 1, lift: [[0, 1]]}, right: {force_n: 7}}",
            "3: left blade: lift must be a number or at",
        ),
        (
            "blades: {left: {force_n: 7, area_m2: 1, drag: [[9, 1], [8, 1]]}, right: {force_n: 7}}",
            "3: left blade: drag: the arm's angles must rise, but 8.0 follows 9.0 deg",
        ),
        (
            "blades: {left: {force_n: 7, area_m2: 1, lift: [[90, 1], [120, 1]]}, right: {force_n: 7}}",
            "3: left blade: lift: the table covers 90 to 120 deg, but the arm sweeps 97.1",
        ),
        (
            "blades: {left: {force_n: 7, lift: 0.05}, right: {force_n: 7}}",
            "3: lift needs area_m2 beside it, the area of the blade; without it no wind acts",
        ),
        (
            "blades: {left: {force_n: 7, assumed: [drag]}, right: {force_n: 7}}",
            "3: assumed names 'drag', which is not given beside it",
        ),
        (
            "park_switch: {park_angle_deg: 0, window_deg: 9, circuit: analogue}",
            "3: circuit must be 'digital', 'mechanical' or 'depressed', not 'analogue'",
        ),
        (
            "park_switch: {park_angle_deg: 0, window_deg: 9, circuit: depressed}",
            "3: the depressed circuit needs reverse_angle_deg, how far it turns back to park",
        ),
        (
            "park_switch: {park_angle_deg: 0, window_deg: 9, reverse_angle_deg: 9}",
            "3: reverse_angle_deg is for the depressed circuit, and this one is digital",
        ),
        (
            "park_switch: {park_angle_deg: 0, window_deg: 90, circuit: depressed, reverse_angle_deg: 270}",
            "3: reverse_angle_deg must leave a gap: window_deg + reverse_angle_deg must be below 360",
        ),
    ],
)
def test_a_mistake_in_the_plant_is_told_at_its_line(tmp_path: Path, key: str, message: str) -> None:
    found = mistakes(tmp_path, f"plant: {{{key}}}\n")
    assert found[0].startswith(f"bench.yaml:{message}")
    assert len(found) == (2 if "force:" in key else 1)


@pytest.mark.parametrize(
    ("right", "wrong", "message"),
    [
        ("angle_rad: -0.57", "angle_rad: -2", "angle_rad must be greater than or equal to -1.5708, not -2"),
        ("  mu_dry_1: 0.3186", "  mu_dry_1: -1", "mu_dry_1 must be greater than or equal to 0, not -1"),
        ("  mu_dry_1: 0.3186", "  mu_1: 1", "unknown key 'mu_1', did you mean 'mu_dry_1'?"),
        ("  mu_tacky_4: 0.01", "  mu_tacky_4: 20", "mu_tacky_4, the rate of the fall, must not be above"),
        ("velocity_limit_mm_s: 1000", "velocity_limit_mm_s: 0", "velocity_limit_mm_s must be greater than 0, not 0"),
    ],
)
def test_a_mistake_in_a_screen_is_told_in_its_own_file(tmp_path: Path, right: str, wrong: str, message: str) -> None:
    assert SCREEN.count(right) == 1
    (tmp_path / "own.yaml").write_text(SCREEN.replace(right, wrong))
    number = SCREEN[: SCREEN.index(right)].count("\n") + 1
    assert f"own.yaml:{number}: {message}" in "\n".join(mistakes(tmp_path, "plant: {screen: own.yaml}\n"))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("gear_efficiency: 1.2", "gear_efficiency must be less than or equal to 1, not 1.2"),
        ("gear_efficiency: 0", "gear_efficiency must be greater than 0, not 0"),
        ("gear_back_efficiency: -0.1", "gear_back_efficiency must be greater than or equal to 0, not -0.1"),
    ],
)
def test_a_gear_that_would_give_energy_is_told_in_its_own_file(tmp_path: Path, line: str, message: str) -> None:
    motor = shipped("config", "motors", "table_5_9.yaml").read_text()
    (tmp_path / "own.yaml").write_text(motor + line + "\n")
    number = motor.count("\n") + 1
    assert the_mistake(tmp_path, "plant: {motor: own.yaml}\n") == f"own.yaml:{number}: {message}"


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("A: [0.0445, 0.0055, 0.0]", "A: [44.5, 5.5, 0.0]"),
        ("A: [-0.5700, 0.0100, 0.0]", "A: [-570, 10, 0.0]"),
        ("A: [0.5000, -0.0300, 0.0]", "A: [500, -30, 0.0]"),
    ],
)
def test_points_in_millimetres_are_told_at_their_line(tmp_path: Path, right: str, wrong: str) -> None:
    """A linkage a thousand times too large closes as well; only its size gives it away."""
    (tmp_path / "own.yaml").write_text(LINKAGE.replace(right, wrong, 1))
    number = LINKAGE[: LINKAGE.index(right)].count("\n") + 1
    found = the_mistake(tmp_path, "plant: {linkage: own.yaml}\n")
    assert found.startswith(f"own.yaml:{number}: A is ")
    assert found.endswith("points are in metres, not in millimetres")


def test_coefficients_that_follow_a_rule_of_the_source_may_be_left_out(tmp_path: Path) -> None:
    ruled = ("mu_dry_4", "mu_wet_2", "mu_wet_5")
    lines = [line for line in SCREEN.splitlines() if not line.strip().startswith(ruled)]
    assert len(lines) == len(SCREEN.splitlines()) - 3
    (tmp_path / "own.yaml").write_text("\n".join(lines))
    bench = tmp_path / "bench.yaml"
    bench.write_text("extends: default.yaml\nname: test\nplant: {screen: own.yaml}\n")
    ruled_friction, written = load_bench(bench).parameters.load.friction, load_bench().parameters.load.friction
    assert ruled_friction == pytest.approx(written)
