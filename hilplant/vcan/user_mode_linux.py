"""A Linux kernel with CAN as an ordinary program: runs a command in it, on the files of this machine.

For machines whose own kernel has no CAN. Three serial lines of the guest carry stdout, stderr and stdin through
pipes; what its kernel says is kept apart and shown only when the guest fails. Needs the standard library alone.
"""

import os
import shlex
import shutil
import signal
import subprocess
import tempfile
import termios
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

PACKAGES = {"linux.uml": "user-mode-linux", "insmod": "kmod", "taskset": "util-linux"}
GUEST_SCRIPT = Path(__file__).with_name("user_mode_linux_guest.sh")
#: Environment of the caller that the command sees as well.
PASSED = (
    *("PATH", "HOME", "USER", "LANG", "LC_", "TERM", "COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR", "XDG_", "CI"),
    *("VIRTUAL_ENV", "PYTHON", "PYTEST", "HYPOTHESIS", "NUMBA", "HILPLANT", "COVERAGE", "MPL"),
)
BOOT_LIMIT_S = 90.0
#: Given to an interrupted command before the guest is ended [s].
GRACE_S = 10.0
MEBIBYTE = 2**20
RESULTS = ("code", "trouble")
INTERRUPT, END_OF_FILE = b"\x03", b"\x04"


class VcanUnavailable(RuntimeError):
    """No private vcan0 can be had, or the command in it did not end; the text is one line for the user."""


def run(command: Sequence[str], cwd: Path, limit_s: float, take_stdin: bool) -> int:
    """Run `command` in `cwd` inside the guest, with vcan0 up; return its exit code."""
    with tempfile.TemporaryDirectory(prefix="hilplant-vcan-") as name:
        folder = Path(name)
        _write_command(folder, command, cwd)
        terminal = take_stdin and os.isatty(0) and os.isatty(1)
        with (_on_terminal if terminal else _on_pipes)(folder) as (guest, stdin):
            if take_stdin and not terminal:
                threading.Thread(target=_feed, args=(folder, stdin), daemon=True).start()
            _wait(guest, folder, stdin, limit_s)
        return _exit_code(folder)


def _write_command(folder: Path, command: Sequence[str], cwd: Path) -> None:
    kept = {name: value for name, value in os.environ.items() if name.startswith(PASSED)}
    kept["TMPDIR"] = str(folder / "tmp")
    lines = [f"export {name}={shlex.quote(value)}" for name, value in kept.items() if name.isidentifier()]
    lines += [f"cd {shlex.quote(str(cwd))} || exit 2", f"exec {shlex.join(command)}"]
    (folder / "tmp").mkdir()
    (folder / "command").write_text("\n".join(lines) + "\n", encoding="utf-8")
    shutil.copy(GUEST_SCRIPT, folder / "guest")


def _memory() -> tuple[int, str]:
    """Choose the guest's memory [MiB] and the folder of the (deleted) file that holds it."""
    free = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") // MEBIBYTE
    size = max(768, min(2048, free * 3 // 4))
    shared = Path("/dev/shm")
    fits = os.path.ismount(shared) and shutil.disk_usage(shared).free // MEBIBYTE >= size
    return size, str(shared) if fits else tempfile.gettempdir()


def _start(folder: Path, lines: Sequence[str], ends: Sequence[int]) -> subprocess.Popen[bytes]:
    """Start the guest with its serial lines on `ends`, which this process no longer needs then."""
    size_mib, memory_folder = _memory()
    # User Mode Linux is four times faster when all its processes share one CPU.
    cpu = min(os.sched_getaffinity(0))
    arguments = [
        *("taskset", "-c", str(cpu), "linux.uml", f"mem={size_mib}M", f"uml_dir={folder}", "quiet"),
        *("rootfstype=hostfs", "rootflags=/", "rw", "con=null", "con0=null,fd:2", *lines),
        *("init=/bin/sh", "--", str(folder / "guest"), str(folder)),
    ]
    with (folder / "kernel").open("wb") as kernel:
        guest = subprocess.Popen(
            arguments,
            env={**os.environ, "TMPDIR": memory_folder},
            stdin=subprocess.DEVNULL,
            stdout=kernel,
            stderr=kernel,
            pass_fds=ends,
            start_new_session=True,
        )
    for end in ends:
        os.close(end)
    return guest


@contextmanager
def _on_pipes(folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """Run the guest with pipes as its three lines; hand out its process and the end that feeds its stdin."""
    pipes = [os.pipe() for _ in range(3)]
    ends = (pipes[0][1], pipes[1][1], pipes[2][0])
    lines = (f"ssl0=null,fd:{ends[0]}", f"ssl1=null,fd:{ends[1]}", f"ssl2=fd:{ends[2]},null")
    guest = _start(folder, lines, ends)
    pumps = [threading.Thread(target=_pump, args=(pipes[n][0], n + 1, pipes[2][1]), daemon=True) for n in (0, 1)]
    for pump in pumps:
        pump.start()
    try:
        yield guest, pipes[2][1]
    finally:
        _end(guest)
        for pump in pumps:
            pump.join()
        os.close(pipes[2][1])


@contextmanager
def _on_terminal(folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """Run the guest with this terminal as its only line; it gets every key, Ctrl-C as well."""
    before = termios.tcgetattr(0)
    size = os.get_terminal_size(0)
    (folder / "terminal").write_text(f"rows {size.lines} cols {size.columns}\n", encoding="utf-8")
    ends = (os.dup(0), os.dup(1))
    guest = _start(folder, (f"ssl0=fd:{ends[0]},fd:{ends[1]}",), ends)
    try:
        yield guest, -1
    finally:
        _end(guest)
        # The guest made it raw, and let it no longer wait for keys.
        termios.tcsetattr(0, termios.TCSADRAIN, before)
        for stream in range(3):
            os.set_blocking(stream, True)


def _end(guest: subprocess.Popen[bytes]) -> None:
    """End the guest's kernel and the host processes that its programs live in; they share its session."""
    with suppress(ProcessLookupError):
        os.killpg(guest.pid, signal.SIGKILL)
    guest.wait()


def _pump(source: int, target: int, stdin: int) -> None:
    """Pass output on; when nobody reads it any more, interrupt the command."""
    while data := os.read(source, 65536):
        try:
            while data:
                data = data[os.write(target, data) :]
        except OSError:
            with suppress(OSError):
                os.write(stdin, INTERRUPT)
    os.close(source)


def _feed(folder: Path, target: int) -> None:
    """Pass stdin on, once the guest listens."""
    while not (folder / "ready").exists():
        time.sleep(0.05)
    try:
        last = b"\n"
        while data := os.read(0, 1024):
            os.write(target, data)
            last = data[-1:]
        # A terminal takes the first one in mid-line for the end of the line.
        os.write(target, END_OF_FILE if last == b"\n" else END_OF_FILE * 2)
    except OSError:
        return


def _wait(guest: subprocess.Popen[bytes], folder: Path, stdin: int, limit_s: float) -> None:
    """Wait for the guest's result; pass signals on; complain when it does not start or end."""
    started = time.monotonic()
    deadlines = [started + limit_s] if limit_s else []

    def interrupt(number: int, _: object) -> None:
        if not (folder / "ready").exists():  # nobody is there yet who could heed it
            raise SystemExit(128 + number)
        with suppress(OSError):  # a terminal passes its own
            os.write(stdin, INTERRUPT)
        deadlines.append(time.monotonic() + GRACE_S)

    before = {number: signal.signal(number, interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        while guest.poll() is None and not any((folder / name).exists() for name in RESULTS):
            now = time.monotonic()
            if now > started + BOOT_LIMIT_S and not (folder / "ready").exists():
                raise VcanUnavailable(f"User Mode Linux did not start within {BOOT_LIMIT_S:g} s")
            if deadlines and now > min(deadlines):
                raise VcanUnavailable(f"ended after {now - started:.0f} s: time limit, or interrupt not heeded")
            time.sleep(0.02)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _exit_code(folder: Path) -> int:
    """Read the exit code that the guest left, or say why there is none."""
    code, trouble = (folder / name for name in RESULTS)
    if code.exists():
        return int(code.read_text(encoding="utf-8"))
    if trouble.exists():
        raise VcanUnavailable(f"in User Mode Linux: {trouble.read_text(encoding='utf-8').strip()}")
    said = (folder / "kernel").read_text(encoding="utf-8", errors="replace").strip().splitlines()
    panic = [line for line in said if "panic" in line.lower()] or said[-1:] or ["it said nothing"]
    raise VcanUnavailable(f"User Mode Linux ended early: {panic[0].strip()}")
