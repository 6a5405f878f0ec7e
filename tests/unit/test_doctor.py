"""The examination of the machine answers everywhere, changes nothing, and names a mending command for what is wrong."""

import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from hilplant import doctor
from hilplant.cli.actions.doctor import print_findings
from hilplant.doctor import can_bus, real_time
from hilplant.doctor.finding import MachineFinding


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """A root with the files of a machine that is set up well."""
    files = {
        "sys/kernel/realtime": "1\n",
        "sys/devices/system/cpu/isolated": "3\n",
        "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor": "performance\n",
        "sys/devices/system/clocksource/clocksource0/current_clocksource": "tsc\n",
        "proc/cpuinfo": "flags : fpu tsc\n",
        "dev/cpu_dma_latency": "",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def states(findings: Iterator[MachineFinding]) -> set[str]:
    return {finding.state for finding in findings}


def test_a_well_set_up_machine_is_found_so(machine: Path) -> None:
    for check in (real_time.kernel, real_time.governor, real_time.clock_source, real_time.hypervisor):
        assert states(check(machine)) == {"ok"}, check.__name__
    assert states(real_time.sleep_states(machine)) == {"ok"}


def test_a_slow_governor_and_clock_are_found_with_the_command_that_mends_them(machine: Path) -> None:
    (machine / "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor").write_text("powersave\n")
    (machine / "sys/devices/system/clocksource/clocksource0/current_clocksource").write_text("hpet\n")
    for check in (real_time.governor, real_time.clock_source):
        (finding,) = check(machine)
        assert finding.state == "warn" and finding.mend_command


def test_a_virtual_machine_is_named(machine: Path) -> None:
    (machine / "proc/cpuinfo").write_text("flags : fpu tsc hypervisor\n")
    assert states(real_time.hypervisor(machine)) == {"warn"}


def test_an_adapter_that_is_down_or_has_a_short_queue_is_found() -> None:
    timing = {"info_kind": "can", "info_data": {"state": "ERROR-ACTIVE", "bittiming": {"bitrate": 500000}}}
    up = {"ifname": "can0", "flags": ["UP"], "txqlen": 10, "linkinfo": timing}
    state, queue = can_bus._interface(up)
    assert (state.state, state.what) == ("ok", "up, 500000 bit/s, ERROR-ACTIVE")
    assert queue.mend_command == "sudo ip link set can0 txqueuelen 1000"
    (down,) = can_bus._interface({"ifname": "can0", "flags": [], "linkinfo": {"info_kind": "can"}})
    assert down.mend_command == "sudo ip link set can0 up type can bitrate 500000 restart-ms 100"


def test_the_examination_keeps_the_scheduling_of_this_process() -> None:
    before = (os.sched_getscheduler(0), os.sched_getaffinity(0))
    findings = doctor.examine()
    assert (os.sched_getscheduler(0), os.sched_getaffinity(0)) == before
    assert {finding.state for finding in findings} <= {"ok", "warn", "bad"}


def test_a_machine_without_linux_files_and_calls_is_examined_without_an_exception(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("SCHED_FIFO", "sched_getaffinity", "geteuid"):
        monkeypatch.delattr(os, name)
    monkeypatch.delattr("socket.AF_CAN")
    monkeypatch.setenv("PATH", "")
    findings = doctor.examine(tmp_path)
    print_findings(findings)
    assert "SocketCAN" in capsys.readouterr().out


def test_in_a_terminal_findings_break_between_words_and_commands_not_at_all(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("NO_COLOR", "1")
    what, command = "several words " * 12, "sudo " + "x" * 90
    print_findings([MachineFinding("name", "warn", what.strip(), command)])
    *lines, last = capsys.readouterr().out.splitlines()
    assert len(lines) == 4
    assert all(len(line) <= 60 and line.endswith(("several", "words")) for line in lines)
    assert f"     $ {command}" in last
