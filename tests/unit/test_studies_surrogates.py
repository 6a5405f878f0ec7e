"""The comparison of all models says what it found, and compares what it says."""

import math
from pathlib import Path

import numpy as np

from hilplant.models.load import LOADS
from hilplant.thesis.surrogate_study import Compared, finer_current, lines, models, plot


def compared(name: str, **changed: float) -> Compared:
    found = Compared(name, 300.0, 280.0, 0.06, 20.0, 24, 24, 0.3, 0.01, True, 0.6, 0.6)
    values = {field: getattr(found, field) for field in Compared.__dataclass_fields__} | changed
    return Compared(**values)


def test_each_model_is_what_its_name_says() -> None:
    found = {
        name: (
            LOADS[int(pair.bench.parameters.load.model)],
            pair.bench.parameters.motor_model,
            len(pair.bench.parameters.networks) > 0,
        )
        for name, pair in models().items()
    }
    assert found == {
        "reduced": ("reduced", 0.0, False),
        "none": ("none", 0.0, False),
        "torque network": ("network", 0.0, True),
        "motor network": ("reduced", 1.0, True),
        "all networks": ("network", 1.0, True),
        "linkage alone": ("reduced", 0.0, False),
        "polynomial": ("polynomial", 0.0, False),
        "own polynomial": ("polynomial", 0.0, True),
    }


def test_another_count_angle_current_or_frame_is_not_kept() -> None:
    assert compared("all networks").kept
    worse = ({"stops": 25}, {"worst_angle_deg": 1.1}, {"bus_current_share": 0.031}, {"same_frames": False})
    assert not any(compared("all networks", **changed).kept for changed in worse)
    assert not compared("none", worst_angle_deg=math.nan).kept


def test_the_table_and_the_picture_show_every_model(tmp_path: Path) -> None:
    found = [compared("reduced", current_rms_a=1e-4), compared("none", stops=26, worst_angle_deg=math.nan)]
    text = lines(found, 600.0)
    assert len(text) == 2 + len(found)
    assert "yes" in text[2]
    assert "26/24" in text[3]
    assert "NO" in text[3]
    plot(found, tmp_path / "models.png")
    assert (tmp_path / "models.png").stat().st_size > 10_000


def test_the_truth_of_the_minute_is_the_step_at_one_millisecond_to_three_digits() -> None:
    """The reduced plant's own error at the step that the loop takes, by steps twenty times shorter."""
    from hilplant.models.plant import simulate_rows
    from hilplant.perf.networks_cost import calm_minute
    from hilplant.signals import OUTPUT_INDEX, OUTPUTS

    bench = models()["reduced"].bench
    inputs = calm_minute(bench)
    outputs = np.empty((len(inputs), len(OUTPUTS)))
    simulate_rows(bench.state_row.copy(), inputs, bench.parameter_row, bench.tables, outputs)
    error = outputs[:, OUTPUT_INDEX["current_a"]] - finer_current(bench)
    assert np.sqrt(np.mean(error**2)) < 1e-3 * np.ptp(outputs[:, OUTPUT_INDEX["current_a"]])
