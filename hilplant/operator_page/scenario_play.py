"""A scenario on a run that goes on: its inputs, stalk and faults from the page's process, its verdicts as they fall.

Inputs change within 10 ms of their time and are held as by hand; what has to be exact to the tick is run by
`hilplant simulate` or `hilplant test`.
"""

import asyncio
import contextlib
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.channel.client import RunChannel
from hilplant.channel.run_files import column_of
from hilplant.failure import Failure
from hilplant.resources import shipped
from hilplant.runtime.follower import Follower
from hilplant.signals import INPUTS
from hilplant.simulation.scenario import Scenario, load_scenario
from hilplant.testing.known_signals import DatabaseSignals
from hilplant.units import SECOND_NS
from hilplant.verdicts.binding import bind
from hilplant.verdicts.expectations import Expectation, Frames
from hilplant.verdicts.ticks import LiveExpectation

_EVERY_S = 0.01
FOLDERS = ("scenarios", "tests")
_LATER = "judged from a recording: hilplant judge"


class StalkMoves(Protocol):
    """What moves the stalk."""

    def move(self, text: str) -> None:
        """Move it, by a word."""


def known_scenarios() -> list[str]:
    """Return the names of the shipped scenarios, those of tests too."""
    return sorted(path.stem for folder in FOLDERS for path in shipped("config", folder).glob("*.yaml"))


def scenario_named(name: str) -> Scenario:
    """Read a shipped scenario.

    Raises
    ------
    Failure
        When there is none of that name.
    """
    for folder in FOLDERS:
        path = shipped("config", folder, f"{name}.yaml")
        if name in known_scenarios() and path.is_file():
            return load_scenario(path)
    raise Failure(f"there is no scenario '{name[:60]}'")


class Watched:
    """What a scenario expects, judged tick by tick."""

    def __init__(self, scenario: Scenario, bench: Bench) -> None:
        """Bind the expectations to the plant's signals; those about frames are for later."""
        known = DatabaseSignals({}, {}, {}).known(bench.step_ns / SECOND_NS, scenario.seconds, scenario.marks)
        self._judged: list[tuple[Expectation, LiveExpectation]] = []
        self.later: list[str] = []
        for placed in scenario.expect:
            try:
                (found,) = bind([placed], known)
            except Failure:
                self.later.append(placed.place)
                continue
            if isinstance(found.rule, Frames):
                self.later.append(found.text or placed.place)
            else:
                self._judged.append((found, LiveExpectation(found)))
        names = sorted({name for expectation, _ in self._judged for name in expectation.signals})
        self._tick: int | None = None
        self._values: dict[str, float] = {}
        self._places = {name: column_of(name) for name in names}

    def take(self, rows: Floats) -> None:
        """Take the next rows [n, width]; ticks that are missing between them count as lost."""
        for row in rows:
            values = {name: float(row[place]) for name, place in self._places.items()}
            tick = int(row[0])
            lost = 0 if self._tick is None else tick - self._tick - 1
            for _, live in self._judged:
                for _ in range(lost):
                    live.take(self._values, seen=False)
                live.take(values)
            self._tick, self._values = tick, values

    def rows(self, over: bool) -> list[dict[str, Any]]:
        """Return a line for each expectation."""
        found = []
        for expectation, live in self._judged:
            judgement = live.end() if over else live.judgement()
            ruling = judgement.ruling if over else ("fail" if live.failed else "open")
            margin = judgement.robustness if np.isfinite(judgement.robustness) else None
            found.append(
                {
                    "text": expectation.text or expectation.place,
                    "ruling": ruling,
                    "margin": margin,
                    "unit": expectation.unit,
                    "reason": judgement.reason if over else "",
                }
            )
        return [*found, *({"text": text, "ruling": "later", "reason": _LATER} for text in self.later)]


class ScenarioPlay:
    """One scenario at a time."""

    def __init__(self, ring: str, bench: Bench, changed: Callable[[str], None]) -> None:
        """`changed` is told in words what happens."""
        self._ring, self._bench, self._changed = ring, bench, changed
        self._task: asyncio.Task[None] | None = None
        self.told: dict[str, Any] = {}

    def start(self, name: str, channel: RunChannel, stalk: StalkMoves | None) -> None:
        """Begin a scenario.

        Raises
        ------
        Failure
            When it cannot be read, or needs a stalk that is not there.
        """
        scenario = scenario_named(name)
        if scenario.stalk and stalk is None:
            raise Failure(f"{name} moves the stalk, and this run has none")
        rows = scenario.input_rows(self._bench.input_row, self._bench.step_ns)
        watched = Watched(scenario, self._bench)
        self.stop()
        self.told = {
            "name": name,
            "title": scenario.title,
            "seconds": scenario.seconds,
            "at_s": 0.0,
            "state": "running",
        }
        self.told["verdicts"] = watched.rows(False)
        self._task = asyncio.create_task(self._play(scenario, rows, watched, (channel, stalk)))

    def stop(self) -> None:
        """End it where it is."""
        if self._task is not None and not self._task.done():
            self._task.cancel()

    async def _play(
        self, scenario: Scenario, rows: Floats, watched: Watched, by: tuple[RunChannel, StalkMoves | None]
    ) -> None:
        follower = Follower(self._ring)
        state = "stopped"
        channel = by[0]
        try:
            self._changed(f"scenario {self.told['name']} begins")
            await self._run(scenario, rows, (follower, watched), by)
            state = "over"
        except Failure as failure:
            state = f"broken off: {failure}"
        finally:
            follower.close()
            names = [INPUTS[index].name for index in scenario.entries]
            self.told |= {"state": state, "verdicts": watched.rows(True)}
            self._changed(f"scenario {self.told['name']} is {state}")
            with contextlib.suppress(Failure):
                if names:
                    await asyncio.shield(asyncio.to_thread(channel.release, *names))

    async def _run(
        self,
        scenario: Scenario,
        rows: Floats,
        seeing: tuple[Follower, Watched],
        by: tuple[RunChannel, StalkMoves | None],
    ) -> None:
        (follower, watched), (channel, stalk) = seeing, by
        columns = sorted(scenario.entries)
        first = {INPUTS[index].name: _written(index, rows[0, index]) for index in columns}
        begun = await asyncio.to_thread(channel.override, first) if first else int(follower.latest()[0]) + 1
        await self._insert_faults(scenario, channel)
        turns, last = list(scenario.stalk), rows[0]
        while True:
            taken: Floats = follower.rows().records
            watched.take(taken[(taken[:, 0] >= begun) & (taken[:, 0] < begun + len(rows))])
            at = int(follower.latest()[0]) - begun
            self.told |= {"at_s": min(at, len(rows)) * self._bench.step_ns / SECOND_NS, "verdicts": watched.rows(False)}
            if at >= len(rows):
                return
            now = rows[max(at, 0)]
            changed = {INPUTS[i].name: _written(i, now[i]) for i in columns if now[i] != last[i]}
            if changed:
                await asyncio.to_thread(channel.override, changed)
            last = now
            while stalk is not None and turns and turns[0].time_s <= at * self._bench.step_ns / SECOND_NS:
                stalk.move(turns.pop(0).move.words)
            await asyncio.sleep(_EVERY_S)

    async def _insert_faults(self, scenario: Scenario, channel: RunChannel) -> None:
        for written in scenario.faults:
            entry = written[0]
            keys = entry.model_dump(by_alias=True, exclude_defaults=True, exclude={"fault"})
            quantities = keys.pop("with", {})
            await asyncio.to_thread(channel.fault, entry.fault, **{**quantities, **keys})


def _written(index: int, value: float) -> Any:
    return bool(value) if INPUTS[index].kind == "flag" else float(value)
