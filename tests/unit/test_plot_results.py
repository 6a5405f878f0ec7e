"""Pictures of what was simulated and measured: simulation, animation, measurement, staircase; without a plant's run."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hilplant.bench import load_bench
from hilplant.cli.main import app
from hilplant.failure import Failure
from hilplant.identify.srivc import TransferFit, simulated
from hilplant.identify.stage_one_signals import answer_from_rest
from hilplant.identify.transfer_answers import transfer_answers
from hilplant.identify.transfer_function import TransferFunction
from hilplant.measurements.measurement import Measurement
from hilplant.measurements.park_cases import park_cases
from hilplant.plots.animation import Film, crank_angles
from hilplant.plots.stall import Stall, draw_stalls
from hilplant.recording.tables import write_table

TIME_S = np.arange(8000) * 1e-3


def drawn(*words: str) -> None:
    app(["plot", *words], standalone_mode=False)


@pytest.fixture(scope="module")
def rig() -> Measurement:
    """A wiper at an even turn of 1.3 s, from rest at 1 s, off at 7 s."""
    on = (TIME_S >= 1.0) & (TIME_S < 7.0)
    park = np.where(on, ((TIME_S - 1.0) % 1.3 > 1.25).astype(float), 0.0)
    current = np.where(on, 2.0 + 3.0 * np.exp(-(TIME_S - 1.0) / 0.03), 0.0)
    return Measurement(TIME_S, 12.0 * on, current, park, np.zeros(8000), np.ones(8000, dtype=np.bool_), 1e-3, "rig")


@pytest.fixture(scope="module")
def rig_csv(rig: Measurement, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("rig") / "rig.csv"
    names = ("time_s", "terminal_v", "current_a", "park_contact", "relay_fast")
    values = (rig.time_s, rig.voltage_v, rig.current_a, rig.park, rig.fast)
    write_table(path, dict(zip(names, values, strict=True)), {})
    return path


def test_stairs_order_the_cases_and_pulses_do_not(rig: Measurement) -> None:
    """As told of Figures 5-2 and 5-3: by pulses a wiper at rest is best, by stairs it is worst."""
    a, b, c = park_cases(rig)
    assert c.pulse_error < min(a.pulse_error, b.pulse_error)
    assert a.stair_error < b.stair_error < c.stair_error
    assert c.pulses.max() == 0.0
    with pytest.raises(Failure, match="closes less than twice"):
        park_cases(Measurement(*[np.zeros(10)] * 5, np.ones(10, dtype=np.bool_), 1e-3, "still"))


def test_measurement_and_staircase_are_drawn_by_their_commands(
    rig_csv: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    drawn("measurement", f"{rig_csv}@wet", str(tmp_path / "m.svg"))
    assert "park steps" in (tmp_path / "m.svg").read_text()
    drawn("staircase", f"{rig_csv}@wet", str(tmp_path / "s.svg"), "--table", str(tmp_path / "s.csv"))
    assert "case c, at rest" in (tmp_path / "s.svg").read_text()
    assert "case_b_steps" in (tmp_path / "s.csv").read_text()[:200]
    assert "of stairs" in capsys.readouterr().out


def test_the_answer_of_a_transfer_function_begins_at_rest_and_ends_at_its_gain() -> None:
    function = TransferFunction(89.47, 958.8, 96.33, 4733.0)  # (5.13)
    volts = np.where(TIME_S < 0.5, 0.0, 12.0)
    linear = answer_from_rest(TransferFit(function, 0.0, np.eye(4), 0.0, 1), volts, 1e-3)
    assert linear == pytest.approx(simulated(function, volts, 1e-3))
    assert linear[-1] == pytest.approx(12.0 * function.b0 / function.a0, rel=1e-6)
    rubbed = answer_from_rest(TransferFit(function, 900.0, np.eye(5), 0.0, 1), volts, 1e-3)
    assert rubbed[-1] == pytest.approx((12.0 * function.b0 + 900.0) / function.a0, rel=1e-6)
    assert np.all(rubbed[:499] == 0.0)


def test_the_motor_of_appendix_a_is_its_transfer_function() -> None:
    """Figure 5-7 is Figure 3-10: closed form 1.499915 A slow and 3.076736 A fast at 12 V."""
    slow, fast = transfer_answers(load_bench("appendix_a"), 12.0)
    assert slow.worst_a < 1e-9 and fast.worst_a < 1e-9
    assert slow.answer_a.max() == pytest.approx(1.499915, abs=5e-7)
    assert fast.answer_a.max() == pytest.approx(3.076736, abs=5e-7)
    with pytest.raises(Failure, match="appendix_a has one"):
        transfer_answers(load_bench("default"), 12.0)


@pytest.fixture(scope="module")
def run_csv(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "run.csv"
    angle = np.remainder(5.0 * TIME_S, 2.0 * np.pi)
    write_table(path, {"time_s": TIME_S, "current_a": np.sin(angle), "crank_angle_rad": angle}, {})
    return path


def test_a_simulation_is_drawn_with_the_signals_that_it_has_or_those_asked_for(run_csv: Path, tmp_path: Path) -> None:
    drawn("simulation", str(run_csv), str(tmp_path / "r.svg"))
    text = (tmp_path / "r.svg").read_text()
    assert "current [A]" in text and "crank [rad]" in text and "load torque" not in text
    with pytest.raises(Failure, match="has no signal 'speed'; it has"):
        drawn("simulation", str(run_csv), str(tmp_path / "r.svg"), "--signal", "speed")


def test_frames_of_a_film_follow_the_crank_over_its_whole_turns(run_csv: Path) -> None:
    time_s, crank = crank_angles(run_csv, Film(1.0, 3.0, 10.0, 2.0))
    assert time_s == pytest.approx([1.0, 1.2, 1.4, 1.6, 1.8, 2.0, 2.2, 2.4, 2.6, 2.8, 3.0])
    assert crank == pytest.approx(np.remainder(5.0 * time_s, 2.0 * np.pi), abs=1e-9)
    with pytest.raises(Failure, match="nothing between"):
        crank_angles(run_csv, Film(9.0))
    with pytest.raises(Failure, match="are more than 3000"):
        crank_angles(run_csv, Film(frames_a_second=50.0, times_faster=0.01))


def test_a_moving_picture_has_a_frame_for_each_instant_and_moves(run_csv: Path, tmp_path: Path) -> None:
    drawn("animation", str(run_csv), str(tmp_path / "film.gif"), "--to", "0.5", "--frames", "10")
    with Image.open(tmp_path / "film.gif") as film:
        assert film.n_frames == 6
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(4)
        assert np.abs(np.asarray(film.convert("RGB")).astype(int) - first).max() > 100
    with pytest.raises(Failure, match=r"must be \.gif"):
        drawn("animation", str(run_csv), str(tmp_path / "film.mp4"))


def test_a_stall_names_only_the_states_that_occur(tmp_path: Path) -> None:
    states = np.repeat([0.0, 9.0, 20.0], 100)
    signals = {
        "current_a": 9.0 * (states == 9.0),
        "winding_temperature_c": 60.0 + states,
        "thermal_switch": 1.0 * (states > 9.0),
    }
    signals |= {"crank_speed_rad_s": 0.0 * states, "EcuState": states, "EcuFault": 0.0 * states}
    draw_stalls([Stall("a run", 1e-3, signals, (10.0, 5.5), (150.0, 110.0))] * 2, tmp_path / "stall.svg")
    text = (tmp_path / "stall.svg").read_text(encoding="utf-8")
    assert [name for name in ("lockout", "slow", "off", "retry") if f"<!-- {name} -->" in text] == [
        "lockout",
        "slow",
        "off",
    ]
