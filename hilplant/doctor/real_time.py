"""Examination: what decides how punctually Linux wakes the loop."""

import os
import platform
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from hilplant.doctor.finding import MachineFinding, first_line

#: Tried in a process of its own, so that this one keeps its scheduling.
_TRY_FIFO = "import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))"
WANTED_LOCKED_BYTES = 2**30


def _limit(name: str, value: str) -> str:
    file = "/etc/security/limits.d/hilplant.conf"
    return f'echo "$USER - {name} {value}" | sudo tee -a {file}   # then log in again'


def _kernel_option(text: str) -> str:
    edit = f"""sudo sed -i 's/^GRUB_CMDLINE_LINUX="/&{text} /' /etc/default/grub"""
    return f"{edit}; sudo update-grub   # then restart"


def scheduling(_root: Path) -> Iterator[MachineFinding]:
    """Try SCHED_FIFO."""
    if not hasattr(os, "SCHED_FIFO"):
        yield MachineFinding("SCHED_FIFO", "warn", f"not on {sys.platform}: the loop is woken by ordinary timers")
        return
    tried = subprocess.run([sys.executable, "-I", "-S", "-c", _TRY_FIFO], capture_output=True, check=False)
    if tried.returncode == 0:
        yield MachineFinding("SCHED_FIFO", "ok", "permitted: other programs cannot delay the loop")
    else:
        fix = _limit("rtprio", "90")
        yield MachineFinding("SCHED_FIFO", "bad", "refused: other programs delay the loop by 1 to 2 ms", fix)


def limits(_root: Path) -> Iterator[MachineFinding]:
    """Read the limits of real-time priority and locked memory."""
    import resource

    capable = os.geteuid() == 0
    for name, number, wanted in (
        ("rtprio", getattr(resource, "RLIMIT_RTPRIO", resource.RLIMIT_NOFILE), 1),
        ("memlock", resource.RLIMIT_MEMLOCK, WANTED_LOCKED_BYTES),
    ):
        soft = resource.getrlimit(number)[0]
        enough = capable or soft == resource.RLIM_INFINITY or soft >= wanted
        shown = "unlimited" if soft == resource.RLIM_INFINITY else str(soft)
        fix = _limit(name, "90" if name == "rtprio" else "unlimited")
        note = " (root is not bound by it)" if capable else ""
        yield MachineFinding(f"limit {name}", "ok" if enough else "warn", shown + note, "" if enough else fix)


def sleep_states(root: Path) -> Iterator[MachineFinding]:
    """Ask whether deep sleep states can be forbidden while the loop runs."""
    device = root / "dev/cpu_dma_latency"
    if os.access(device, os.W_OK):
        yield MachineFinding("cpu_dma_latency", "ok", "writable: processors stay awake while the loop runs")
    elif device.exists():
        fix = "sudo chown $USER /dev/cpu_dma_latency   # until the next start; docker/60-hilplant.rules for good"
        yield MachineFinding("cpu_dma_latency", "warn", "not writable: an idle machine wakes 100 us late", fix)
    else:
        yield MachineFinding("cpu_dma_latency", "warn", "this kernel has none: an idle machine may wake late")


def kernel(root: Path) -> Iterator[MachineFinding]:
    """Tell how far the kernel can be preempted."""
    version = platform.version()
    if first_line(root / "sys/kernel/realtime") == "1" or "PREEMPT_RT" in version:
        yield MachineFinding("kernel", "ok", f"PREEMPT_RT, {platform.release()}")
    elif "PREEMPT" in version:
        what = f"preemptible, {platform.release()}; PREEMPT_RT bounds the worst case"
        yield MachineFinding("kernel", "ok", what, "sudo apt install linux-image-rt-amd64")
    else:
        what = f"{platform.release()} does not say that it is preemptible"
        yield MachineFinding("kernel", "warn", what, "sudo apt install linux-image-rt-amd64")


def processors(root: Path) -> Iterator[MachineFinding]:
    """Count processors, and those kept free of other work."""
    count = os.cpu_count() or 1
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else count
    enough = "ok" if usable >= 2 else "warn"
    yield MachineFinding("processors", enough, f"{usable} of {count} usable; the loop wants one to itself")  # type: ignore[arg-type]
    isolated = first_line(root / "sys/devices/system/cpu/isolated")
    last = count - 1
    fix = "" if isolated or count < 4 else _kernel_option(f"isolcpus={last} nohz_full={last}")
    yield MachineFinding("isolated processors", "ok", isolated or "none", fix)


def governor(root: Path) -> Iterator[MachineFinding]:
    """Read the frequency governors."""
    files = sorted((root / "sys/devices/system/cpu").glob("cpu[0-9]*/cpufreq/scaling_governor"))
    governors = sorted({first_line(file) for file in files})
    if not governors:
        yield MachineFinding("frequency governor", "ok", "not in this kernel's hands")
    elif governors == ["performance"]:
        yield MachineFinding("frequency governor", "ok", "performance")
    else:
        what = f"{', '.join(governors)}: ticks cost more after idle time"
        yield MachineFinding("frequency governor", "warn", what, "sudo cpupower frequency-set -g performance")


def clock_source(root: Path) -> Iterator[MachineFinding]:
    """Read the clock source: reading any but these is a slow call."""
    source = first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource")
    good = source in ("tsc", "arch_sys_counter", "kvm-clock")
    if source:
        fix = "" if good else _kernel_option("tsc=reliable")
        yield MachineFinding("clock source", "ok" if good else "warn", source, fix)


def hypervisor(root: Path) -> Iterator[MachineFinding]:
    """Tell whether a hypervisor may take the processor away."""
    try:
        flags = (root / "proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return
    if " hypervisor" in flags:
        yield MachineFinding(
            "hypervisor", "warn", "this is a virtual machine: its host can delay the loop, unseen from here"
        )
    elif "User Mode Linux" in flags:
        yield MachineFinding("hypervisor", "warn", "this is User Mode Linux: good for CAN tests, no real time")
    else:
        yield MachineFinding("hypervisor", "ok", "none seen")


CHECKS = (scheduling, limits, sleep_states, kernel, processors, governor, clock_source, hypervisor)
