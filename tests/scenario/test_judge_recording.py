"""A recording gets the verdicts of the run that it is of; what was lost makes what hangs on it inconclusive."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from junitparser import JUnitXml

from hilplant.bench import Bench, load_bench
from hilplant.checked_yaml.problems import BenchError
from hilplant.failure import Failure
from hilplant.runtime.loop import STOPPED
from hilplant.runtime.row import ROW_WIDTH
from hilplant.simulation.scenario import load_scenario
from hilplant.testing.evidence import MODE, Evidence
from hilplant.testing.junit import write_junit
from hilplant.testing.known_signals import database_signals, protections_of
from hilplant.testing.report import page_of
from hilplant.testing.scenario_test import ScenarioTest, expected, judge_recording, judged, run_virtually

SCENARIO = """
title: all kinds
seconds: 9
signals: {screen: [[0, wet]], brake_torque_n_m: [[0, 0.0], [8.5, 500.0]]}
stalk: [[1, slow], [4, off]]
marks: {parked: 6.5}
expect:
  - {always: current_a, below: 25}
  - {always: current_a, below: 5, after: 1.0}
  - {never: EcuStatus.EcuFault, equals: Stall}
  - {within: 3.0, signal: {park_contact: on, relay_on: off}, after: 4.0}
  - {settles: crank_speed_rad_s, to: 0.0, tolerance: 0.1, by: 1.0, hold: 0.5, after: [4.0, {relay_on: falls}]}
  - {stays: crank_angle_rad, tolerance: 0.001, after: parked}
  - {response: {ParkContact: rises}, then: {relay_on: falls}, within: 0.05, after: 4.0, until: parked}
  - {count: {park_contact: rises}, between: [1, 4]}
  - {rises: RelayOn, after: 1.0, within: 0.06}
  - {always: park_contact, equals: on, while: {EcuState: Lockout}}
  - {frames: MotorStatus, period_ms: [1, 10]}
  - {frames: RelayCommand, missing: 0}
  - {frames: Linkage, jitter_ms: 0}
"""
RULINGS = ["pass", "fail", *["pass"] * 7, "blocked", *["pass"] * 3]


@pytest.fixture(scope="module")
def bench() -> Bench:
    return load_bench("default")


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("judge") / "kinds.yaml"
    file.write_text(SCENARIO)
    return file


@pytest.fixture(scope="module")
def done(path: Path, bench: Bench) -> ScenarioTest:
    return run_virtually(load_scenario(path), bench)


def rulings(test: ScenarioTest) -> list[str]:
    return [each.judgement.ruling for each in test.judged]


def test_every_kind_is_judged(done: ScenarioTest) -> None:
    assert rulings(done) == RULINGS
    assert done.ruling == "fail"


def test_a_recording_gets_equal_verdicts(done: ScenarioTest, path: Path, tmp_path: Path) -> None:
    assert done.record is not None
    done.record(tmp_path / "run.hilrec")
    found = judge_recording(tmp_path / "run.hilrec", str(path))
    assert [each.expectation for each in found.judged] == [each.expectation for each in done.judged]
    for one, other in zip(found.judged, done.judged, strict=True):
        assert (one.judgement.ruling, one.judgement.tick) == (other.judgement.ruling, other.judgement.tick)
        np.testing.assert_equal(one.judgement.robustness, other.judgement.robustness)
        np.testing.assert_equal(one.judgement.values, other.judgement.values)


@pytest.mark.parametrize("how", ["rows lost", "overrun", "frames missed"])
def test_what_was_lost_makes_it_inconclusive(done: ScenarioTest, bench: Bench, how: str) -> None:
    """From 0.5 s on something is lost now and then: never pass, and fail only for what was violated before."""
    rows = done.evidence.rows.copy()
    if how == "rows lost":
        rows = rows[(np.arange(len(rows)) < 500) | (np.arange(len(rows)) % 40 != 20)]
    else:
        from hilplant.signals import INPUTS, OUTPUTS, STATUS_INDEX

        name = "overruns" if how == "overrun" else "missed_frame"
        column = 2 + len(INPUTS) + len(OUTPUTS) + STATUS_INDEX[name]
        rows[500:, column] = np.arange(len(rows) - 500) // 40 + 1
    assert rows.shape[1] == ROW_WIDTH
    evidence = replace(done.evidence, rows=rows)
    database = database_signals(bench.sources, protections_of(bench))
    expectations = expected(done.scenario, database, bench.step_ns)
    found = judged(done.scenario, bench.name, evidence, database, expectations, "")
    told = {each.expectation.text: each.judgement.ruling for each in found.judged}
    passed = [text for text, ruling in told.items() if ruling == "pass"]
    assert passed == ["rises: RelayOn, within: 0.06, after: 1"]  # in its second tick, before the first gap there
    assert told["always: current_a, below: 25"] == "inconclusive"
    assert told["stays: crank_angle_rad, tolerance: 0.001, after: parked"] == "inconclusive"
    assert told["always: current_a, below: 5, after: 1"] == "fail"  # the inrush is seen before the first gap there
    assert told["frames: Linkage, jitter_ms: 0"] == "inconclusive"


def test_a_run_that_ends_early_decides_nothing_that_was_to_come(done: ScenarioTest, bench: Bench) -> None:
    database = database_signals(bench.sources, {})
    scenario = done.scenario
    short = Evidence(bench.step_ns, done.evidence.rows[:4050], done.evidence.frame_ticks, done.evidence.frames)
    found = judged(scenario, bench.name, short, database, expected(scenario, database, bench.step_ns), "")
    text = {each.expectation.text: each.judgement for each in found.judged}
    waiting = text["within: 3, signal: {park_contact: on, relay_on: off}, after: 4"]
    assert (waiting.ruling, waiting.reason) == ("inconclusive", "the run ended before it could be decided")


def test_last_ticks_that_are_lost_leave_it_inconclusive(done: ScenarioTest, bench: Bench) -> None:
    """The server's last row tells that ticks before it were due: what held up to there may have been broken in them."""
    database = database_signals(bench.sources, {})
    scenario, rows = done.scenario, done.evidence.rows[[*range(4050), 4099]]
    rows[-1, MODE] = STOPPED
    cut = replace(done.evidence, rows=rows)
    found = judged(scenario, bench.name, cut, database, expected(scenario, database, bench.step_ns), "")
    told = {each.expectation.text: each.judgement for each in found.judged}
    assert (told["always: current_a, below: 25"].ruling, told["always: current_a, below: 25"].tick) == (
        "inconclusive", 4098,
    )  # fmt: skip
    assert told["rises: RelayOn, within: 0.06, after: 1"].ruling == "pass"  # decided before


def test_another_tool_reads_the_junit_file(done: ScenarioTest, tmp_path: Path) -> None:
    write_junit(tmp_path / "report.xml", [done])
    (suite,) = JUnitXml.fromfile(str(tmp_path / "report.xml"))
    assert (suite.name, suite.tests, suite.failures, suite.errors) == ("all kinds", 13, 1, 1)
    failed = [case for case in suite if case.result and case.result[0].type == "fail"]
    assert (
        "beyond the limit" in failed[0].result[0].message and failed[0].name == "always: current_a, below: 5, after: 1"
    )


def test_the_page_shows_verdict_limits_and_marks_and_needs_no_other_file(done: ScenarioTest) -> None:
    page = page_of([done])
    assert page.count("<svg") >= 10 and "parked" in page and "again: <code>hilplant test" in page
    assert "http" not in page.replace("http://www.w3.org", "")


def test_mistakes_name_file_line_and_what_would_be_right(tmp_path: Path, bench: Bench) -> None:
    file = tmp_path / "wrong.yaml"
    file.write_text(
        "seconds: 2\nexpect:\n"
        "  - {always: curent_a, below: 1}\n"
        "  - {within: 3.0, signal: relay_on, equals: on}\n"
        "  - {frames: MotorStatsu, missing: 0}\n"
        "  - {always: EcuFault, equals: Stal}\n"
        "  - {never: relay_on, equals: on, after: late}\n"
        "  - {frames: RelayCommand, crc: right}\n"
    )
    with pytest.raises(BenchError) as caught:
        run_virtually(load_scenario(file), bench)
    told = [str(problem).rpartition("wrong.yaml:")[2] for problem in caught.value.problems]
    assert [line.partition(":")[0] for line in told] == ["3", "4", "5", "6", "7", "8"]
    assert "did you mean 'current_a'?" in told[0] and "make the scenario longer" in told[1]
    assert "did you mean 'MotorStatus'?" in told[2] and "did you mean 'stall'?" in told[3]
    assert "no mark 'late'" in told[4] and "no protection" in told[5]


@pytest.mark.parametrize(
    ("entry", "right"),
    [
        ("{allways: current_a, below: 1}", "did you mean 'always'?"),
        ("{always: current_a}", "below, above, between or equals"),
        ("{always: current_a, belo: 1}", "did you mean 'below'?"),
        ("{settles: current_a, to: 1, tolerance: 1}", "key 'by' is missing"),
        ("{frames: MotorStatus}", "one of period_ms"),
        ("{always: {relay_on: 1}, below: 2}", "within the group"),
        ("{count: {relay_on: rises}}", "how often"),
    ],
)
def test_a_wrong_entry_is_refused_when_the_scenario_is_read(entry: str, right: str, tmp_path: Path) -> None:
    file = tmp_path / "wrong.yaml"
    file.write_text(f"seconds: 2\nexpect:\n  - {entry}\n")
    with pytest.raises(Failure, match=r"wrong\.yaml:3: ") as caught:
        load_scenario(file)
    assert right in str(caught.value)
