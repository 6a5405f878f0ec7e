"""Run a command where a CAN interface ``vcan0`` exists that no other program sees.

A kernel with CAN gives it in a network namespace of its own; without one, the command runs in User Mode Linux on
the same files (see :mod:`hilplant.vcan.user_mode_linux`). Needs the standard library alone::

    python -m hilplant.vcan.private_vcan [--limit SECONDS] COMMAND [ARGUMENT...]
"""

import argparse
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from hilplant.vcan import user_mode_linux
from hilplant.vcan.user_mode_linux import VcanUnavailable

INTERFACE = "vcan0"
#: After this long a command counts as hanging [s]; 0 means never.
LIMIT_S = 1800.0
#: Exit code when the command could not be run, or not to its end.
FAILED = 2
PACKAGES = {"ip": "iproute2", "candump": "can-utils"}
SYSTEM_FOLDERS = ("/usr/local/sbin", "/usr/sbin", "/sbin", "/usr/bin", "/bin")


def run_with_vcan(
    command: Sequence[str], cwd: Path | None = None, limit_s: float = LIMIT_S, take_stdin: bool = True
) -> int:
    """Run `command` in `cwd` with a private vcan0 that is up; return its exit code.

    One line on stderr and 2 where no vcan0 can be had, or when `limit_s` (0: none) is exceeded. SIGINT and SIGTERM
    reach the command and end it.
    """
    folder = Path.cwd() if cwd is None else cwd
    try:
        _reach_system_programs()
        _require(PACKAGES)
        if _namespace_works():
            return _run_in_namespace(command, folder, limit_s, take_stdin)
        _require(user_mode_linux.PACKAGES)
        return user_mode_linux.run(command, folder, limit_s, take_stdin)
    except VcanUnavailable as error:
        sys.stderr.write(f"vcan: {error}\n")
        return FAILED


def _reach_system_programs() -> None:
    """Put the folders of ``ip`` and ``insmod`` on the path, where an ordinary user often lacks them."""
    folders = os.environ.get("PATH", "").split(os.pathsep)
    folders += [folder for folder in SYSTEM_FOLDERS if folder not in folders]
    os.environ["PATH"] = os.pathsep.join(folders)


def _require(packages: dict[str, str]) -> None:
    """Install the packages of the programs that are missing, or say what to install."""
    if not sys.platform.startswith("linux"):
        raise VcanUnavailable("needs Linux: SocketCAN exists nowhere else")
    missing = sorted({package for program, package in packages.items() if shutil.which(program) is None})
    if not missing:
        return
    advice = f"apt-get install {' '.join(missing)}"
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        raise VcanUnavailable(f"programs are missing; as root: {advice}")
    sys.stderr.write(f"vcan: {advice} (once, about a minute)\n")
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    for step in (["update"], ["install", "-y", "--no-install-recommends", *missing]):
        words = ["apt-get", "-q", *step]
        result = subprocess.run(words, env=environment, capture_output=True, text=True, check=False)
        if result.returncode:
            last_line = (result.stderr.strip() or "no message").splitlines()[-1]
            raise VcanUnavailable(f"{' '.join(words[:3])} failed: {last_line}")


def _namespace_command() -> list[str]:
    privileges = "-nm" if os.geteuid() == 0 else "-rnm"
    # /sys lists the interfaces of the namespace in which it was mounted.
    set_up = (
        f"ip link add {INTERFACE} type vcan && ip link set {INTERFACE} up && ip link set lo up || exit 2; "
        'mount -t sysfs sysfs /sys; exec "$@"'
    )
    return ["unshare", privileges, "sh", "-c", set_up, "vcan"]


def _namespace_works() -> bool:
    """Try it: permission, the CAN family and the vcan driver are all answered at once."""
    probe = "import socket; socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)"
    words = [*_namespace_command(), sys.executable, "-c", probe]
    try:
        result = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    except OSError:
        return False
    return result.returncode == 0


def _run_in_namespace(command: Sequence[str], cwd: Path, limit_s: float, take_stdin: bool) -> int:
    stdin = None if take_stdin else subprocess.DEVNULL
    # A Ctrl-C reaches the command from the terminal; this process only has to outlive it.
    before = signal.signal(signal.SIGINT, lambda *_: None)
    process = subprocess.Popen([*_namespace_command(), *command], cwd=cwd, stdin=stdin)
    before_term = signal.signal(signal.SIGTERM, lambda *_: process.terminate())
    try:
        code = process.wait(timeout=limit_s or None)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        raise VcanUnavailable(f"ended {command[0]} after its limit of {limit_s:g} s") from None
    finally:
        signal.signal(signal.SIGINT, before)
        signal.signal(signal.SIGTERM, before_term)
    return code if code >= 0 else 128 - code


def main(arguments: Sequence[str] | None = None) -> int:
    """Read the command line and run the command."""
    parser = argparse.ArgumentParser(prog="private_vcan", description="run a command with a private vcan0")
    meaning = "end the command after this long; 0: never; default %(default)g"
    parser.add_argument("--limit", type=float, default=LIMIT_S, metavar="SECONDS", help=meaning)
    parser.add_argument("command", nargs=argparse.REMAINDER, metavar="COMMAND")
    options = parser.parse_args(arguments)
    command = options.command[1:] if options.command[:1] == ["--"] else options.command
    if not command:
        parser.error("say which command to run, for example: private_vcan candump vcan0")
    return run_with_vcan(command, limit_s=options.limit)


if __name__ == "__main__":
    sys.exit(main())
