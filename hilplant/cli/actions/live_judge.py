"""Judges a scenario beside its loop, in a process of its own, and prints each verdict as it falls.

Started by :func:`judging`, which keeps standard input open until the run has ended. Its exit code is the place of the
worst ruling in `ENDS`.
"""

import contextlib
import os
import select
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hilplant.bench import load_bench
from hilplant.cli.voice import Voice
from hilplant.failure import Failure
from hilplant.runtime.follower import Follower
from hilplant.runtime.ring import Ring
from hilplant.runtime.scheduling import stand_back
from hilplant.simulation.scenario import load_scenario
from hilplant.testing.known_signals import database_signals, protections_of
from hilplant.testing.live import LiveJudge
from hilplant.testing.scenario_test import expected, ruling_of, ticks_of
from hilplant.testing.words import line_of
from hilplant.units import SECOND_NS

#: Exit codes from 10 on; others are accidents.
ENDS = ("pass", "fail", "blocked", "inconclusive")
_FIRST_END = 10
_LOOK_S = 0.02
_START_S, _END_S = 60.0, 60.0


class Verdict:
    """What the judge beside the loop said in the end; empty until then."""

    def __init__(self) -> None:
        self.ruling = ""


@contextmanager
def judging(bench_name: str, scenario: Path, ring: Ring, loop_cpu: int | None) -> Iterator[Verdict]:
    """Have a scenario judged while the loop runs that writes this ring; the verdict is there behind the `with`.

    Raises
    ------
    Failure
        For expectations that the bench cannot meet, before anything runs; and when the judge has died.

    """
    ready, tell = os.pipe()
    command = [sys.executable, "-m", __name__, ring.name, str(scenario), bench_name, str(tell)]
    child = subprocess.Popen(
        [*command, "" if loop_cpu is None else str(loop_cpu)],
        stdin=subprocess.PIPE,
        pass_fds=(tell,),
        start_new_session=True,
    )
    os.close(tell)
    verdict = Verdict()
    try:
        with open(ready, encoding="utf-8") as answers:
            there, _, _ = select.select([answers], [], [], _START_S)
            answer = answers.read() if there else ""
        if answer != "ready":
            raise Failure(answer or f"{scenario}: the process that judges did not start")
        yield verdict
    finally:
        if child.stdin is not None:
            child.stdin.close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            child.wait(_END_S)
        if child.poll() is None:
            child.kill()
            child.wait()
    place = child.returncode - _FIRST_END
    if not 0 <= place < len(ENDS):
        raise Failure(f"{scenario}: the process that judges has died; judge the recording instead")
    verdict.ruling = ENDS[place]


def _judge(ring: str, scenario_path: str, bench_name: str, tell: int) -> int:
    bench, scenario, voice = load_bench(bench_name), load_scenario(scenario_path), Voice()
    database = database_signals(bench.sources, protections_of(bench))
    live = LiveJudge(
        expected(scenario, database, bench.step_ns), database, bench.step_ns, ticks_of(scenario, bench.step_ns)
    )
    step_s = bench.step_ns / SECOND_NS
    with contextlib.closing(Follower(ring, history=True)) as follower:
        os.write(tell, b"ready")
        os.close(tell)
        told, ended = set[str](), False
        while not ended:
            there, _, _ = select.select([sys.stdin], [], [], _LOOK_S)
            ended = bool(there) or follower.ended
            for judged in live.look(follower):
                told.add(judged.expectation.place)
                voice.say(line_of(judged, step_s))
        found = live.end()
    for judged in found:
        if judged.expectation.place not in told:
            voice.say(line_of(judged, step_s))
    ruling = ruling_of(found)
    voice.say(f"{scenario.title or scenario.path.stem}: {ruling}")
    return _FIRST_END + ENDS.index(ruling)


def main() -> int:
    """Judge what the arguments name: ring, scenario, bench, where to tell that it is ready, the loop's CPU."""
    ring, scenario, bench, tell, cpu = sys.argv[1:]
    stand_back(int(cpu) if cpu else None)
    try:
        return _judge(ring, scenario, bench, int(tell))
    except Failure as failure:
        os.write(int(tell), str(failure).encode())
        return 2


if __name__ == "__main__":
    sys.exit(main())
