"""The same test files in virtual time and on an interface, in real time; an overloaded loop decides nothing."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from hilplant.bench import load_bench
from hilplant.simulation.scenario import load_scenario
from hilplant.testing import on_interface

FILES = Path(__file__).parents[1] / "data" / "on_a_bus"
#: A multicast group is a bus that other processes reach without CAN in the kernel.
GROUP = "239.74.163.2"
BENCH = """
extends: polynomial.yaml
name: on a bus
bus:
  interface: {{interface: udp_multicast, channel: {group}, port: {port}}}
"""
#: Spins on the loop's CPU, at its priority where that is allowed, 10 ms at a time for as long as a loop stands there.
BUSY = """
import os, pathlib, time

def loop_is_there():
    for told in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            words = told.read_bytes().split(b"\\0")
            if b"hilplant" in words and b"run" in words and os.sched_getaffinity(int(told.parent.name)) == {{{cpu}}}:
                return True
        except OSError:
            pass
    return False

os.sched_setaffinity(0, {{{cpu}}})
try:
    os.sched_setscheduler(0, os.SCHED_RR, os.sched_param({priority}))
except OSError:
    pass
while True:
    if loop_is_there():
        for _ in range(20):
            end = time.monotonic() + 0.01
            while time.monotonic() < end:
                pass
            os.sched_yield()
    else:
        time.sleep(0.05)
"""


def verdicts(bench: Path | str, told: Path, *more: str, env: dict[str, str] | None = None) -> dict[str, Any]:
    command = [sys.executable, "-m", "hilplant", "test", *more, "--bench", str(bench), "--json", str(told)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=env)
    assert done.returncode in {0, 1}, done.stderr
    return {each["file"]: each for each in json.loads(told.read_text())["results"]}


@pytest.fixture
def bench(tmp_path: Path) -> Path:
    pytest.importorskip("msgpack")
    path = tmp_path / "on_a_bus.yaml"
    path.write_text(BENCH.format(group=GROUP, port=43000 + os.getpid() % 2000))
    return path


@pytest.mark.timeout(900)  # ten servers start, one after the other
def test_the_same_ten_files_get_the_same_verdicts(bench: Path, tmp_path: Path) -> None:
    """What lost ticks leave undecided runs again on a slow clock; a machine that stands still decides nothing there."""
    virtual = verdicts("polynomial", tmp_path / "virtual.json", str(FILES))
    clocked = verdicts(bench, tmp_path / "clocked.json", str(FILES), "--on", GROUP)
    assert len(virtual) == 10
    assert {each["ruling"] for each in virtual.values()} == {"pass", "fail", "blocked"}
    undecided = [name for name, each in clocked.items() if each["ruling"] == "inconclusive"]
    if undecided:
        clocked |= verdicts(bench, tmp_path / "slow.json", *undecided, "--on", GROUP, "--pace", "0.1")
    decided = {name: each["ruling"] for name, each in clocked.items() if each["ruling"] != "inconclusive"}
    print(f"undecided in real time: {undecided}; on the slow clock too: {sorted(clocked.keys() - decided)}")
    assert decided == {name: virtual[name]["ruling"] for name in decided}


@pytest.mark.timeout(900)
def test_an_overloaded_loop_gives_inconclusive_never_fail_or_pass(bench: Path, tmp_path: Path) -> None:
    """The loop stays on one CPU, with busy processes of its own priority from its start on."""
    cpu = min(os.sched_getaffinity(0))
    bench.write_text(bench.read_text() + f"loop: {{cpu: {cpu}}}\n")
    spin = BUSY.format(cpu=cpu, priority=load_bench(bench).loop.priority)
    busy = [subprocess.Popen([sys.executable, "-c", spin]) for _ in range(2)]
    try:
        files = [str(FILES / name) for name in ("02_slow.yaml", "08_too_strict.yaml")]
        found = verdicts(bench, tmp_path / "busy.json", *files, "--on", GROUP)
    finally:
        for each in busy:
            each.kill()
            each.wait()
    assert {each["ruling"] for each in found.values()} == {"inconclusive"}


SERVERS = {
    "hangs": "import time; time.sleep(60)",
    "hears nobody": "import signal, time; signal.signal(signal.SIGTERM, signal.SIG_IGN); time.sleep(60)",
    "dies": "import os; os.kill(os.getpid(), 9)",
}


@pytest.mark.parametrize("does", SERVERS.values(), ids=SERVERS)
def test_a_server_that_comes_to_no_end_decides_nothing(does: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No wait is without a limit, and what was not seen to its end is neither passed nor failed."""

    def instead(_scenario: object, _channel: str, _bench: object, recording: Path) -> list[str]:
        return [sys.executable, "-c", f"open({str(recording)!r}, 'w').close(); {does}"]

    monkeypatch.setattr(on_interface, "server_command", instead)
    monkeypatch.setattr(on_interface, "_BEGIN_S", 0.1)
    monkeypatch.setattr(on_interface, "_END_S", 1.0)
    done = on_interface.run_on_interface(load_scenario(FILES / "02_slow.yaml"), load_bench("virtual"), "no_end")
    assert done.ruling == "inconclusive"
    assert {each.judgement.reason for each in done.judged} == {on_interface.NO_END}
    assert len(done.judged) == 3
