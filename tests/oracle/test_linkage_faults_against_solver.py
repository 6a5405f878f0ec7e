"""A lost arm, a broken link and play, against adaptive solvers that know another wiper, or two bodies with a spring."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.integrate import solve_ivp
from support.closed_form import ClosedFormWiper

from hilplant.arrays import Floats
from hilplant.bench import load_bench
from hilplant.models.mechanical_records import LinkageCondition
from hilplant.models.records import Arm, Blade, Brush, Friction, Load, Motor, Parameters, ParkSwitch, State
from hilplant.resources import shipped
from hilplant.signals import OUTPUT_INDEX
from hilplant.thesis.reference import Reference
from hilplant.thesis.solver import SCENARIOS, WET, Rows, errors_percent, run_step

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.045, 63.0)
FRICTION = Friction(
    0.3186, 0.1238, 1.996, 19.96, 0.4454, 4.454, 7.578e-3, 0.6756, 6.756, 2.795e-4, 3.456e-3, 2.4, 0.5, 0.6, 0.02
)
WIPER = ClosedFormWiper()


def plant(
    condition: LinkageCondition, forces: tuple[float, float] = (7.615, 7.615), motor: Motor = MOTOR
) -> Parameters:
    load = Load(2.0, friction=FRICTION, left_blade=Blade(forces[0], 1.0), right_blade=Blade(forces[1], 1.0))
    switch = ParkSwitch(0.0, 0.1, 0.02, 3.0)
    return Parameters(1e-3, motor, switch, load, Arm(0.3, 0.69), Arm(-0.4, 0.54), linkage=condition)


def shown(outputs: Floats, name: str) -> Floats:
    return outputs[:, OUTPUT_INDEX[name]]


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("broken", [1.0, 2.0])
@pytest.mark.parametrize("scenario", ["start and run", "park", "wind"])
def test_what_is_left_is_a_wiper_with_one_arm(side: str, broken: float, scenario: str) -> None:
    rows, lost = SCENARIOS[scenario](), LinkageCondition(1.0, **{side: broken})
    outputs = run_step(plant(lost), WIPER.tables(), rows)
    gone = replace(getattr(WIPER, side), inertia_kg_m2=0.0, weight_n_m=0.0, drag_m2=0.0)
    forces = (0.0, 7.615) if side == "left" else (7.615, 0.0)
    truth = Reference(plant(LinkageCondition(), forces), replace(WIPER, **{side: gone}).channels).run(rows)
    assert max(errors_percent(outputs, truth)) < 0.05
    assert max(errors_percent(run_step(plant(LinkageCondition()), WIPER.tables(), rows), truth)) > 1.0
    assert (shown(outputs, f"{side}_force_n") == 0.0).all()
    assert bool(np.ptp(shown(outputs, f"{side}_arm_rad")) == 0.0) is (broken == 2.0)


def test_an_arm_whose_link_breaks_is_shown_where_it_was_and_back_on_its_rocker_when_it_is_whole() -> None:
    state, tables = State(crank_angle_rad=1.3), WIPER.tables()
    outputs = run_step(plant(LinkageCondition(1.0, left=2.0)), tables, Rows(800, screen=WET, relay_on=1).rows, state)
    assert shown(outputs, "left_rocker_rad") == pytest.approx(np.full(800, WIPER.left.rocker(1.3)[0]), abs=1e-6)
    assert (shown(outputs, "left_blade_m_s") == 0.0).all()
    assert np.ptp(shown(outputs, "right_arm_rad")) > 0.3


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_bench_without_that_arm_s_masses_moves_alike(side: str, tmp_path: Path) -> None:
    linkage = yaml.safe_load(shipped("config", "linkages", "rhd_slave_driven.yaml").read_text())
    linkage[f"{side}_arm"]["mass_kg"] = linkage[f"{side}_blade"]["mass_kg"] = 0.0
    (tmp_path / "own.yaml").write_text(yaml.safe_dump(linkage))
    air = "area_m2: 0.07, drag: 0.175, lift: 0.0517"
    other = {"left": "right", "right": "left"}[side]
    (tmp_path / "bench.yaml").write_text(
        "extends: default.yaml\nname: x\nplant:\n  linkage: own.yaml\n  blades:\n"
        f"    {side}: {{force_n: 0}}\n    {other}: {{force_n: 7.615, {air}}}\n"
    )
    bare, whole = load_bench(tmp_path / "bench.yaml"), load_bench("default")
    rows = Rows(1500, relay_on=1, vehicle_speed_m_s=15.0).rows
    lost = whole.parameters._replace(linkage=LinkageCondition(1.0, **{side: 1.0}))
    ours, theirs = run_step(lost, whole.tables, rows), run_step(bare.parameters, bare.tables, rows)
    for name in ("current_a", "motor_speed_rad_s", "crank_angle_rad", "load_torque_n_m"):
        assert shown(ours, name) == pytest.approx(shown(theirs, name), rel=1e-6, abs=1e-6), name


#: Without dry friction, through a gear that transmits both ways without loss: what two bodies with a spring can be.
SMOOTH = Motor(MOTOR.slow, MOTOR.fast, 1.983e-5, 1.582e-4, 0.0, 63.0, 1.0, 1.0)
DAMPED = ClosedFormWiper(pivot_damping_n_m_s=0.15)


def two_bodies(rows: Floats, backlash: float) -> Floats:
    """Integrate current, motor speed, crank and linkage with a stiff spring and damper at each flank, by Radau."""
    stiffness, damper, ratio = 4e4, 40.0, SMOOTH.gear_ratio

    def flank(gap: float, closing: float) -> float:
        """Return the torque that pushes the linkage forwards; `gap` is its angle ahead of the crank."""
        if gap < 0.0:
            return max(0.0, -stiffness * gap + damper * closing)
        if gap > backlash:
            return min(0.0, -stiffness * (gap - backlash) + damper * closing)
        return 0.0

    def rates(_: float, x: Floats, volts: float) -> list[float]:
        current, speed, crank, linkage, u = x
        table = DAMPED.channels(float(linkage))
        push = flank(linkage - crank, speed / ratio - u)
        bias = 0.5 * u * u * table[2, 1] + table[3, 0] + table[7, 0] * u
        brush = SMOOTH.slow
        return [
            (volts - brush.resistance_ohm * current - brush.constant_v_s * speed) / brush.inductance_henry,
            (brush.constant_v_s * current - SMOOTH.damping_n_m_s * speed - push / ratio) / SMOOTH.inertia_kg_m2,
            speed / ratio,
            u,
            (push - bias) / table[2, 0],
        ]

    found, x = [np.zeros(5)], np.zeros(5)
    volts = np.where(rows[:, 0] > 0.5, rows[:, 2], 0.0)
    changes = [0, *(np.flatnonzero(np.diff(volts)) + 1), len(rows) - 1]
    for first, last in pairwise(changes):
        span = np.arange(first, last + 1) * 1e-3
        run = solve_ivp(rates, (span[0], span[-1]), x, "Radau", span[1:], args=(volts[first],), rtol=1e-7, atol=1e-9,
                        max_step=2e-3)  # fmt: skip
        found.extend(run.y.T)
        x = run.y[:, -1]
    return np.array(found)


def test_play_moves_as_two_bodies_with_a_stiff_spring_and_damper_between_them() -> None:
    backlash = np.radians(6.0)
    rows = Rows(1500, relay_on=1).set(500, 800, relay_on=0).set(1000, 1500, supply_v=-9.0).rows
    slippery = plant(LinkageCondition(1.0, backlash_rad=backlash), (0.0, 0.0), SMOOTH)
    outputs = run_step(slippery, DAMPED.tables(), rows)
    truth = two_bodies(rows, backlash)
    errors = errors_percent(outputs, truth[:, :3])
    stiff = run_step(plant(LinkageCondition(), (0.0, 0.0), SMOOTH), DAMPED.tables(), rows)
    without = errors_percent(stiff, truth[:, :3])
    arm = np.array([DAMPED.left.rocker(angle)[0] for angle in truth[:, 3]]) + 0.3
    arm_error = 100.0 * np.sqrt(np.mean((shown(outputs, "left_arm_rad") - arm) ** 2)) / np.ptp(arm)
    print(f"\nplay of 6 deg: current, speed, angle {errors} %, arm {arm_error:.2g} %; without it {without} %")
    assert max(*errors, arm_error) < 0.5 * max(without)
    assert max(*errors, arm_error) < 2.0


@pytest.mark.parametrize("scenario", ["start and run", "reverse", "park"])
def test_play_never_adds_energy_and_a_little_of_it_changes_little(scenario: str) -> None:
    rows = SCENARIOS[scenario]()
    little = run_step(plant(LinkageCondition(1.0, backlash_rad=1e-6)), WIPER.tables(), rows)
    none = run_step(plant(LinkageCondition()), WIPER.tables(), rows)
    truth = np.stack([shown(none, "current_a"), shown(none, "motor_speed_rad_s"),
                      np.unwrap(shown(none, "crank_angle_rad"))], axis=1)  # fmt: skip
    assert max(errors_percent(little, truth)) < 1.0
