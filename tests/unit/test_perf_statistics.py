"""The arithmetic behind the figures of `hilplant perf`, without measuring anything."""

import pytest

from hilplant.cli.actions.perf import amount, goal_text, print_table
from hilplant.failure import Failure
from hilplant.perf.cyclictest import latencies
from hilplant.perf.machine import cpu_model
from hilplant.perf.perf import PARTS, chosen_parts
from hilplant.perf.results import Goal, PartResult, Row
from hilplant.perf.samples import alternate, histogram_quantile, middle, quantile

#: As `cyclictest -q -h 20` prints it: 4 samples within the histogram, 1 beyond it.
REPORT = """\
# /dev/cpu_dma_latency set to 0us
# Histogram
000011 000001
000012 000002
000019 000001
# Total: 000000004
# Min Latencies: 00011
# Avg Latencies: 00016
# Max Latencies: 00070
# Histogram Overflows: 00001
# Histogram Overflow at cycle number:
# Thread 0: 00003

"""


@pytest.mark.parametrize(("share", "expected"), [(0.0, 1), (0.5, 50), (0.99, 99), (0.999, 100), (1.0, 100)])
def test_a_quantile_is_the_least_sample_that_the_share_does_not_exceed(share, expected):
    assert quantile(list(range(1, 101)), share) == expected
    assert histogram_quantile(dict.fromkeys(range(1, 101), 1), share) == expected


def test_no_samples_have_no_quantile():
    with pytest.raises(ValueError, match="no samples"):
        quantile([], 0.5)
    with pytest.raises(ValueError, match="no samples"):
        histogram_quantile({}, 0.5)


def test_subjects_are_measured_in_turn():
    order = []
    subjects = [lambda name=name: order.append(name) or float(len(order)) for name in "ab"]
    assert alternate(2, *subjects) == [[1.0, 3.0], [2.0, 4.0]]
    assert order == ["a", "b", "a", "b"]


def test_rounds_are_joined_by_the_median_and_worst_cases_by_the_worst():
    rounds = [{"p50_us": 1.0, "max_us": 9.0}, {"p50_us": 5.0, "max_us": 2.0}, {"p50_us": 2.0, "max_us": 3.0}]
    assert middle(rounds) == {"p50_us": 2.0, "max_us": 9.0}


def test_the_report_of_cyclictest_is_read_with_what_lies_beyond_its_histogram():
    assert latencies(REPORT) == (12.0, 70.0, 70.0, 70.0)


def test_the_processor_is_named_from_the_first_line_that_names_it():
    information = "processor\t: 0\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: Other\n"
    assert cpu_model(information) == "Some CPU @ 2 GHz"


def test_parts_are_chosen_in_their_order_and_the_long_one_only_by_name():
    assert chosen_parts("startup, step") == ["step", "startup"]
    assert chosen_parts("memory-10h") == ["memory-10h"]
    assert "memory-10h" not in chosen_parts(None)
    assert set(chosen_parts(None)) < set(PARTS)


@pytest.mark.parametrize("only", ["stepp", "step,,x", " , "])
def test_a_part_that_does_not_exist_is_answered_with_those_that_do(only):
    with pytest.raises(Failure, match="there are step, simulate"):
        chosen_parts(only)


@pytest.mark.parametrize(
    ("row", "ratio", "met", "text"),
    [
        (Row("a", 3.0, "us", 2.0, "floor", Goal(1.5)), 1.5, True, "yes, 1.5"),
        (Row("a", 3.1, "us", 2.0, "floor", Goal(1.5)), 1.55, False, "NO, 1.5"),
        (Row("a", 3.1, "s", 2.0, "floor", Goal(3.0, of_ratio=False)), 1.55, False, "NO, 3 s"),
        (Row("a", 3.1, "us", 2.0, "floor"), 1.55, None, ""),
        (Row("a", 3.1, "us", goal=Goal(1.5)), None, None, ""),
    ],
)
def test_a_row_is_judged_by_its_goal(row, ratio, met, text):
    assert row.ratio == (pytest.approx(ratio) if ratio else None)
    assert row.met is met
    assert (goal_text(row) if row.met is not None else "") == text


@pytest.mark.parametrize(
    ("value", "text"), [(123.4, "123 us"), (12.34, "12.3 us"), (1.234, "1.23 us"), (0.01234, "0.012 us")]
)
def test_amounts_keep_about_three_digits(value, text):
    assert amount(value, "us") == text


def test_the_table_fits_100_columns_and_says_what_was_not_measured(capsys):
    rows = [Row("in-memory bus, 2 in, 4 out, p99", 12345.6, "us", 9876.5, "cyclictest", Goal(1.5))]
    missing = PartResult(remarks=["not measured: no [cyclictest]"])
    print_table({"tick": PartResult(rows), "wakeup": missing}, "here")
    printed = capsys.readouterr().out
    assert max(len(line) for line in printed.splitlines()) <= 100
    assert "1.25" in printed
    assert "wakeup: not measured: no [cyclictest]" in printed
