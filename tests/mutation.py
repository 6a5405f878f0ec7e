"""Change the code in one place at a time and see whether a test notices: which changes live, the tests do not cover.

python tests/mutation.py --mutants 100 --seed 1 [--room models] [--near]

Works on a copy of the checkout. A mutant of the models is tried first with nothing compiled, in a fork of a process
that has the libraries loaded: most are killed within seconds. Where that comes to no end in time, it is tried compiled,
in a new process; where all tests pass, also on those that Python is too slow for. Other code is never compiled: its
mutants run at once with the models compiled as they are. The same seed and number give the same mutants of the same
code. Each that lives is printed with file, line and change, to be killed by a test or argued to change nothing. One
whose compiled tests come to no end is killed only where the same tests without it take a fraction of that time; else
it is slow, not counted. Exit code 1 when a mutant lives or is slow.
"""

import argparse
import importlib
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from mutants import Mutant, mutants_of

ROOT = Path(__file__).resolve().parents[1]
MODELS = ROOT / "hilplant" / "models"
#: The rooms, or files, whose code is changed, and the tests that have to notice (names of test files begin so).
ROOMS = {
    "models": "models park motor plant networks surrogates dynamics_reduction terminals heat linkage_faults obstacles "
    "wear wiper_under every_fault faults supply warm_stall random_ticks",
    "bus/protection.py": "bus loop mutants",
    "bus/codec.py": "bus mutants",
    "runtime/loop.py": "loop ring daemon velocity mutants channel controller faults scenario_on virtual_time fast",
    "ecu": "ecu mutants velocity wanted shipped faults",
}
TESTS = ("unit", "property", "oracle", "scenario")
#: These start processes, or search for minutes: they are not of use here. Those are of use only when compiled.
LEFT_OUT = ("start", "soak", "daemon", "surrogates_search", "ecu_random_search", "processes")
COMPILED = ("in_c", "against_solver")
LIBRARIES = "numpy scipy.optimize scipy.integrate numba can cantools pydantic yaml pyarrow typer e2e hypothesis pytest"
#: CPU time of one mutant's tests at which they end [s], with nothing compiled, with a mutant compiled, with the models
#: compiled as they are; by the clock 5 times that.
LONGEST_S, LONGEST_COMPILED_S, LONGEST_AS_THEY_ARE_S, LONGEST_WAIT = 30, 600, 240, 5
#: Tests that come to no end have found the mutant if without it they take less than this share of the longest time.
QUICK_SHARE = 0.25
CACHE = "compiled"
KILLED, LIVES, SLOW = "killed", "LIVES", "slow"


def chosen(rooms: list[str], number: int, seed: int) -> list[Mutant]:
    """Draw mutants: first a room, then one of its changes, so that small rooms get their share."""
    chance, pools = random.Random(seed), {}
    for room in rooms:
        path = ROOT / "hilplant" / room
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        pools[room] = [mutant for file in files for mutant in mutants_of(file)]
        chance.shuffle(pools[room])
    drawn: list[Mutant] = []
    while len(drawn) < number and any(pools.values()):
        room = chance.choice([name for name, pool in pools.items() if pool])
        drawn.append(pools[room].pop())
    return drawn


class Trial(NamedTuple):
    """A run of tests: whether all passed, whether it came to an end by itself, its share of the longest time."""

    passed: bool
    ended: bool
    share: float


def tests_for(file: Path, near: bool = False) -> list[str]:
    """Return the test files that have to notice a change of a file, those that name its module first, or `near` alone.

    Near are those that name the module; where none does, those of its room that are unit tests.
    """
    name = file.relative_to(ROOT / "hilplant").as_posix()
    words = tuple(next(words for room, words in ROOMS.items() if name.startswith(room)).split())
    module = "hilplant." + name.removesuffix(".py").replace("/", ".")
    written = {path for folder in TESTS for path in (ROOT / "tests" / folder).glob("test_*.py")}
    useful = {path for path in written if not any(word in path.stem for word in LEFT_OUT)}
    naming = {path for path in useful if f"{module} import" in path.read_text(encoding="utf-8")}
    of_room = {path for path in useful if path.stem.removeprefix("test_").startswith(words)}
    ordered = sorted(
        naming | of_room, key=lambda path: (path not in naming, TESTS.index(path.parent.name), path.stat().st_size)
    )
    if near:
        ordered = [path for path in ordered if path in naming or (not naming and path.parent.name == "unit")]
    return [path.relative_to(ROOT).as_posix() for path in ordered]


class Copy:
    """A copy of the checkout in which one change at a time is tried."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._clean: dict[tuple[str, ...], Trial] = {}
        shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(".*", "__pycache__"))

    def clean(self, tests: list[str], longest_s: int) -> Trial:
        """Run tests without a change, compiled, once for all."""
        if tuple(tests) not in self._clean:
            self._clean[tuple(tests)] = _ran(tests, self._folder, longest_s)
        return self._clean[tuple(tests)]

    def verdict(self, mutant: Mutant, tests: list[str], turn: int) -> str:
        """Put a change in, run the tests, take it out again."""
        changed = self._folder / mutant.file.relative_to(ROOT)
        whole = changed.read_text(encoding="utf-8")
        changed.write_text(mutant.text, encoding="utf-8")
        os.utime(changed, (turn, turn))  # compiled bytes of an earlier turn are known as old
        longest_s = _longest_compiled_s(mutant.file)
        try:
            trial = self._model_tried(tests) if _is_model(mutant.file) else _ran(tests, self._folder, longest_s)
        finally:
            changed.write_text(whole, encoding="utf-8")
        if trial.ended:
            return LIVES if trial.passed else KILLED
        clean = self.clean(tests, longest_s)
        return KILLED if clean.passed and clean.share < QUICK_SHARE else SLOW

    def _model_tried(self, tests: list[str]) -> Trial:
        slow = [test for test in tests if any(word in test for word in COMPILED)]
        trial = _ran([test for test in tests if test not in slow], self._folder, LONGEST_S, compiled=False)
        if trial.ended and not (trial.passed and slow):
            return trial
        try:
            return _ran(slow if trial.passed else tests, self._folder, LONGEST_COMPILED_S)
        finally:  # what was compiled of this mutant is of use to no other
            shutil.rmtree(self._folder.parent / CACHE, ignore_errors=True)


def _ran(tests: list[str], copy: Path, longest_s: int, compiled: bool = True) -> Trial:
    """Run tests in a fork; compiled, in a new process, with what is compiled beside the copy."""
    child = os.fork()
    if child == 0:
        os.setsid()
        os.chdir(copy)
        sys.path.insert(0, str(copy))
        os.environ["PYTHONPATH"] = str(copy)
        resource.setrlimit(resource.RLIMIT_CPU, (longest_s, longest_s + 1))
        silence = os.open(os.devnull, os.O_RDWR)
        for number in (0, 1, 2):
            os.dup2(silence, number)
        options = ["-q", "-x", "-p", "no:cacheprovider", "-m", "not vcan and not browser", "-o", "timeout=0", *tests]
        if compiled:
            os.environ |= {"NUMBA_DISABLE_JIT": "0", "XDG_CACHE_HOME": str(copy.parent / CACHE)}
            os.execv(sys.executable, [sys.executable, "-m", "pytest", *options])
        os._exit(int(importlib.import_module("pytest").main(options)))
    begin_s, broken_off = time.monotonic(), False
    while not (found := os.wait4(child, os.WNOHANG))[0]:
        if not broken_off and time.monotonic() - begin_s > LONGEST_WAIT * longest_s:
            os.killpg(child, signal.SIGKILL)
            broken_off = True
        time.sleep(0.05)
    _, status, usage = found
    cpu_s, on_clock_s = usage.ru_utime + usage.ru_stime, time.monotonic() - begin_s
    share = max(cpu_s, on_clock_s / LONGEST_WAIT) / longest_s
    return Trial(status == 0, os.WIFEXITED(status), share)


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--mutants", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", choices=list(ROOMS), help="this room alone")
    parser.add_argument("--near", action="store_true", help="only tests that name the module: quick, stricter")
    parser.add_argument("--check", action="store_true", help="first see that all tests pass without a mutant")
    parser.add_argument("--list", action="store_true", help="list the mutants, run nothing")
    options = parser.parse_args()
    drawn = chosen([options.room] if options.room else list(ROOMS), options.mutants, options.seed)
    if options.list:
        print(*(f"{_place(mutant)}: {_change(mutant)}" for mutant in drawn), sep="\n")
        return 0
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    for library in LIBRARIES.split():
        importlib.import_module(library)
    verdicts: list[str] = []
    with tempfile.TemporaryDirectory(prefix="hilplant-mutants-") as folder:
        copy = Copy(Path(folder) / "copy")
        tests_of = {mutant.file: tests_for(mutant.file, options.near) for mutant in drawn}  # those that the copy has
        for file, tests in tests_of.items() if options.check else ():
            if not (trial := copy.clean(tests, _longest_compiled_s(file))).passed:
                how = "fail" if trial.ended else "come to no end"
                sys.exit(f"these {how} without a mutant: {' '.join(tests)}")
        for turn, mutant in enumerate(drawn, 1):
            verdicts.append(copy.verdict(mutant, tests_of[mutant.file], turn))
            print(f"{verdicts[-1]:<7} {_place(mutant)}: {_change(mutant)}", flush=True)
    alive, slow = verdicts.count(LIVES), verdicts.count(SLOW)
    print(f"{verdicts.count(KILLED)} killed, {alive} alive, of {len(drawn) - slow}; {slow} slow, not counted")
    return 1 if alive or slow else 0


def _is_model(file: Path) -> bool:
    return MODELS in file.parents


def _longest_compiled_s(file: Path) -> int:
    return LONGEST_COMPILED_S if _is_model(file) else LONGEST_AS_THEY_ARE_S


def _place(mutant: Mutant) -> str:
    return f"{mutant.file.relative_to(ROOT)}:{mutant.line}"


def _change(mutant: Mutant) -> str:
    return f"{mutant.before.splitlines()[0]}  ->  {mutant.after.splitlines()[0]}"


if __name__ == "__main__":
    sys.exit(main())
