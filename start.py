#!/usr/bin/env python3
"""Set up and start: makes a Python environment beside this file when there is none, then does what is asked.

python3 start.py demo                 any command of hilplant
python3 start.py test [ARGUMENT...]   all checks and tests; arguments go to pytest
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TextIO
from xml.etree import ElementTree

HERE = Path(__file__).resolve().parent
VENV = HERE / ".venv"
STAMP = VENV / "hilplant-installed"
PYTHON = VENV / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
OLDEST = (3, 11)
NEITHER = "not vcan and not browser"
#: A file of tests stays in one process, which its fixtures serve; the files in the order of tests/conftest.py.
ON_ALL_CPUS = ("-n", "auto", "--dist", "loadfile", "--no-loadscope-reorder")


def main(arguments: list[str]) -> int:
    """Prepare the environment, then run the tests or a command of hilplant in it."""
    if sys.version_info < OLDEST:
        return complain(f"Python {OLDEST[0]}.{OLDEST[1]} or newer is needed, this is {sys.version.split()[0]}")
    testing = arguments[:1] == ["test"]
    try:
        prepare(testing)
        if testing and not shutil.which("gcc"):
            install_package("gcc, which compiles what the step is compared with,", "gcc", "libc6-dev")
        if testing and not shutil.which("chromium"):
            install_package("chromium, in which the pages are tested,", "chromium")
    except SetUpError as error:
        return complain(str(error))
    os.environ["PATH"] = f"{PYTHON.parent}{os.pathsep}{os.environ.get('PATH', '')}"
    os.environ["VIRTUAL_ENV"] = str(VENV)
    if testing:
        return run_all_tests(arguments[1:])
    command = [str(PYTHON), "-m", "hilplant", *arguments]
    if os.name == "posix":
        os.execv(command[0], command)  # signals and the exit code are the command's own
    return subprocess.call(command)


class SetUpError(RuntimeError):
    """The environment cannot be made; the text is one line for the user."""


def complain(text: str) -> int:
    """Say in one line what is wrong."""
    print(f"start.py: {text}", file=sys.stderr)
    return 2


def prepare(testing: bool) -> None:
    """Make the environment, or renew it when pyproject.toml, the folder or what is asked of it has changed."""
    wanted = hashlib.sha256((HERE / "pyproject.toml").read_bytes() + str(HERE).encode()).hexdigest()
    installed = STAMP.read_text(encoding="utf-8").split() if STAMP.exists() and PYTHON.exists() else []
    extra = "test" if testing or "test" in installed else "all"
    if installed == [wanted, extra]:
        return
    print(f"start.py: installing hilplant[{extra}] into {VENV} (once, about two minutes) ...", flush=True)
    if installed[:1] != [wanted]:
        make_environment()
    install = [str(PYTHON), "-m", "pip", "install", "-q", "--disable-pip-version-check"]
    install += ["--no-compile"] if testing else []  # the tests import a third of it, and compile that then
    run_quietly([*install, "-e", f"{HERE}[{extra}]"])
    STAMP.write_text(f"{wanted} {extra}\n", encoding="utf-8")


def make_environment() -> None:
    """Make .venv anew; Debian keeps what that needs in a package of its own."""
    try:
        import ensurepip  # noqa: F401
    except ImportError:
        install_package("Python's ensurepip", f"python{sys.version_info[0]}.{sys.version_info[1]}-venv")
    run_quietly([sys.executable, "-m", "venv", "--clear", str(VENV)])


def install_package(what: str, *packages: str) -> None:
    """Install what is missing from Debian's packages, if this is root there; else say which they are."""
    if not (os.name == "posix" and os.geteuid() == 0 and shutil.which("apt-get")):
        raise SetUpError(f"{what} is missing; on Debian or Ubuntu: sudo apt install {' '.join(packages)}")
    os.environ["DEBIAN_FRONTEND"] = "noninteractive"
    run_quietly(["apt-get", "-q", "update"])
    run_quietly(["apt-get", "-q", "install", "-y", "--no-install-recommends", *packages])


def run_quietly(command: list[str]) -> None:
    """Run a step of the set-up; show what it said only when it fails."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if result.returncode:
        print(result.stdout, file=sys.stderr)
        raise SetUpError(f"this failed: {' '.join(command)}")


def run_all_tests(arguments: list[str]) -> int:
    """Run linter, type checker, and the tests: two parts side by side, where one alone would leave a processor idle."""
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the tests have the processors, each process of them one
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)  # they start many processes, each would compile all that it imports
    pytest = ["-m", "pytest", *arguments]
    results = {
        "ruff check": step("ruff check", ["-m", "ruff", "check", "."]),
        "ruff format": step("ruff format", ["-m", "ruff", "format", "--check", "."]),
    }
    before = {"mypy": ["-m", "mypy", "hilplant", "start.py"], "compiled step": ["tests/compile_first.py"]}
    private_vcan = ["-m", "hilplant.vcan.private_vcan", str(PYTHON)]
    counted = {
        "tests in a browser": [*pytest, "-m", "browser", "tests/web"],
        "tests on SocketCAN": [*private_vcan, *pytest, "-m", "vcan", "tests/vcan"],  # all of it on one processor
    }
    with ThreadPoolExecutor() as side_by_side:
        results |= zip(before, side_by_side.map(step, before, before.values()), strict=True)
        os.environ["HILPLANT_COMPILED"] = "1" if results["compiled step"] else ""
        clocked = side_by_side.submit(step_kept, "tests on the clock", [*pytest, "-m", f"clocked and {NEITHER}"])
        results["tests"] = step("tests", [*pytest, *ON_ALL_CPUS, "-m", f"not clocked and {NEITHER}"], stand_back=True)
        results["tests on the clock"] = clocked.result()
        results |= dict(side_by_side.map(run_counted, counted, counted.values()))
    print("\n" + "\n".join(f"{'passed' if good else 'FAILED'}  {name}" for name, good in results.items()))
    return 0 if all(results.values()) else 1


def run_counted(name: str, command: list[str]) -> tuple[str, bool]:
    """Run tests of which none may be missing; what they say is shown when they have ended."""
    with tempfile.TemporaryDirectory(prefix="hilplant-test-") as folder:
        report = Path(folder) / "report.xml"
        passed = step_kept(name, [*command, f"--junitxml={report}"])
        ran, skipped = count(report)
    return f"{name} ({ran} run, {skipped} skipped)", passed and ran > 0 and skipped == 0


def step_kept(name: str, arguments: list[str]) -> bool:
    """Run one part beside another; what it says is shown when it has ended."""
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as said:
        passed = step(name, arguments, said)
        said.seek(0)
        print(said.read(), flush=True)
    return passed


def step(name: str, arguments: list[str], output: TextIO | None = None, stand_back: bool = False) -> bool:
    """Run one part of the checks in the environment, and say at once how it went; `stand_back` for one beside it."""
    print(f"\n=== {name}", flush=True)
    begin = time.monotonic()
    nice = ["nice", "-n", "10"] if stand_back and shutil.which("nice") else []
    command = [*nice, str(PYTHON), *arguments]
    ended = subprocess.run(command, cwd=HERE, stdin=subprocess.DEVNULL, stdout=output, stderr=output, check=False)
    good = ended.returncode == 0
    print(f"=== {name}: {'passed' if good else 'FAILED'} after {time.monotonic() - begin:.0f} s", flush=True)
    return good


def count(report: Path) -> tuple[int, int]:
    """Count the tests in pytest's report: those that ran, those that were skipped."""
    if not report.exists():
        return 0, 0
    suites = list(ElementTree.parse(report).getroot().iter("testsuite"))
    skipped = sum(int(suite.get("skipped", 0)) for suite in suites)
    return sum(int(suite.get("tests", 0)) for suite in suites) - skipped, skipped


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
