"""Runs inside the guest, as its root, when systemd has started: uses the shipped unit and reports what holds.

Needs nothing but Python's standard library. One line to /check/result for each claim, `ok` or `FAILED` first; the last
line is `end`. `tests/service/service.py` starts the guest and reads the file.
"""

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

RESULT = Path("/check/result")
UNIT = "hilplant@vcan0"
HILPLANT = "/opt/hilplant/bin/hilplant"
RECORDINGS = Path("/var/lib/hilplant/vcan0")
SETTINGS = Path("/etc/hilplant/vcan0.env")
PATIENT = "/etc/hilplant/patient.yaml"
#: A bench that the slowness of User Mode Linux does not put behind, with few frames, so that all else has its time.
PATIENT_BENCH = """
extends: default.yaml
loop: {lost_time: 1.0}
bus:
  send:
    MotorStatus: {period_ms: 100, signals: {MotorCurrent: current_a}}
    Linkage: {period_ms: 100, signals: {CrankAngle: crank_angle_rad}}
"""
#: Where several guests share a CPU, even a warm start takes minutes.
SLOW = Path("/etc/systemd/system/hilplant@.service.d/slow.conf")
PATIENCE_S = 400.0
SYS_NICE, IPC_LOCK = 1 << 23, 1 << 14
#: Keeps the only CPU from the loop for half of each 0.2 s.
HOG = """
import os, time
os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(95))
while True:
    end = time.monotonic() + 0.1
    while time.monotonic() < end:
        pass
    time.sleep(0.1)
"""


class Claim(AssertionError):
    """Something that should hold does not."""


def run(*words: str, check: bool = True) -> str:
    """Run a program; return what it said on both streams."""
    result = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if check and result.returncode:
        raise Claim(f"{' '.join(words)} ended with {result.returncode}: {result.stdout.strip()[-600:]}")
    return result.stdout.strip()


def shown(name: str) -> str:
    """Return a property of the unit."""
    return run("systemctl", "show", "--value", "-p", name, UNIT)


def pid() -> int:
    """Return the daemon's number, 0 where it does not run."""
    return int(shown("MainPID"))


def until(true: Callable[[], object], what: str, patience_s: float = PATIENCE_S) -> float:
    """Wait until something holds; return how long that took [s]."""
    began_s = time.monotonic()
    while not true():
        if time.monotonic() - began_s > patience_s:
            raise Claim(f"not within {patience_s:.0f} s: {what}")
        time.sleep(0.1)
    return time.monotonic() - began_s


def expect(holds: object, text: str) -> None:
    """Raise unless it holds."""
    if not holds:
        raise Claim(text)


def settings(bench: str, record: str) -> None:
    """Write the unit's environment file."""
    SETTINGS.parent.mkdir(exist_ok=True)
    SLOW.parent.mkdir(exist_ok=True)
    SLOW.write_text("[Service]\nTimeoutStartSec=900\n")
    run("systemctl", "daemon-reload")
    Path(PATIENT).write_text(PATIENT_BENCH)
    SETTINGS.write_text(f'HILPLANT_BENCH={bench}\nHILPLANT_RECORD="--record {RECORDINGS} {record}"\n')


def series() -> list[str]:
    """Return the names of the recordings, one for each start, the oldest first."""
    found = {re.sub(r"-\d{4}\.hilrec$", ".hilrec", path.name) for path in RECORDINGS.glob("*.hilrec")}
    return sorted(found, key=lambda name: name.split("-")[-1])


def replayed(name: str) -> str:
    """Replay a recording as the service's user; return the answer."""
    user = ("setpriv", "--reuid=hilplant", "--regid=hilplant", "--clear-groups", "env")
    home = ("HOME=/var/lib/hilplant", "XDG_CACHE_HOME=/var/cache/hilplant")
    answer = run(*user, *home, HILPLANT, "replay", str(RECORDINGS / name))
    expect(answer.startswith("equal: all"), f"{name}: {answer}")
    return answer.splitlines()[0]


def becomes_ready() -> str:
    settings(PATIENT, "--rotate 8s --keep 100")
    began_s = time.monotonic()
    run("systemctl", "start", UNIT)
    took_s = time.monotonic() - began_s
    expect(shown("ActiveState") == "active", "systemctl start returned, and it is not active")
    frames = run("timeout", "20", "candump", "-n", "20", "vcan0,200:7E0")
    expect(len(frames.splitlines()) == 20, f"no frames on vcan0: {frames!r}")
    return f"ready after {took_s:.1f} s, and its frames are on vcan0"


def needs_no_root() -> str:
    daemon = pid()
    status = dict(line.split(":", 1) for line in Path(f"/proc/{daemon}/status").read_text().splitlines())
    owned = {int(number) for number in (status["Uid"] + status["Gid"]).split()}
    expect(0 not in owned, f"runs as {owned}")
    for name in ("CapEff", "CapPrm", "CapBnd"):
        expect(int(status[name], 16) & ~(SYS_NICE | IPC_LOCK) == 0, f"{name} is {status[name]}")
    expect(status["NoNewPrivs"].strip() == "1" and status["Seccomp"].strip() == "2", "no NoNewPrivs, or no seccomp")
    expect(os.sched_getscheduler(daemon) == os.SCHED_FIFO, "the loop has no SCHED_FIFO")
    expect(int(status["VmLck"].split()[0]) > 0, "no memory is locked")
    mounts = [line.split() for line in Path(f"/proc/{daemon}/mountinfo").read_text().splitlines()]
    root = next(mount for mount in mounts if mount[4] == "/")
    expect("ro" in root[5].split(","), f"the root is mounted {root[5]}")
    modes = {oct(path.stat().st_mode & 0o777) for path in RECORDINGS.glob("*.hilrec")}
    expect(modes == {"0o600"}, f"recordings have the modes {modes}")
    device = Path("/dev/cpu_dma_latency")
    group = f"{device.group()} {device.stat().st_mode & 0o777:o}" if device.exists() else "none here"
    expect(group in ("none here", "hilplant 660"), f"{device}: {group}")
    rights, locked = status["CapEff"].strip(), status["VmLck"].strip()
    return f"user {min(owned)}, CapEff {rights}, SCHED_FIFO, {locked} locked, / is read-only; {device}: {group}"


def is_fed() -> str:
    def fed() -> int:
        return int(shown("WatchdogTimestampMonotonic"))

    first = fed()
    took_s = until(lambda: fed() > first, "fed again", 30.0)
    time.sleep(6.0)
    expect(shown("NRestarts") == "0" and fed() > first + 3_000_000, "not fed for three times the limit")
    return f"fed within {took_s:.1f} s; lives three times longer than its watchdog allows without"


def hang_is_restarted() -> str:
    daemon, before = pid(), series()
    os.kill(daemon, signal.SIGSTOP)
    until(lambda: shown("NRestarts") != "0", "killed", 60.0)
    took_s = until(lambda: shown("ActiveState") == "active" and pid() not in (0, daemon), "started again")
    journal = run("journalctl", "-q", "-u", UNIT, "--no-pager")
    expect("Watchdog timeout" in journal, "the journal does not tell of the watchdog")
    until(lambda: len(series()) == len(before) + 1, "a recording of its own")
    return f"killed by the watchdog, ready again {took_s:.1f} s later; the recording until then: {replayed(before[-1])}"


def ticks_that_lose_time_do_not_feed() -> str:
    settings("default", "--rotate 8s --keep 100")
    run("systemctl", "reset-failed", UNIT)
    run("systemctl", "stop", UNIT, check=False)
    since = run("date", "+%Y-%m-%d %H:%M:%S")
    run("systemctl", "start", UNIT)
    hog = subprocess.Popen([sys.executable, "-c", HOG])
    try:
        journal = ("journalctl", "-q", "-u", UNIT, "--no-pager", "--since", since)
        took_s = until(lambda: "Watchdog timeout" in run(*journal), "killed", 60.0)
    finally:
        hog.kill()
        hog.wait()
    run("systemctl", "stop", UNIT, check=False)
    run("systemctl", "reset-failed", UNIT)
    settings(PATIENT, "--rotate 8s --keep 100")
    run("systemctl", "start", UNIT)
    daemon = pid()
    hog = subprocess.Popen([sys.executable, "-c", HOG])
    time.sleep(8.0)
    hog.kill()
    hog.wait()
    expect(pid() == daemon, "a bench with lost_time 1.0 was killed too")
    return f"with half of the time lost the default bench is ended after {took_s:.1f} s; with lost_time 1.0 it lives on"


def rotates_across_restarts() -> str:
    def parts() -> int:
        return len(list(RECORDINGS.glob(series()[-1].replace(".hilrec", "-*"))))

    until(lambda: parts() >= 4, "four parts")
    settings(PATIENT, "--rotate 30s --keep 4")
    run("systemctl", "restart", UNIT)
    until(lambda: parts() == 1, "the first part of the next start")
    until(lambda: parts() >= 2, "its second part")
    return "the parts of the next start follow those of the last one"


def stops_cleanly() -> str:
    began_s = time.monotonic()
    run("systemctl", "stop", UNIT)
    took_s = time.monotonic() - began_s
    state = [shown(name) for name in ("ActiveState", "Result", "ExecMainStatus")]
    expect(state == ["inactive", "success", "0"], f"ends as {state}")
    left = [path.name for path in Path("/dev/shm").glob("*hilplant*")]
    expect(not left, f"left in /dev/shm: {left}")
    numbers = {path.stat().st_uid for path in Path("/proc").iterdir() if path.name.isdigit()}
    expect(RECORDINGS.stat().st_uid not in numbers, "processes are left")
    names = sorted(path.name for path in RECORDINGS.glob("*.hilrec"))
    expect(len(names) == 4 and len(series()) == 2, f"not 4 parts of two starts are kept: {names}")
    replays = "; ".join(replayed(name) for name in series())
    return f"within {took_s:.1f} s, exit code 0, nothing left behind; 4 parts of two starts are kept: {replays}"


def main() -> int:
    """Do all of it, in order."""
    steps = (
        becomes_ready,
        needs_no_root,
        is_fed,
        hang_is_restarted,
        ticks_that_lose_time_do_not_feed,
        rotates_across_restarts,
        stops_cleanly,
    )
    with RESULT.open("w", buffering=1) as result:
        for step in steps:
            name = step.__name__.replace("_", " ")
            try:
                result.write(f"ok      {name}: {step()}\n")
            except (Claim, OSError, ValueError, KeyError) as error:
                result.write(f"FAILED  {name}: {error!r}\n")
                result.write(run("journalctl", "-q", "-u", UNIT, "--no-pager", "-n", "40", check=False) + "\n")
        result.write(f"{run('systemd-analyze', 'security', UNIT, check=False).splitlines()[-1].strip()}\nend\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
