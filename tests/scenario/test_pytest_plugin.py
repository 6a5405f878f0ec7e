"""The plugin as a user of pytest meets it: in a folder of its own, with tests that pass and tests that fail."""

import os
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from hilplant import jit
from hilplant.recording.replay import replay

pytest_plugins = ["pytester"]

COMPILED = Path(jit.numba.config.CACHE_DIR)
INSTALLED = any(entry.value == "hilplant.testing.plugin" for entry in entry_points(group="pytest11"))
PLUGIN = () if INSTALLED else ("-p", "hilplant.testing.plugin")

PARKS = """
    def test_parks(wiper):
        wiper.send("RelayCommand", RelayOn=1)
        wiper.wait("ParkContact", 0, within=1.0)
        wiper.wait("ParkContact", 1, within=3.0)
        wiper.send("RelayCommand", RelayOn=0)
        wiper.run(1.0)
        assert wiper["ParkContact"] == 1 and abs(wiper["crank_angle_deg"]) < 7
"""
SCENARIO = """
seconds: 4
stalk: [[1, slow]]
expect:
  - {rises: relay_on, after: 1.0, within: 0.05}
  - {always: current_a, below: LIMIT}
"""


#: A multicast group is a bus that other processes reach without CAN in the kernel.
GROUP = "239.74.163.3"
ON_A_BUS = """
extends: polynomial.yaml
name: on a bus
bus:
  interface: {{interface: udp_multicast, channel: 239.74.163.3, port: {port}}}
"""
#: Each test, and what it comes to in virtual time and on the clock.
DRIVES = """
    def test_brown_out(car):
        car.send("StalkCommand", Master_Input="Slow")
        car.run(0.5)
        with car.fault("frames_lost", message="ParkSwitch"):
            car.wait("EcuFault", "Park_Unknown", within=2.0)
        car.set(brake_torque_n_m=500.0)
        car.wait("EcuFault", "Stall", within=3.0)
        assert car.bus.recv(1.0) is not None
"""


@pytest.fixture(autouse=True)
def compiled_already(monkeypatch: pytest.MonkeyPatch) -> None:
    """The tester has a home of its own, and so would have no compiled code."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(COMPILED.parent))


def run(pytester: pytest.Pytester, *arguments: str) -> pytest.RunResult:
    return pytester.runpytest_subprocess(*PLUGIN, "-p", "no:cacheprovider", *arguments)


FLICK = """
    def test_flick(car):
        car.expect.count({"park_contact": "rises"}, equals=1)
        car.run(1.0)
        car.send("StalkCommand", Flick_Wipe="Pressed")
        car.run(0.3)
        car.send("StalkCommand", Flick_Wipe=False)
        car.wait("ParkContact", "Open", within=1.0)
        took = car.wait("ParkContact", "Closed", within=3.0)
        assert 0.5 < took < 2.0
        car.run(1.0)
"""
INRUSH = """
    def test_inrush(wiper):
        wiper.expect.always("current_a", below=5.0)
        wiper.send("RelayCommand", RelayOn=True)
        wiper.run(1.0)
"""
WAITS = """
    def test_never(wiper):
        wiper.wait("ParkContact", 0, within=0.5)

    def test_typing_error(wiper):
        wiper.wait("ParkContakt", 0)
"""
#: 20,000 frames of the plant, in 20 s of the processor at most.
BESIDE = """
    import can, time

    def test_can(wiper):
        began_s = time.process_time()
        on = can.Message(arbitration_id=0x120, data=[1, 0], is_extended_id=False)
        task = wiper.bus.send_periodic(on, 0.05)
        seen = [wiper.bus.recv(1.0) for _ in range(20000)]
        times = [message.timestamp for message in seen if message.arbitration_id == 0x200]
        gaps = [later - sooner for sooner, later in zip(times, times[1:])]
        assert 0.0099 < max(gaps) < 0.0101 and times[-1] > 20.0
        assert wiper["relay_on"] == 1
        task.stop()
        wiper.run(0.6)
        assert wiper["relay_on"] == 0 and wiper["timeout"] == 1
        wiper.bus.set_filters([{"can_id": 0x123, "can_mask": 0x7FF}])
        before = wiper.time_s
        assert wiper.bus.recv(2.5) is None
        assert abs(wiper.time_s - before - 2.5) < 0.002
        assert time.process_time() - began_s < 20.0
"""


def test_virtual_time_python_can_and_what_a_failure_leaves(pytester: pytest.Pytester) -> None:
    """Ten lines drive the plant, a stalk message the stand-in ECU; python-can beside them obeys virtual time.

    What fails leaves its line, a plot and a recording that replays; waiting has a limit, and says what there is.
    """
    pytester.makepyfile(test_parks=PARKS, test_flick=FLICK, test_beside=BESIDE, test_inrush=INRUSH, test_waits=WAITS)
    result = run(pytester, "-rA")
    result.assert_outcomes(passed=3, failed=3)
    for name in ("test_parks.py::test_parks", "test_flick.py::test_flick", "test_beside.py::test_can"):
        result.stdout.fnmatch_lines([f"PASSED {name}"])
    result.stdout.fnmatch_lines(["*test_inrush.py:2: fail: always: current_a, below: 5*A beyond the limit"])
    folder = pytester.path / "hilplant-failures" / "test_inrush.py_test_inrush"
    assert (folder / "run.png").stat().st_size > 10_000
    assert replay(folder / "run.hilrec").equal
    result.stdout.fnmatch_lines([f"replay: hilplant replay {folder / 'run.hilrec'}"])
    result.stdout.fnmatch_lines(["*ParkContact equals 0: not within 0.5 s; it is 1 at 0.500 s"])
    result.stdout.fnmatch_lines(["*no signal 'ParkContakt', did you mean 'ParkContact'?"])


@pytest.mark.parametrize("workers", [(), ("-n", "2", "-p", "xdist")], ids=["alone", "xdist"])
def test_scenario_files_are_tests(pytester: pytest.Pytester, workers: tuple[str, ...]) -> None:
    for name, limit in (("good", "25"), ("bad", "5")):
        Path(pytester.path, f"test_{name}.hil.yaml").write_text(SCENARIO.replace("LIMIT", limit))
    Path(pytester.path, "test_mistake.hil.yaml").write_text("seconds: 1\nexpect:\n  - {always: curent_a, below: 1}\n")
    result = run(pytester, *workers)
    result.assert_outcomes(passed=1, failed=2)
    result.stdout.fnmatch_lines(["*test_bad.hil.yaml:6: fail: always: current_a, below: 5: at *beyond the limit"])
    result.stdout.fnmatch_lines(["*test_mistake.hil.yaml:3: no signal 'curent_a', did you mean 'current_a'?*"])
    assert replay(pytester.path / "hilplant-failures" / "test_bad.hil.yaml_test_bad" / "run.hilrec").equal


CLOCKED = ("--hilplant-clock", "wall", "--hilplant-channel", GROUP)


@pytest.mark.timeout(600)  # a server starts for each test
@pytest.mark.parametrize("options", [(), CLOCKED], ids=["virtual", "clocked"])
def test_the_same_tests_in_virtual_time_and_on_a_channel(pytester: pytest.Pytester, options: tuple[str, ...]) -> None:
    pytest.importorskip("msgpack")
    bench = pytester.path / "on_a_bus.yaml"
    bench.write_text(ON_A_BUS.format(port=45000 + os.getpid() % 2000))
    pytester.makepyfile(PARKS + DRIVES + INRUSH)
    Path(pytester.path, "test_good.hil.yaml").write_text(SCENARIO.replace("LIMIT", "25"))
    result = run(pytester, "--hilplant-bench", str(bench), *options)
    outcomes, ill = result.parseoutcomes(), [line for line in result.outlines if "below: " in line]
    assert outcomes["passed"] + outcomes["failed"] == 4
    unseen = [line for line in ill if "inconclusive: " in line]  # a busy machine loses ticks, and then decides nothing
    assert len([line for line in ill if ": fail: always: current_a, below: 5" in line]) + len(unseen) >= 1
    assert outcomes["failed"] == 1 or (options and len(unseen) >= 1)
    result.stdout.fnmatch_lines(["replay: hilplant replay *"])
    (recording,) = (pytester.path / "hilplant-failures").glob("*test_inrush*/run.hilrec")
    assert replay(recording).equal


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--hilplant-clock", "wall"), "needs --hilplant-channel"),
        (CLOCKED[2:], "needs --hilplant-clock wall"),
        ((*CLOCKED, "-n", "2", "-p", "xdist"), "one channel takes one test at a time"),
    ],
)
def test_options_that_do_not_fit_are_refused(pytester: pytest.Pytester, options: tuple[str, ...], why: str) -> None:
    result = pytester.runpytest_inprocess(*PLUGIN, "-p", "no:cacheprovider", *options)  # nothing is imported
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines([f"*{why}*"])
