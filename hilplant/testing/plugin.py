"""The plugin for pytest: plants in virtual time or on a channel, scenario files as tests, evidence of what failed.

Options: `--hilplant-bench`, `--hilplant-clock`, `--hilplant-channel`, `--hilplant-failures`.
"""

import re
from collections.abc import Generator, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from hilplant.bench import Bench
    from hilplant.testing.scenario_test import ScenarioTest
    from hilplant.testing.suite import Benches
    from hilplant.testing.wiper import WiperUnderTest

_WIPER: "pytest.StashKey[WiperUnderTest]" = pytest.StashKey()
_SCENARIO_FILE = re.compile(r"test_.*\.hil\.ya?ml")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    group = parser.getgroup("hilplant", "wipers in a loop with an ECU")
    group.addoption("--hilplant-bench", default=None, metavar="BENCH", help="bench file or name  [default: default]")
    group.addoption(
        "--hilplant-clock", default="virtual", choices=["virtual", "wall"], help="plant seconds, or those of the wall"
    )
    group.addoption("--hilplant-channel", default=None, metavar="CHANNEL", help="CAN channel, with the wall clock")
    group.addoption(
        "--hilplant-failures", default="hilplant-failures", metavar="DIR", help="where recordings of failed tests go"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Refuse options that do not fit each other."""
    channel, wall = config.getoption("--hilplant-channel"), config.getoption("--hilplant-clock") == "wall"
    if channel is not None and not wall:
        raise pytest.UsageError("--hilplant-channel needs --hilplant-clock wall")
    if wall and channel is None:
        raise pytest.UsageError("--hilplant-clock wall needs --hilplant-channel, such as vcan0")
    if wall and (hasattr(config, "workerinput") or getattr(config.option, "numprocesses", None)):
        raise pytest.UsageError("--hilplant-clock wall: one channel takes one test at a time; leave out -n")


@pytest.fixture(scope="session")
def hilplant_bench(request: pytest.FixtureRequest) -> "Bench":
    """The bench of `--hilplant-bench`, loaded once."""
    return _bench(request.config)


@pytest.fixture
def wiper(request: pytest.FixtureRequest, hilplant_bench: "Bench") -> Iterator["WiperUnderTest"]:
    """A plant; the test is the ECU."""
    yield from _given(request, hilplant_bench, stand_in=False)


@pytest.fixture
def car(request: pytest.FixtureRequest, hilplant_bench: "Bench") -> Iterator["WiperUnderTest"]:
    """A plant with the stand-in ECU before it; the test is the driver."""
    yield from _given(request, hilplant_bench, stand_in=True)


def _given(request: pytest.FixtureRequest, bench: "Bench", stand_in: bool) -> Iterator["WiperUnderTest"]:
    from hilplant.testing.wiper import WiperUnderTest

    channel = request.config.getoption("--hilplant-channel")
    with ExitStack() as open_now:
        clocked = None
        if channel is not None:
            from hilplant.testing.clocked_bench import clocked_bench

            clocked = open_now.enter_context(clocked_bench(bench, _bench_name(request.config), channel, stand_in))
        made = WiperUnderTest(bench, stand_in, clocked)
        request.node.stash[_WIPER] = made
        yield made
        if made.has_bus:
            made.bus.shutdown()


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, Any, Any]:
    """Judge what a test expected, when it has ended well."""
    result = yield
    made = item.stash.get(_WIPER, None)
    broken = made.judge() if made is not None else []
    if broken:
        pytest.fail("\n".join(broken), pytrace=False)
    return result


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, Any]:
    """Keep recording and plot of a test that failed, and say how to replay it."""
    report = yield
    if report.when == "call" and report.failed:
        if item.stash.get(_WIPER, None) is not None:
            report.sections.append(("hilplant", _keep(item, item.stash[_WIPER].record)))
        elif isinstance(item, ScenarioItem) and item.done is not None:
            kept = _keep(item, item.done.record)
            report.sections.append(("hilplant", f"{kept}\nagain: {item.done.rerun}"))
    return report


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> "CollectedScenario | None":
    """Collect `test_*.hil.yaml`: scenarios with an `expect` section."""
    if _SCENARIO_FILE.fullmatch(file_path.name):
        return CollectedScenario.from_parent(parent, path=file_path)
    return None


class CollectedScenario(pytest.File):
    """A scenario file: one test."""

    def collect(self) -> Iterator["ScenarioItem"]:
        """Give the test."""
        yield ScenarioItem.from_parent(self, name=self.path.name.split(".")[0])


class ScenarioFailedError(Exception):
    """What did not hold, in lines."""


class ScenarioItem(pytest.Item):
    """A scenario as a test: passes when all that it expects holds."""

    done: "ScenarioTest | None" = None

    def runtest(self) -> None:
        """Run it with the stand-in ECU, and judge it."""
        from hilplant.simulation.scenario import load_scenario
        from hilplant.testing.scenario_test import run_virtually
        from hilplant.testing.words import lines_of

        scenario, named = load_scenario(self.path), self.config.getoption("--hilplant-bench")
        bench, channel = _bench(self.config, scenario.bench), self.config.getoption("--hilplant-channel")
        if channel is None:
            self.done = run_virtually(scenario, bench, bench_name=named)
        else:
            from hilplant.testing.on_interface import run_on_interface

            self.done = run_on_interface(scenario, bench, channel, bench_name=named)
        if self.done.ruling != "pass":
            raise ScenarioFailedError("\n".join(lines_of(self.done)))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Show what did not hold, and mistakes of the file, without a traceback."""
        from hilplant.failure import Failure

        if isinstance(excinfo.value, ScenarioFailedError | Failure):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int, str]:
        """Say where the test is."""
        return self.path, 0, self.name


def _bench(config: pytest.Config, otherwise: str | None = None) -> "Bench":
    from hilplant.extras import need
    from hilplant.testing.suite import Benches

    need("testing")
    kept = config.stash.setdefault(_BENCHES, Benches())
    return kept.named(_bench_name(config, otherwise))


def _bench_name(config: pytest.Config, otherwise: str | None = None) -> str:
    from hilplant.testing.suite import DEFAULT_BENCH

    return config.getoption("--hilplant-bench") or otherwise or DEFAULT_BENCH


_BENCHES: "pytest.StashKey[Benches]" = pytest.StashKey()


def _keep(item: pytest.Item, record: Any) -> str:
    """Write recording and plot into a folder named after the test."""
    from hilplant.atomic_write import make_folder
    from hilplant.failure import Failure
    from hilplant.plots.recording import plot_recording

    name = re.sub(r"[^A-Za-z0-9_.-]+", "_", item.nodeid).strip("_")
    folder = Path(item.config.rootpath) / item.config.getoption("--hilplant-failures") / name
    recording, plot = folder / "run.hilrec", folder / "run.png"
    try:
        record(make_folder(folder) / recording.name)
        plot_recording(recording, plot)
    except (Failure, OSError) as error:  # what the test says is worth more
        return f"nothing is kept of this run: {error}"
    return f"recording: {recording}\nplot: {plot}\nreplay: hilplant replay {recording}"
