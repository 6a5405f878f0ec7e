"""Random mutations of benches, scenarios, databases and recordings: read, or refused with every problem in one line.

`python tests/fuzz/written_files.py 5000` runs that many cases and exits with 1 when one of them did anything else. A
recording is mutated where one is named after the seed: `written_files.py 500 1 run.arrow`.
"""

import random
import resource
import signal
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import FrameType

from measurement_files import LONGEST_S, MOST_KIB, mutated

from hilplant.bench import check_bench
from hilplant.bus.database import load_sound
from hilplant.checked_yaml.problems import BenchError
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.resources import shipped
from hilplant.simulation.scenario import load_scenario

#: A word of YAML in place of another is more telling than a changed byte.
WORDS = (
    "1e308",
    "-1",
    "0",
    "[]",
    "{}",
    "null",
    "true",
    "9" * 300,
    "[[0, 1e400]]",
    "on",
    "'\\e[31m'",
    "*a",
    "&a [*a]",
    "x",
)


def rewritten(content: bytes, rng: random.Random) -> bytes:
    """Replace a few words of a text."""
    words = content.split(b" ")
    for _ in range(rng.choice((1, 1, 2, 4))):
        words[rng.randrange(len(words))] = rng.choice(WORDS).encode()
    return b" ".join(words)


def kinds(recordings: list[Path]) -> list[tuple[list[Path], Callable[[Path], None]]]:
    """Return the good files of each kind, and what reads one of them."""
    scenarios = [*shipped("config", "scenarios").glob("*.yaml"), *shipped("config", "tests").glob("*.yaml")]
    found: list[tuple[list[Path], Callable[[Path], None]]] = [
        (sorted(shipped("config", "benches").glob("*.yaml")), _bench),
        (sorted(scenarios), load_scenario),  # type: ignore[list-item]
        ([shipped("dbc", "wiper.dbc"), *sorted((Path(__file__).parents[1] / "data" / "bus").iterdir())], _database),
    ]
    return [*found, (recordings, _recording)] if recordings else found


def _bench(path: Path) -> None:
    for problem in check_bench(path):
        if "\n" in str(problem):
            raise AssertionError(f"more than a line: {problem}")


def _database(path: Path) -> None:
    load_sound(path)


def _recording(path: Path) -> None:
    for _ in read_recording(path).batches():
        pass


def _peak_kib() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def run(cases: int, seed: int, recordings: list[Path] | None = None, say: Callable[[str], None] = print) -> int:
    """Run that many cases; return how many ended in anything but a result or one line for each problem."""
    wrong = read = 0
    began = time.monotonic()
    before = _peak_kib()  # of what this process did before
    signal.signal(signal.SIGALRM, _too_long)
    choices = kinds(recordings or [])
    with tempfile.TemporaryDirectory() as name:
        for case in range(cases):
            rng = random.Random(seed * 1_000_003 + case)
            files, read_one = rng.choice(choices)
            good = rng.choice(files)
            path = Path(name) / f"x{good.suffix}"
            change = rewritten if good.suffix == ".yaml" and rng.random() < 0.6 else mutated
            path.write_bytes(change(good.read_bytes(), rng))
            signal.alarm(LONGEST_S)
            try:
                read_one(path)
                read += 1
            except BenchError:
                pass
            except Failure as error:
                if "\n" in str(error):
                    wrong += 1
                    say(f"case {case} ({good.name}): more than a line: {error}")
            except BaseException as error:
                wrong += 1
                say(f"case {case} ({good.name}): {type(error).__name__}: {str(error)[:200]}")
            finally:
                signal.alarm(0)
    memory = _peak_kib() - before
    say(f"{cases} cases in {time.monotonic() - began:.0f} s: {read} read, {wrong} wrong; {memory // 1024} MiB")
    return wrong + (memory > MOST_KIB)


def _too_long(number: int, frame: FrameType | None) -> None:
    raise TimeoutError(f"longer than {LONGEST_S} s")


if __name__ == "__main__":
    arguments = sys.argv[1:]
    raise SystemExit(
        bool(run(int(arguments[0]), int((arguments[1:] or ["0"])[0]), [Path(each) for each in arguments[2:]]))
    )
