"""What a process asks of Linux to be woken on time, and what it was given."""

import contextlib
import ctypes
import gc
import os
import signal
import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

_MCL_CURRENT_AND_FUTURE = 3
_SLEEP_DEVICE = "/dev/cpu_dma_latency"


@dataclass(frozen=True, slots=True)
class Privilege:
    """One thing that was asked for: its name, whether it was given, and what would give it."""

    name: str
    granted: bool
    fix: str = ""


def _fifo(priority: int) -> None:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(priority))


def _lock_memory() -> None:
    library = ctypes.CDLL(None, use_errno=True)
    if library.mlockall(_MCL_CURRENT_AND_FUTURE) != 0:
        raise OSError(ctypes.get_errno(), "mlockall")


def _attempt(name: str, fix: str, action: Callable[[], object]) -> Privilege:
    try:
        action()
    except (OSError, AttributeError) as error:
        reason = getattr(error, "strerror", None) or "not on this system"
        return Privilege(name, False, f"{reason}; {fix}")
    return Privilege(name, True)


@contextlib.contextmanager
def _shallow_sleep(granted: list[Privilege]) -> Iterator[None]:
    """Keep the processor out of deep sleep states for as long as the file is open."""
    with contextlib.ExitStack() as stack:

        def hold() -> None:
            file = stack.enter_context(open(_SLEEP_DEVICE, "r+b", buffering=0))  # never made where there is none
            file.write(struct.pack("i", 0))

        fix = f"give the user write access to {_SLEEP_DEVICE}"
        granted.append(_attempt("cpu_dma_latency held at 0", fix, hold))
        yield


@contextlib.contextmanager
def real_time(priority: int, cpu: int | None) -> Iterator[list[Privilege]]:
    """Ask for everything that makes wake-ups punctual; yield what was granted and give it back at the end."""
    granted: list[Privilege] = []
    before = _scheduling()
    if cpu is not None:
        fix = f"this process may use {sorted(before.cpus)}" if before is not None else "leave out loop.cpu"
        granted.append(_attempt(f"pinned to CPU {cpu}", fix, lambda: os.sched_setaffinity(0, {cpu})))
    granted.append(_attempt("memory locked", "raise the memlock limit or grant CAP_IPC_LOCK", _lock_memory))
    gc.collect()
    gc.freeze()
    try:
        with _shallow_sleep(granted):
            fix = "raise the rtprio limit or grant CAP_SYS_NICE"
            granted.append(_attempt(f"SCHED_FIFO priority {priority}", fix, lambda: _fifo(priority)))
            yield granted
    finally:
        gc.unfreeze()
        if before is not None:
            _give_back(before)


def stand_back(loop_cpu: int | None, nice: int = 5) -> None:
    """Leave, as a process beside the loop, the signals of the terminal, the priority and the CPU to the loop.

    Those of a service manager too, which sends SIGABRT to all of a service whose loop hangs: the recorder shall still
    write what is in the ring.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGABRT):
        signal.signal(number, signal.SIG_IGN)
    with contextlib.suppress(OSError, AttributeError):  # only Linux has them all
        os.nice(nice)
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        if others := os.sched_getaffinity(0) - {loop_cpu}:
            os.sched_setaffinity(0, others)


class _Scheduling(NamedTuple):
    """How a thread is scheduled, and where it may run."""

    policy: int
    parameters: "os.sched_param"  # unknown outside Linux
    cpus: set[int]


def _scheduling() -> _Scheduling | None:
    """Return how this thread is scheduled; None on a system that does not tell."""
    if not hasattr(os, "sched_getaffinity"):
        return None
    return _Scheduling(os.sched_getscheduler(0), os.sched_getparam(0), os.sched_getaffinity(0))


def _give_back(before: _Scheduling) -> None:
    """Undo each step, also when another one cannot be undone."""
    with contextlib.suppress(OSError):
        os.sched_setscheduler(0, before.policy, before.parameters)
    with contextlib.suppress(OSError):
        os.sched_setaffinity(0, before.cpus)
    with contextlib.suppress(AttributeError):
        ctypes.CDLL(None).munlockall()
