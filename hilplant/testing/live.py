"""Judges a scenario while its loop runs, from the ring: each verdict as soon as no later tick can change it."""

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from hilplant.arrays import Flags, Floats
from hilplant.runtime import commands as c
from hilplant.runtime.follower import Follower
from hilplant.runtime.frame_slot import ERROR, EXTENDED, REMOTE
from hilplant.runtime.loop import STOPPED
from hilplant.testing.evidence import LOSSES, MODE, checked_frames, column_of, value_of
from hilplant.testing.known_signals import DatabaseSignals
from hilplant.testing.scenario_test import Judged
from hilplant.units import SECOND_NS
from hilplant.verdicts.arrays import begin_hidden
from hilplant.verdicts.expectations import Expectation, Frames
from hilplant.verdicts.frames import FrameTimes, judge_frames
from hilplant.verdicts.judgement import LOST, NO_WINDOW, Judgement
from hilplant.verdicts.ticks import LiveExpectation, LiveWindow


class LiveJudge:
    """The expectations of a scenario of `ticks`, on a loop of `step_ns` that goes on.

    Time 0 is where the scenario began to be played; it keeps of each tick what is asked for and nothing else.
    """

    def __init__(self, expectations: list[Expectation], database: DatabaseSignals, step_ns: int, ticks: int) -> None:
        self._step_ns, self._ticks = step_ns, ticks
        names = dict.fromkeys(name for each in expectations for name in each.signals)
        self._columns = {name: column for name in names if (column := column_of(name)) is not None}
        self._coded = {name: database.signals[name] for name in names if name not in self._columns}
        self._frames = {
            each.rule.message: _Seen(database.messages[each.rule.message])
            for each in expectations
            if isinstance(each.rule, Frames)
        }
        self._database = database
        self._values = dict.fromkeys(names, math.nan)
        self._waiting: list[Any] = []
        self._live = {each: LiveExpectation(each) for each in expectations if not isinstance(each.rule, Frames)}
        self._windows = {each: LiveWindow(each.window) for each in expectations if isinstance(each.rule, Frames)}
        self._order, self._told = expectations, set[int]()
        self._start: int | None = None
        self._step, self._losses = 0, np.zeros(len(LOSSES))
        self._unseen: list[int] = []
        self._hidden = False

    def look(self, follower: Follower) -> Iterator[Judged]:
        """Take what is new; gives each expectation that is decided now."""
        rows, frames, events = follower.rows(), follower.frames(), follower.events()
        self._hidden = self._hidden or bool(rows.lost or frames.lost)
        for event in events.records:
            if event["kind"] == c.START and self._start is None:
                self._start = int(event["time_ns"]) // self._step_ns
        self._waiting.extend(frames.records)
        for row in rows.records:
            self._take(row)
        for place, each in enumerate(self._order):
            if place not in self._told and each in self._live and (self._live[each].decided or self._live[each].failed):
                self._told.add(place)
                yield Judged(each, self._live[each].judgement_now())

    def end(self) -> list[Judged]:
        """Return the verdict on each expectation, in their order: the run is over."""
        seen = np.ones(self._step, np.bool_)
        seen[self._unseen] = False
        return [Judged(each, self._ended(each, seen)) for each in self._order]

    def _ended(self, expectation: Expectation, seen: Flags) -> Judgement:
        if expectation in self._live:
            return self._live[expectation].end()
        assert isinstance(expectation.rule, Frames)  # the others are judged tick by tick
        window = self._windows[expectation]
        if begin_hidden(expectation.window, window.first, seen):
            return Judgement("inconclusive", reason=LOST)
        first, last = window.bounds(self._step)
        if first is None:
            return Judgement("blocked", reason=NO_WINDOW)
        message = expectation.rule.message
        times = {message: self._frames[message].times(self._database, message, self._step)}
        return judge_frames(expectation.rule, times, (first, last), self._step_ns / SECOND_NS, seen)

    def _take(self, row: Floats) -> None:
        """Take a row, with the frames up to it, and the ticks that are missing before it."""
        place = round(float(row[1]) / self._step_ns)
        values = dict(self._values)
        self._decode(int(row[0]))
        lost = bool((row[LOSSES] != self._losses).any()) or self._hidden
        self._losses = row[LOSSES].copy()
        started = self._start is not None and place >= self._start
        step = place - self._start if started and self._start is not None else -1
        while self._step < min(step, self._ticks):
            self._feed(values, False)
        if row[MODE] == STOPPED or step >= self._ticks:
            return
        for name, column in self._columns.items():
            self._values[name] = float(row[column])
        if not started:
            return
        self._feed(self._values, not lost)
        self._hidden = False

    def _feed(self, values: Mapping[str, float], seen: bool) -> None:
        if not seen:
            self._unseen.append(self._step)
        row = dict(values)
        for live in self._live.values():
            live.take(row, seen)
        for window in self._windows.values():
            window.take(row)
        self._step += 1

    def _decode(self, tick: int) -> None:
        """Take the frames of this tick and of those before it."""
        count = next((place for place, each in enumerate(self._waiting) if each["tick"] > tick), len(self._waiting))
        taken, self._waiting = self._waiting[:count], self._waiting[count:]
        for each in taken:
            if each["flags"] & (REMOTE | ERROR):
                continue
            key = int(each["identifier"]), bool(each["flags"] & EXTENDED)
            data = each["data"][: each["length"]].tobytes()
            for name, (message, signal) in self._coded.items():
                if key == (message.frame_id, message.is_extended_frame):
                    value = value_of(message, data, signal.name)
                    self._values[name] = self._values[name] if value is None else value
            for seen in self._frames.values():
                if key == seen.key:
                    seen.places.append(int(each["time_ns"]) // self._step_ns - (self._start or 0))
                    seen.payloads.append(data)


class _Seen:
    """The frames of a message that a rule is about."""

    def __init__(self, message: Any) -> None:
        self.key = message.frame_id, message.is_extended_frame
        self.cycle_ms = float(message.cycle_time or 0.0)
        self.places: list[int] = []
        self.payloads: list[bytes] = []

    def times(self, database: DatabaseSignals, name: str, count: int) -> FrameTimes:
        counter, crc = checked_frames(database.protections.get(name), self.payloads)
        ticks = np.array(self.places, np.int64)
        kept = (ticks >= 0) & (ticks < count)
        counter, crc = (found[kept] if len(found) else found for found in (counter, crc))
        return FrameTimes(ticks[kept], self.cycle_ms, counter, crc)
