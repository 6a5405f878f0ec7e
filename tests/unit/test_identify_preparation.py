"""What is done to good data before they are used: shifted, bridged, thinned, and said."""

from dataclasses import replace

import numpy as np
import pytest
from support.measured_rig import COLUMNS, channels, prepared, rig

from hilplant.failure import Failure
from hilplant.measurements.checks import examine
from hilplant.measurements.columns import Column, parse_columns
from hilplant.measurements.measurement import Channel, Measurement
from hilplant.measurements.preparation import Preparation, prepare


def names(data: Measurement) -> list[str]:
    return [found.name for found in examine(data)]


@pytest.mark.parametrize("late_s", [-0.006, 0.004, 0.0115])
def test_a_late_current_is_found_and_moved_back(late_s: float) -> None:
    """The estimate against what was put in; a good one is left alone."""
    data = channels()
    data["I1"] = Channel(data["I1"].time_s + late_s, data["I1"].values)
    made = prepare(data, COLUMNS, Preparation())
    reference = prepared()
    both = min(len(made), len(reference)) - 50
    begin = round(max(0.0, late_s) * 1000.0)
    moved = made.voltage_v[: both - begin] - reference.voltage_v[begin:both]
    assert "moved back" in " ".join(made.notes)
    assert np.median(np.abs(moved)) < 0.05
    told = next(note for note in made.notes if "late" in note)
    assert float(told.split("by ")[1].split(" ms")[0]) == pytest.approx(1e3 * late_s, abs=0.3)


def test_a_current_in_time_is_not_moved() -> None:
    assert any("nothing changed" in note and "late" in note for note in prepared().notes)


def test_an_offset_of_the_current_is_found() -> None:
    made = prepared(I1=channels()["I1"].values + 0.25)
    assert np.mean(made.current_a[:400]) == pytest.approx(0.0, abs=0.02)
    told = next(note for note in made.notes if "offset" in note)
    assert "subtracted" in told
    assert float(told.split(": ")[1].split(" A")[0]) == pytest.approx(0.25, abs=0.01)


def test_outliers_are_flagged_counted_and_kept() -> None:
    current = channels()["I1"].values.copy()
    places = [1500, 3333, 5000, 7777]
    current[places] += 40.0
    made = prepared(I1=current)
    assert np.flatnonzero(~made.valid).tolist() == places
    assert made.current_a[places[0]] > 35.0
    assert any(note.startswith("4 of") for note in made.notes)


def test_missing_samples_are_bridged_and_not_used() -> None:
    data = channels()
    kept = np.ones(len(rig()["time"]), bool)
    kept[4000:4030] = False
    data["I1"] = Channel(data["I1"].time_s[kept], data["I1"].values[kept])
    made = prepare(data, COLUMNS, Preparation())
    assert np.flatnonzero(~made.valid).tolist() == list(range(4000, 4030))


def test_a_single_empty_cell_is_counted_and_not_used() -> None:
    current = channels()["I1"].values.copy()
    current[[4000, 6000]] = np.nan, np.inf
    made = prepared(I1=current)
    assert np.flatnonzero(~made.valid).tolist() == [4000, 6000]
    assert any(note == "current: cells without a number: 2" for note in made.notes)


def test_park_bounces_are_removed_and_the_first_edge_keeps_its_instant() -> None:
    clean = rig()["PS"]
    bouncing = clean.copy()
    edges = np.flatnonzero(np.diff(clean) > 0) + 1
    for edge in edges:
        bouncing[edge + 1] = 0.0
    made = prepared(PS=bouncing)
    assert np.flatnonzero(np.diff(made.park) > 0).tolist() == (edges - 1).tolist()
    assert made.park_steps[-1] == len(edges)


@pytest.mark.parametrize("late", [0, 3, 7])
def test_a_park_switch_that_was_sampled_slowly_is_not_late_on_average(late: int) -> None:
    """At 100 Hz an edge is seen 5 ms after it, within 5 ms; the same edges at 1 kHz are the measure."""
    data = channels()
    slow = slice(late, None, 10)
    data["PS"] = Channel(data["PS"].time_s[slow], data["PS"].values[slow])
    made, good = prepare(data, COLUMNS, Preparation()), prepared()
    instants = [each.time_s[1:][np.diff(each.park) > 0] for each in (made, good)]
    begins_s = max(0.0, 1e-3 * late - 0.004)  # the common clock, four steps before the first sample of the switch
    errors = instants[0] + begins_s - instants[1]
    assert np.max(np.abs(errors)) < 0.0061


def test_an_inverted_analogue_park_line_gives_the_same_steps() -> None:
    analogue = 13.0 - 12.6 * rig()["PS"]
    made, good = prepared(PS=analogue), prepared()
    assert np.array_equal(made.park, good.park)
    assert any("closed below" in note for note in made.notes)


def test_the_low_pass_shifts_nothing() -> None:
    filtered = prepared(Preparation(filter_hz=40.0, current_shift_s=0.0), I1=rig()["I1"])
    clean = prepared(Preparation(current_shift_s=0.0), I1=rig()["I1"])
    lags = range(-20, 21)
    middle = slice(1000, 9000)
    misfit = [float(np.sum((np.roll(filtered.current_a, lag) - clean.current_a)[middle] ** 2)) for lag in lags]
    assert lags[int(np.argmin(misfit))] == 0


@pytest.mark.parametrize("hertz", [500.0, 2000.0, 20000.0])
def test_any_rate_comes_to_the_same_clock(hertz: float) -> None:
    """Against the rig at 1 kHz: away from steps the current agrees to a hundredth of an ampere."""
    fast = rig(hertz)
    data = {name: Channel(fast["time"], fast[name]) for name in ("U1", "I1", "PS")}
    made = prepare(data, COLUMNS, Preparation(current_shift_s=0.0, offset_a=0.0))
    reference = rig()["I1"][: len(made)]
    assert made.period_s == 0.001
    assert np.percentile(np.abs(made.current_a - reference), 98) < 0.02


def test_units_and_factors() -> None:
    clean = rig()
    data = {
        "U1": Channel(clean["time"], 1e3 * clean["U1"], "mV"),
        "clamp": Channel(clean["time"], 0.1 * clean["I1"]),
        "PS": Channel(clean["time"], clean["PS"]),
    }
    made = prepare(data, parse_columns("voltage=U1,current=clamp*10,park=PS"), Preparation(current_shift_s=0.0))
    assert np.max(made.voltage_v) == pytest.approx(16.0)
    assert np.max(made.current_a) == pytest.approx(np.max(clean["I1"]), rel=1e-9)


def test_a_column_that_is_not_there_is_told_with_a_guess() -> None:
    with pytest.raises(Failure, match="did you mean 'I1'"):
        prepare(channels(), COLUMNS | {"current": Column("I2")}, Preparation())


def test_a_time_that_runs_backwards_is_told() -> None:
    data = channels()
    time_s = data["I1"].time_s.copy()
    time_s[700] = 0.1
    data["I1"] = replace(data["I1"], time_s=time_s)
    with pytest.raises(Failure, match="backwards at sample 701"):
        prepare(data, COLUMNS, Preparation())


def test_an_unknown_mode_is_told_even_where_a_column_says_the_mode():
    with pytest.raises(Failure, match="the mode must be slow or fast, not 'bogus'"):
        fast = np.zeros(len(rig()["time"]))
        prepare(channels(K2=fast), COLUMNS | {"fast": Column("K2")}, Preparation(mode="bogus"))
