"""Controllers from a file and from a user's module: they drive, and one that takes too long is stopped and said."""

import re
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.driven_wiper import in_the_loop, mean_of_turns, on_the_bus
from typer.testing import CliRunner

from hilplant.bench import load_bench
from hilplant.cli.main import app
from hilplant.control.own import OwnSeat, Watch
from hilplant.control.records import Measured
from hilplant.ecu import controller_choice
from hilplant.ecu.controller_choice import ControllerChoice, Driven, own_maker, seat_on_bus
from hilplant.failure import Failure
from hilplant.runtime.clock import thread_cpu_ns, thread_cpu_step_ns, thread_waits

MOTOR = load_bench("default").parameters.motor
DRIVEN = Driven(MOTOR, 0.001)
DOCS = Path(__file__).parents[2] / "docs" / "control.md"
SEEN = Measured(2.0, 1.0, 0.0)
#: A controller is called in the tests' own process, where a garbage collection may come in between.
BUDGET_US = 100_000


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return what writes a module into the working directory under a name of its own."""
    monkeypatch.chdir(tmp_path)

    def write(name: str, body: str) -> str:
        (tmp_path / f"{name}.py").write_text(body)
        return f"{name}:make"

    return write


def example() -> str:
    """The example of the documentation."""
    (text,) = re.findall(r"```python\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)
    return text


def test_the_example_of_the_documentation_has_twenty_lines():
    assert len([line for line in example().splitlines() if line.strip()]) <= 20


@pytest.mark.parametrize("run", [in_the_loop, on_the_bus])
def test_the_example_holds_the_speed_in_the_loop_and_as_a_node(module: Any, run: Any):
    name = module(f"documented_{run.__name__}", example())
    speed, _ = run(name, "0:3.14,4:3.77", 1.0, 8.0, BUDGET_US)
    assert mean_of_turns(speed[1500:4000]) == pytest.approx(3.14, rel=0.02)
    assert mean_of_turns(speed[5500:]) == pytest.approx(3.77, rel=0.02)


def seat(decide: Any, cpu_ns: Any = lambda: 0, budget_us: int = 500, waits: Any = lambda: 0) -> OwnSeat:
    watch = Watch(budget_us * 1000, cpu_ns, waits)
    return OwnSeat(lambda motor, period_s: decide, MOTOR, 0.001, lambda _: 3.0, watch)


def test_a_call_over_its_budget_stops_the_controller_for_good():
    clock = iter([0, 400_000, 1_000_000, 1_600_000])
    slow = seat(lambda reference, measured: (9.0, True), lambda: next(clock))
    assert slow.decide(0.0, SEEN) == (9.0, 1.0)
    assert slow.decide(0.001, SEEN) == (9.0, 1.0) or slow.stopped
    assert "took 600 us of processor time, more than its budget of 500 us" in slow.stopped
    assert slow.decide(0.002, SEEN) == (0.0, 0.0)


def test_a_budget_that_nobody_gives_is_half_of_the_period(module: Any, monkeypatch: pytest.MonkeyPatch):
    spent = iter(range(0, 10**9, 600_000))
    monkeypatch.setattr(controller_choice, "thread_cpu_ns", lambda: next(spent))
    monkeypatch.setattr(controller_choice, "thread_cpu_step_ns", lambda: 0)
    name = module("in_half", "def make(motor, period_s):\n    return lambda reference, measured: (7.0, False)\n")
    slow, quick = (seat_on_bus(ControllerChoice(name, lambda _: 1.0), Driven(MOTOR, at)) for at in (0.001, 0.0013))
    for made in (slow, quick):
        made.decide(0.0, SEEN)
    assert "took 600 us of processor time, more than its budget of 500 us" in slow.stopped
    assert not quick.stopped


@pytest.mark.parametrize(("shown_ms", "stopped"), [(10, False), (20, True)])
def test_where_the_kernel_counts_in_ticks_only_a_time_that_is_certain_counts(shown_ms: int, stopped: bool):
    """A call of a few microseconds that a tick of 10 ms falls into shows 10 ms; one that shows 20 took 10 at least."""
    clock = iter([0, shown_ms * 1_000_000])
    watch = Watch(500_000, lambda: next(clock), lambda: 0, 10_000_000)
    own = OwnSeat(lambda motor, period_s: lambda reference, measured: (9.0, False), MOTOR, 0.001, lambda _: 3.0, watch)
    own.decide(0.0, SEEN)
    assert bool(own.stopped) is stopped


def test_the_steps_of_the_thread_s_clock_are_those_of_the_kernel():
    assert 0 < thread_cpu_step_ns() <= 20_000_000


def slow_after_the_rehearsal(slow: Any) -> Any:
    calls: list[float] = []

    def decide(reference: float, measured: Measured) -> tuple[float, bool]:
        calls.append(reference)
        if len(calls) > 20:
            slow()
        return 9.0, False

    return decide


def loop_for_ever() -> None:
    while True:
        pass


@pytest.mark.parametrize("slow", [loop_for_ever, lambda: time.sleep(600.0)])
def test_one_that_never_comes_back_is_broken_off(slow: Any):
    stuck = seat(slow_after_the_rehearsal(slow), thread_cpu_ns, waits=thread_waits)
    assert stuck.decide(0.0, SEEN) == (0.0, 0.0)
    assert "did not come back within 50 ms" in stuck.stopped


def test_one_whose_processor_others_have_taken_for_long_is_let_go_on():
    """Longer than the alarm, with no time of its own and without a wait, as on a machine that is overloaded."""

    def starved() -> None:
        end = time.monotonic() + 0.17
        while time.monotonic() < end:
            pass

    sound = seat(slow_after_the_rehearsal(starved))
    assert sound.decide(0.0, SEEN) == (9.0, 0.0)
    assert not sound.stopped


@pytest.mark.parametrize(
    ("answer", "told"),
    [(None, "not None"), ((float("nan"), False), "not (nan"), (("high", 0), "'high'"), ((1.0, 0, 0), "(1.0, 0, 0)")],
)
def test_an_answer_that_is_none_is_found_in_the_rehearsal(answer: Any, told: str):
    with pytest.raises(Failure, match=re.escape(told)):
        seat(lambda reference, measured: answer)


def test_an_error_later_on_stops_it_with_its_words():
    fails = seat(lambda reference, measured: (1.0 / (measured.speed_rad_s - 2.0), False))
    assert fails.decide(0.0, SEEN) == (0.0, 0.0)
    assert "ZeroDivisionError" in fails.stopped


def test_without_a_reference_it_is_not_asked_and_begins_anew():
    made: list[int] = []

    def maker(motor: Any, period_s: float) -> Any:
        made.append(0)
        return lambda reference, measured: (5.0, False)

    own = OwnSeat(maker, MOTOR, 0.001, lambda now_s: 0.0 if now_s > 1.0 else 2.0, Watch(10**9, lambda: 0, lambda: 0))
    assert own.decide(0.0, SEEN).voltage_v == 5.0
    before = len(made)
    assert [own.decide(2.0, SEEN).voltage_v for _ in range(3)] == [0.0, 0.0, 0.0]
    assert len(made) == before + 1


def test_the_daemon_opens_the_relays_says_why_and_ends_with_1(module: Any, tmp_path: Path):
    body = "import time\ncalls = []\ndef make(motor, period_s):\n    def decide(reference, measured):\n"
    body += (
        "        calls.append(0)\n        while len(calls) > 120: pass\n        return 9.0, False\n    return decide\n"
    )
    words = [
        "run",
        "virtual",
        "--controller",
        module("hangs_in_the_daemon", body),
        "--reference",
        "2",
        "--seconds",
        "1",
        "--budget-us",
        "20000",  # of the test's own process, with its garbage collector, not of the controller
    ]
    answer = CliRunner().invoke(app, [*words, "--record", str(tmp_path / "run.hilrec"), "--json", str(tmp_path / "j")])
    assert answer.exit_code == 1, answer.output
    assert "did not come back within 50 ms; relays opened" in answer.output
    table = tmp_path / "run.csv"
    assert CliRunner().invoke(app, ["export", str(tmp_path / "run.hilrec"), str(table)]).exit_code == 0
    columns = np.genfromtxt(table, delimiter=",", names=True, dtype=None, encoding="utf-8")
    relay, mode = columns["relay_on"], columns["status_mode"]
    stopped = int(np.flatnonzero(relay > 0.5)[-1]) + 1
    assert stopped > 50
    assert not relay[stopped:].any()
    assert set(map(str, mode[stopped : len(mode) - 1])) <= {"safe", "1", "1.0", "2", "2.0"}
    assert len({str(each) for each in mode[stopped : len(mode) - 1]}) == 1


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("no_such_module_here:make", "No module named"),
        ("math:nothing", "has no attribute 'nothing'"),
        (
            "nope",
            "no controller 'nope'; there are pid, .*with _sensorless; as files .*gentle_pi.*module:function",
        ),
    ],
)
def test_a_name_that_means_nothing_is_told_in_one_line(name: str, told: str):
    with pytest.raises(Failure, match=told):
        seat_on_bus(ControllerChoice(name, lambda _: 1.0), DRIVEN)


def test_a_module_of_the_working_directory_is_found_wherever_else_python_looks(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    name = module(
        "in_my_own_folder", "def make(motor, period_s):\n    return lambda reference, measured: (7.0, False)\n"
    )
    elsewhere = [place for place in sys.path if place not in ("", str(tmp_path))]
    monkeypatch.setattr(sys, "path", list(elsewhere))
    assert seat_on_bus(ControllerChoice(name, lambda _: 1.0), DRIVEN).decide(0.0, SEEN).voltage_v == 7.0
    assert sys.path == elsewhere


def test_a_maker_that_returns_no_function_is_told():
    maker = own_maker("math:pow")
    assert maker is not None
    with pytest.raises(Failure, match="must return a function"):
        maker(2.0, 3.0)  # type: ignore[arg-type]


def test_a_package_offers_its_controller_by_an_entry_point(
    module: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    module("offered_module", "def make(motor, period_s):\n    return lambda reference, measured: (7.0, False)\n")
    info = tmp_path / "offered-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: offered\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[hilplant.controllers]\noffered = offered_module:make\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    made = seat_on_bus(ControllerChoice("offered", lambda _: 1.0), DRIVEN)
    assert made.decide(0.0, SEEN).voltage_v == 7.0
    with pytest.raises(Failure, match=r"no controller 'offred'; .*; of packages offered; as files .*gentle_pi"):
        seat_on_bus(ControllerChoice("offred", lambda _: 1.0), DRIVEN)
