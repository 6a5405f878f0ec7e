"""Data of a small rig of its own (plain equations, no model of the project): good data pass, each mistake is named."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from hilplant.failure import Failure
from hilplant.measurements.checks import examine, refuse
from hilplant.measurements.columns import Column, parse_columns
from hilplant.measurements.measurement import Channel, Measurement
from hilplant.measurements.preparation import Preparation, prepare

R, L, K, J, B, N = 1.17, 2.9e-3, 0.044, 2.4e-5, 1.0e-4, 63.0
#: Seconds, volts: off, then the sequence of 5.2, then off.
STAGES = ((0.5, 0.0), (2.2, 10.0), (2.0, 12.0), (1.8, 14.0), (2.0, 16.0), (2.0, 12.0), (1.2, 0.0))


@cache
def rig(sample_hz: float = 1000.0, stages: tuple[tuple[float, float], ...] = STAGES) -> dict[str, np.ndarray]:
    """Integrate motor, dry and ripple load and park contact at 20 kHz; give every sample at `sample_hz`."""
    inner, volts = 5e-5, []
    for seconds, level in stages:
        volts += [level] * round(seconds / 5e-5)
    current = speed = turned = 0.0
    rows = np.empty((len(volts), 4))
    for tick, voltage in enumerate(volts):
        rows[tick] = tick * inner, voltage, current, 1.0 if math.cos(turned) > 0.9925 else 0.0
        load = (0.03 + 0.02 * math.sin(turned) ** 2) if speed > 0.0 or K * current > 0.05 else K * current
        current += inner * (voltage - R * current - K * speed) / L
        speed = max(0.0, speed + inner * (K * current - B * speed - load) / J)
        turned += inner * speed / N
    stride = round(1.0 / (sample_hz * inner))
    names = ("time", "U1", "I1", "PS")
    return {name: rows[::stride, index].copy() for index, name in enumerate(names)}


def channels(seed: int = 1, sample_hz: float = 1000.0, **changes: np.ndarray) -> dict[str, Channel]:
    """The rig's channels with noise, 10 mA quantisation and a ripple on the supply; `changes` replace columns."""
    clean = rig(sample_hz)
    random = np.random.default_rng(seed)
    count = len(clean["time"])
    noisy = {
        "U1": clean["U1"] + 0.02 * random.standard_normal(count),
        "I1": np.round((clean["I1"] + 0.1 * random.standard_normal(count)) / 0.01) * 0.01,
        "PS": clean["PS"],
    } | changes
    return {name: Channel(clean["time"], values) for name, values in noisy.items()}


COLUMNS = {"voltage": Column("U1"), "current": Column("I1"), "park": Column("PS")}


def prepared(how: Preparation | None = None, **changes: np.ndarray) -> Measurement:
    return prepare(channels(**changes), COLUMNS, how or Preparation(), "rig.csv")


def names(data: Measurement) -> list[str]:
    return [found.name for found in examine(data)]


@pytest.mark.parametrize("seed", range(8))
def test_good_data_raise_no_alarm(seed: int) -> None:
    assert examine(prepare(channels(seed), COLUMNS, Preparation())) == []


def test_good_data_without_noise_raise_no_alarm() -> None:
    clean = rig()
    assert names(prepared(U1=clean["U1"], I1=clean["I1"])) == []


@pytest.mark.parametrize("levels", [(9.0, 12.0), (14.0, 16.0, 10.0)])
def test_good_data_at_other_voltages_raise_no_alarm(levels: tuple[float, ...]) -> None:
    stages = ((0.5, 0.0), *((3.0, level) for level in levels), (1.0, 0.0))
    clean = rig(1000.0, stages)
    data = {name: Channel(clean["time"], clean[name]) for name in ("U1", "I1", "PS")}
    assert [found for found in examine(prepare(data, COLUMNS, Preparation())) if found.fatal] == []


def test_a_blocked_motor_is_not_taken_for_swapped_columns_or_a_clipped_current() -> None:
    """At stall V/I is the resistance, and a noise-free current is flat at its highest."""
    time_s = np.arange(6000) * 1e-3
    volts = np.where(time_s < 0.5, 0.0, np.where(time_s < 3.0, 8.0, 12.0))
    current = np.zeros(6000)
    for tick in range(5999):
        current[tick + 1] = current[tick] + (volts[tick] / R - current[tick]) * (1.0 - math.exp(-1e-3 * R / L))
    data = prepare(
        {"U1": Channel(time_s, volts), "I1": Channel(time_s, current), "PS": Channel(time_s, np.zeros(6000))},
        COLUMNS,
        Preparation(),
    )
    assert names(data) == ["no_park_edges"]


def test_swapped_voltage_and_current() -> None:
    good = channels()
    found = examine(prepared(U1=good["I1"].values, I1=good["U1"].values))
    assert [each.name for each in found] == ["swapped_columns"]
    assert "exchange them" in found[0].text


@pytest.mark.parametrize("role", ["U1", "I1"])
def test_park_swapped_with_another(role: str) -> None:
    good = channels()
    changed = {role: good["PS"].values, "PS": good[role].values}
    assert names(prepared(**changed)) == ["swapped_columns"]


def test_amperes_taken_as_milliamperes() -> None:
    found = examine(prepare(channels(), COLUMNS | {"current": Column("I1", "mA")}, Preparation()))
    assert [each.name for each in found] == ["wrong_current_unit"]
    assert "current=NAME[A]" in found[0].text


def test_milliamperes_taken_as_amperes() -> None:
    found = examine(prepared(I1=1000.0 * channels()["I1"].values))
    assert [each.name for each in found] == ["wrong_current_unit"]
    assert "current=NAME[mA]" in found[0].text


@pytest.mark.parametrize(("factor", "unit"), [(1000.0, "mV"), (0.001, "V")])
def test_a_wrong_unit_of_the_voltage(factor: float, unit: str) -> None:
    found = examine(prepared(U1=factor * channels()["U1"].values))
    assert [each.name for each in found] == ["wrong_voltage_unit"]
    assert f"voltage=NAME[{unit}]" in found[0].text


def test_no_park_edges() -> None:
    found = examine(prepared(PS=np.zeros(len(rig()["PS"]))))
    assert [each.name for each in found] == ["no_park_edges"]


def test_a_noisy_park_line() -> None:
    random = np.random.default_rng(3)
    noisy = np.repeat(random.integers(0, 2, len(rig()["PS"]) // 20 + 1), 20)[: len(rig()["PS"])].astype(float)
    assert names(prepared(PS=noisy)) == ["too_many_park_edges"]


def test_constant_voltage() -> None:
    good = rig()
    part = slice(np.searchsorted(good["time"], 1.2), np.searchsorted(good["time"], 2.65))
    long = {name: np.tile(values[part], 4) for name, values in good.items()}
    clock = np.arange(len(long["U1"])) * 1e-3
    random = np.random.default_rng(1)
    data = {name: Channel(clock, long[name] + 0.02 * random.standard_normal(len(clock))) for name in ("U1", "I1")}
    data["PS"] = Channel(clock, (clock % 0.9 < 0.04).astype(float))
    found = examine(prepare(data, COLUMNS, Preparation()))
    assert [each.name for each in found] == ["constant_voltage"]
    assert "10" in found[0].text


@pytest.mark.parametrize("noise", [True, False])
def test_a_clipped_current(noise: bool) -> None:
    current = channels()["I1"].values if noise else rig()["I1"]
    found = examine(prepared(I1=np.minimum(current, 5.0)))
    assert [each.name for each in found] == ["clipped_current"]
    assert "above 5 A" in found[0].text


@pytest.mark.parametrize("limit", [3.0, 5.0])
def test_a_clamp_that_adds_noise_behind_its_own_limit(limit: float) -> None:
    """No two samples at the limit are the same; they scatter as noise alone does, entered at full slope."""
    noise = 0.02 * np.random.default_rng(2).standard_normal(len(rig()["time"]))
    found = examine(prepared(I1=np.round(np.minimum(rig()["I1"], limit) + noise, 2)))
    assert [each.name for each in found] == ["clipped_current"]
    assert float(found[0].text.split("above ")[1].split(" A")[0]) == pytest.approx(limit, abs=0.03)


@pytest.mark.parametrize("noise_a", [0.02, 0.1, 0.3])
def test_a_blocked_motor_with_noise_is_not_taken_for_a_clipped_current(noise_a: float) -> None:
    time_s = np.arange(6000) * 1e-3
    current = np.where(time_s < 0.5, 0.0, 12.0 / R * (1.0 - np.exp(-np.maximum(time_s - 0.5, 0.0) * R / L)))
    current += noise_a * np.random.default_rng(4).standard_normal(6000)
    volts = np.where(time_s < 0.5, 0.0, 12.0)
    columns = {"U1": Channel(time_s, volts), "I1": Channel(time_s, current), "PS": Channel(time_s, np.zeros(6000))}
    assert "clipped_current" not in names(prepare(columns, COLUMNS, Preparation()))


@pytest.mark.parametrize(("column", "lead"), [("U1", "voltage"), ("I1", "current")])
def test_leads_or_clamp_the_wrong_way_round(column: str, lead: str) -> None:
    found = examine(prepared(**{column: -channels()[column].values}))
    assert [each.name for each in found] == ["wrong_sign"]
    assert f"{lead}=NAME*-1" in found[0].text


def test_a_time_in_the_wrong_unit() -> None:
    """Seconds taken as milliseconds leave less than a turn; milliseconds taken as seconds go on for hours."""
    short = {name: replace(each, time_s=1e-3 * each.time_s) for name, each in channels().items()}
    assert names(prepare(short, COLUMNS, Preparation())) == ["too_short"]
    long = {name: replace(each, time_s=1e3 * each.time_s) for name, each in channels().items()}
    with pytest.raises(Failure, match=r"^rig\.csv: the time goes on for .* hours; .*time=NAME\[ms\]"):
        prepare(long, COLUMNS, Preparation(), "rig.csv")


def test_sampling_at_100_hz() -> None:
    found = examine(prepare(channels(sample_hz=100.0), COLUMNS, Preparation()))
    assert [each.name for each in found] == ["slow_sampling"]
    assert "100 Hz" in found[0].text and "1 kHz" in found[0].text


def test_100_hz_that_were_repeated_to_1_khz() -> None:
    held = {name: np.repeat(channels()[name].values[::10], 10)[: len(rig()["time"])] for name in ("U1", "I1")}
    assert names(prepared(**held)) == ["slow_sampling"]


def test_fatal_findings_are_one_line_each_and_name_the_file() -> None:
    with pytest.raises(Failure, match=r"^rig\.csv: no park edges"):
        refuse(prepared(PS=np.zeros(len(rig()["PS"]))))


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
