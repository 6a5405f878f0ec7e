"""What the modelling page asks for, without a browser: curves, drawings, circuits, recordings, jobs."""

import time
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hilplant.failure import Failure
from hilplant.modelling.answers import Answers
from hilplant.modelling.long_answers import LongAnswers
from hilplant.modelling.motor_panel import MotorTest, steady_points
from hilplant.modelling.opening import open_model
from hilplant.modelling.park_drawing import circuit_states
from hilplant.modelling.recordings import kept
from hilplant.modelling.session import ModellingSession


@pytest.fixture
def session(tmp_path: Path) -> ModellingSession:
    return ModellingSession(open_model("default"), tmp_path)


def recorded(folder: Path, seconds: float = 4.0) -> str:
    """Keep a recording with four park closings a turn of which is a second."""
    time_s = np.arange(round(seconds * 1000)) / 1000.0
    park = (time_s % 1.0 < 0.1).astype(float)
    rows = np.column_stack([1000.0 * time_s, np.full(len(time_s), 13.5), 4000.0 + 500.0 * np.sin(6.28 * time_s), park])
    text = "T,U [V],I [mA],PS\n" + "\n".join(",".join(f"{value:.9g}" for value in row) for row in rows)
    return kept(folder, "rig.csv", text.encode()).name


def test_circuits_connect_as_the_tables_of_the_documentation_say() -> None:
    def leads(circuit: str, **wanted: Any) -> list[str]:
        (state,) = [each for each in circuit_states(circuit) if all(each[key] == wanted[key] for key in wanted)]
        return [state[name] for name in ("slow", "fast", "common")]

    assert leads("digital", command="slow", closed=False) == ["supply", "open", "ground"]
    assert leads("digital", command="fast", closed=True) == ["open", "supply", "ground"]
    assert leads("mechanical", command="off", closed=False) == ["supply", "open", "ground"]
    assert leads("mechanical", command="off", closed=True) == ["ground", "open", "ground"]
    assert leads("depressed", command="off", closed=False, phase="wiping") == ["ground", "open", "supply"]
    assert leads("depressed", command="off", closed=True, phase="turning_back") == ["supply", "open", "ground"]
    assert leads("depressed", command="off", closed=False, phase="parked") == ["open", "open", "open"]


def test_the_closed_form_keeps_the_two_equations_of_the_motor(session: ModellingSession) -> None:
    found = session.check().bench
    assert found is not None
    motor, test = found.plant.motor, MotorTest(torque_n_m=8.0, voltage_v=12.0)
    for mode, point in steady_points(motor, test).items():
        brush = getattr(motor, mode)
        voltage = brush.resistance_ohm * point.current_a + brush.constant_v_s * point.motor_speed_rad_s
        torque = brush.constant_v_s * point.current_a - motor.damping_n_m_s * point.motor_speed_rad_s
        assert voltage == pytest.approx(12.0, rel=1e-12)
        assert torque == pytest.approx(
            8.0 / motor.gear_ratio / motor.gear_efficiency + motor.coulomb_torque_n_m, rel=1e-9
        )


def test_a_motor_that_stalls_takes_the_current_of_its_resistance(session: ModellingSession) -> None:
    found = session.check().bench
    assert found is not None
    point = steady_points(found.plant.motor, MotorTest(torque_n_m=1000.0))["slow"]
    assert point.motor_speed_rad_s == 0.0
    assert point.current_a == pytest.approx(13.5 / found.plant.motor.slow.resistance_ohm)


@pytest.mark.parametrize("wrong", [{"on_s": 3.0}, {"end_s": 1e6}, {"voltage_v": 99.0}, {"torque_n_m": -1.0}])
def test_a_simulation_that_cannot_be_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(Failure):
        MotorTest(**wrong)


def test_solve_gives_velocities_that_are_the_slopes_of_the_positions(session: ModellingSession) -> None:
    asked = {"crank_speed_rad_s": 6.28, "seconds": 0.2, "step_s": 0.0005, "all": True}
    found = Answers(session).computing["solve"](asked)
    columns = found["columns"]
    for body in ("coupler", "left_rocker", "right_blade_a"):
        for axis, unit in (("x", "m"), ("y", "m"), ("angle", "rad")):
            slope = np.gradient(columns[f"{body}_{axis}_{unit}"], columns["time_s"])[1:-1]
            assert slope == pytest.approx(columns[f"{body}_{axis}_{unit}_s"][1:-1], abs=2e-4)
    assert set(found["forces"]) >= {"ground - crank", "crank - coupler", "crank torque"}


def test_friction_and_air_are_curves_over_speed(session: ModellingSession) -> None:
    found = Answers(session).computing["friction"]({})
    assert {"mu_dry", "mu_wet", "mu_tacky", "mu_wet_5_n"} <= set(found["columns"])
    assert found["columns"]["mu_dry"][0] == 0.0
    air = Answers(session).computing["air"]({})
    # section 4.5 at 40 m/s: rho/2 v^2 A cd = 0.6125 * 1600 * 0.07 * 0.175
    assert air["without_spoiler_4_5_drag_n"][-1] == pytest.approx(12.005)


def test_a_recording_is_mapped_looked_at_and_cut(session: ModellingSession) -> None:
    answers = LongAnswers(session).asked_for
    name = recorded(session.recordings)
    assert [each["name"] for each in answers["columns"]({"name": name})][-3:] == ["U", "I", "PS"]
    columns = "time=T[ms],voltage=U,current=I,park=PS"
    found = answers["look"]({"name": name, "columns": columns, "mode": "slow"})
    assert found["park_steps"][-1] == 3
    assert max(abs(value) for value in found["current_a"]) < 5.0  # mA became A
    cut = answers["cut"]({"name": name, "columns": columns, "mode": "slow", "from_s": 1.0, "to_s": 3.0})["name"]
    assert answers["look"]({"name": cut, "columns": "", "mode": "slow"})["seconds"] == pytest.approx(2.0, abs=0.01)
    with pytest.raises(Failure, match="less than a second"):
        answers["cut"]({"name": name, "columns": columns, "mode": "slow", "from_s": 1.0, "to_s": 1.2})


@pytest.mark.parametrize("name", ["../x.csv", "a.exe", "", ".csv", "x.csv/..", "a\0.csv"])
def test_a_recording_with_a_name_that_is_none_is_refused_or_kept_inside(session: ModellingSession, name: str) -> None:
    with suppress(Failure):
        assert kept(session.recordings, name, b"1").parent == session.recordings
    assert [path.name for path in session.work.iterdir()] == ["recordings"]


def test_a_job_that_cannot_be_done_says_why_and_the_next_one_starts(session: ModellingSession) -> None:
    (session.recordings / "empty.csv").write_text("time_s,voltage_v\n")
    answers = LongAnswers(session).asked_for
    asked = {"data": [{"name": "empty.csv", "screen": "dry"}], "stages": "1", "date": "2026-01-01"}
    for _ in range(2):
        answers["identify"](asked)
        until = time.monotonic() + 120.0
        while session.jobs.state["state"] == "running" and time.monotonic() < until:
            time.sleep(0.1)
        assert session.jobs.state["state"] == "failed"
        assert "empty.csv" in session.jobs.state["text"]
    with pytest.raises(Failure, match="no identification"):
        LongAnswers(session).identified_parts()


def test_a_run_needs_a_saved_bench(session: ModellingSession) -> None:
    with pytest.raises(Failure, match="save the bench first"):
        LongAnswers(session).asked_for["run"]({})


def test_networks_stand_in_with_their_files_beside_the_bench(session: ModellingSession, tmp_path: Path) -> None:
    from hilplant.resources import shipped

    trained = {}
    for work, name in (("torque", "torque_default.yaml"), ("motor", "motor_default.yaml")):
        trained[work] = tmp_path / f"{work}.yaml"
        trained[work].write_bytes(shipped("config", "surrogates", name).read_bytes())
    session.with_network(0, str(trained["torque"]), str(trained["motor"]))
    shown = session.shown()
    assert shown["sound"], shown["problems"]
    assert shown["others"] == ["motor_network.yaml", "torque_network.yaml"]  # motor.yaml is the motor itself
    assert shown["values"]["plant"]["load"]["model"] == "network"
    assert shown["values"]["plant"]["motor_model"]["model"] == "narx"


def test_what_was_found_is_taken_value_by_value_and_what_was_not_stays(session: ModellingSession) -> None:
    before = dict(session.model.texts)
    blade = {"force_n": 7.1, "wear": 1.0}
    motor = {"name": "x", "status": "identified", "slow": {"resistance_ohm": 1.2372}, "identified": {"cost": 0.5}}
    parts = {"motor": motor, "screen": {"dry": {"mu_dry_1": 0.78}}, "blades": {"left": blade, "right": blade}}
    session.accept(0, parts)
    shown, texts = session.shown(), session.model.texts
    assert shown["sound"], shown["problems"]
    plant = shown["values"]["plant"]
    assert plant["motor"]["slow"]["resistance_ohm"] == 1.2372
    assert plant["motor"]["slow"]["constant_v_s"] == 4.579e-2
    assert plant["motor"]["name"] == "table_5_9"
    assert plant["screen"]["dry"]["mu_dry_1"] == 0.78
    assert plant["blades"]["left"] == {"force_n": 7.1, "wear": 1.0, "area_m2": 0.07, "drag": 0.175, "lift": 0.0517,
                                       "assumed": ["wear", "area_m2", "drag", "lift"]}  # fmt: skip
    for name, text in before.items():
        comments = [line for line in text.splitlines() if line.strip().startswith("#")]
        assert [line for line in texts[name].splitlines() if line.strip().startswith("#")] == comments
