"""Run every command of docs/thesis.md, the long ones too, one after the other in one folder.

python tests/run_thesis_page.py --out FOLDER                # half an hour to two hours, by the machine
python tests/run_thesis_page.py --out FOLDER --rows 50,59   # some rows

Where there is no vcan0, commands of the default bench's bus take a bench on a multicast group, which other processes
reach as well. What serves until it is told to end gets a Ctrl-C. A line for each command: rows, exit code, seconds.
At the end: how many rows have each state, and which commands went wrong; exit code 1 if there are any.
"""

import argparse
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from support.thesis_page import PREPARED, ROWS, Row

from hilplant.resources import shipped_root

HILPLANT = (sys.executable, "-m", "hilplant")
GROUP = "239.74.163.2"
BUS_BENCH = f"""extends: default.yaml
name: default on a group
bus:
  interface: {{interface: udp_multicast, channel: {GROUP}, port: 43113}}
"""
#: Commands of a bus; how long they serve [s] where they say no time; those that another process must be there for.
ON_A_BUS = ("run", "control", "ecu")
SERVES_S = 12.0
BESIDE = {"control": "run {bench}", "sequence": "run {bench}", "set": "run {bench} --controller pid"}


def main() -> int:
    """Run them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--rows", default="")
    parser.add_argument("--limit", type=float, default=1800.0, help="longest time of a command [s]")
    given = parser.parse_args()
    wanted = {int(number) for number in given.rows.split(",") if number}
    rows = [row for row in ROWS if not wanted or row.number in wanted]
    folder = _prepared(given.out)
    wrong = []
    for (command, mark), numbers in _commands(rows, folder):
        began = time.monotonic()
        code, last = _run(command, folder, given.limit)
        said = ",".join(map(str, numbers))
        print(f"{said:>12}  {code}  {time.monotonic() - began:7.1f} s  {command}", flush=True)
        if code != (1 if mark == "refused" else 0):
            wrong.append(command)
            print(f"{'':14}{last}", flush=True)
    states = Counter(row.state.partition(":")[0] for row in rows)
    print(", ".join(f"{count} {state}" for state, count in states.items()))
    print(f"{len(wrong)} commands went wrong", *wrong, sep="\n  ")
    return 1 if wrong else 0


def _commands(rows: Sequence[Row], folder: Path) -> Iterator[tuple[tuple[str, str], list[int]]]:
    """Give each command once with its rows; first those that make files for others and are not there yet."""
    missing = [command for command in PREPARED if not (folder / command.split()[-1]).exists()]
    found: dict[tuple[str, str], list[int]] = {(command, ""): [] for command in missing}
    for row in rows:
        for command in row.commands:
            found.setdefault(command, []).append(row.number)
    yield from found.items()


def _prepared(out: Path) -> Path:
    out.mkdir(parents=True, exist_ok=True)
    if not (out / "config").exists():
        (out / "config").symlink_to(shipped_root() / "config")
    (out / "bus.yaml").write_text(BUS_BENCH)
    for recorded in out.glob("*.hilrec"):  # of a run before; a recording is never written over
        recorded.unlink()
    return out


def _run(command: str, folder: Path, limit_s: float) -> tuple[int | str, str]:
    """Return the exit code of one command, and the last line that it said."""
    if not command.startswith("hilplant "):
        return subprocess.run(command, shell=True, cwd=folder, check=False).returncode, ""
    words = shlex.split(command)[1:]
    bench = "default" if Path("/sys/class/net/vcan0").exists() or words[0] == "vcan" else "bus.yaml"
    on_bus = words[0] in ON_A_BUS or (words[0] == "sequence" and "--out" not in words)
    if "--on" in words and bench != "default":
        words = [*words[: words.index("--on")], "--bench", bench, "--on", GROUP]
    if on_bus:
        words = [bench if word == "default" else word for word in words]
    serves = on_bus and not {"--seconds", "--scenario", "--chart"} & set(words) and words[0] != "sequence"
    with _beside(BESIDE.get(words[0], "") if on_bus or words[0] == "set" else "", bench, folder):
        return _ended(words, folder, (SERVES_S if serves or words[0] == "model" else 0.0, limit_s))


def _ended(words: list[str], folder: Path, times: tuple[float, float]) -> tuple[int | str, str]:
    serves_s, limit_s = times
    with (folder / "said.txt").open("w+") as told:
        process = _started(words, folder, told)
        if serves_s:
            _wait_for_word(folder / "said.txt", "", process)
        try:
            code: int | str = process.wait(serves_s or limit_s)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGINT)
            try:
                code = process.wait(60.0)
            except subprocess.TimeoutExpired:
                process.kill()
                code = process.wait()
            code = code if serves_s else f"after {limit_s:g} s"
        told.seek(0)
        lines = [line for line in re.split(r"[\r\n]+", told.read()) if line.strip()]
    return code, lines[-1] if lines else ""


@contextmanager
def _beside(text: str, bench: str, folder: Path) -> Iterator[None]:
    """Have another command there, if one is wanted, until the block ends."""
    if not text:
        yield
        return
    with (folder / "beside.txt").open("w") as told:
        process = _started(text.format(bench=bench).split(), folder, told)
        try:
            _wait_for_word(folder / "beside.txt", "serves on", process)
            yield
        finally:
            process.send_signal(signal.SIGINT)
            process.wait()


def _wait_for_word(path: Path, word: str, process: "subprocess.Popen[bytes]") -> None:
    """Wait until a process has said a word, or anything, or has ended: a busy machine starts it late."""
    until = time.monotonic() + 120.0
    while process.poll() is None and time.monotonic() < until:
        said = path.read_text()
        if said and word in said:
            return
        time.sleep(0.2)


def _started(words: list[str], folder: Path, told: object) -> "subprocess.Popen[bytes]":
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])  # for hilplant in the vcan's machine
    environment = {**os.environ, "PATH": path, "BROWSER": "true", "PYTHONUNBUFFERED": "1"}
    return subprocess.Popen(
        [*HILPLANT, *words],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=told,  # type: ignore[call-overload]
        stderr=subprocess.STDOUT,
        env=environment,
    )


if __name__ == "__main__":
    raise SystemExit(main())
