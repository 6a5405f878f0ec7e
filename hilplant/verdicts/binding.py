"""Written expectations -> rules in ticks over known signals; a name that nobody knows is a problem with its line."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from hilplant.checked_yaml.problems import BenchError, Problem, suggestion
from hilplant.verdicts import written as w
from hilplant.verdicts.conditions import bounds, condition_of, known_name, level_of
from hilplant.verdicts.expectations import (
    Comes,
    Condition,
    Count,
    Edge,
    Expectation,
    FrameRule,
    Frames,
    Holds,
    Level,
    Response,
    Rule,
    Settles,
    Stays,
    Window,
)
from hilplant.verdicts.known import Known
from hilplant.verdicts.limits import Limits


@dataclass(frozen=True, slots=True)
class Placed:
    """A written expectation with the file and line at which it stands."""

    entry: w.Written
    file: str = "python"
    line: int = 0

    @property
    def place(self) -> str:
        """File and line as messages show them."""
        return f"{self.file}:{self.line}" if self.line else self.file


def bind(placed: Sequence[Placed], known: Known) -> list[Expectation]:
    """Return the expectations in the order in which they stand.

    Raises
    ------
    BenchError
        With every name that nobody knows, and every window that lies beyond the run.

    """
    problems: list[Problem] = []
    bound: list[Expectation] = []
    for each in placed:
        try:
            bound.append(_bound(each, known))
        except ValueError as error:
            problems.append(Problem(each.file, each.line, str(error)))
    if problems:
        raise BenchError(sorted(problems))
    return bound


def _bound(placed: Placed, known: Known) -> Expectation:
    entry = placed.entry
    window = Window(
        tuple(_steps(entry.after, known)), tuple(_steps(entry.until, known)), condition_of(entry.while_ or {}, known)
    )
    rule = _rule(entry, known)
    _refuse_beyond(entry, rule, window, known)
    text = entry.title or entry.text()
    expectation = Expectation(rule, window, text, placed.place)
    return Expectation(rule, window, text, placed.place, _unit(expectation, known))


def _rule(entry: w.Written, known: Known) -> Rule:
    return _RULES[type(entry)](entry, known)


def _holds(entry: w.AlwaysEntry | w.NeverEntry, known: Known) -> Rule:
    return Holds(_subject(entry, known), isinstance(entry, w.NeverEntry))


def _comes(entry: w.WithinEntry, known: Known) -> Rule:
    return Comes(_subject(entry, known), _floor(entry.within, known))


def _edge(entry: w.RisesEntry | w.FallsEntry, known: Known) -> Rule:
    edge = Edge(known_name(entry.subject, known), isinstance(entry, w.RisesEntry), entry.through)
    return Comes((edge,), _floor(entry.within, known))


def _settles(entry: w.SettlesEntry, known: Known) -> Rule:
    limits = Limits(equals=entry.to, tolerance=entry.tolerance)
    hold = None if entry.hold is None else known.ticks(entry.hold)
    return Settles(level_of(entry.settles, limits, known), _floor(entry.by, known), hold)


def _stays(entry: w.StaysEntry, known: Known) -> Rule:
    hold = None if entry.hold is None else known.ticks(entry.hold)
    return Stays(known_name(entry.stays, known), entry.tolerance, hold)


def _response(entry: w.ResponseEntry, known: Known) -> Rule:
    return Response(condition_of(entry.response, known), condition_of(entry.then, known), _floor(entry.within, known))


def _count(entry: w.CountEntry, known: Known) -> Rule:
    return Count(condition_of(entry.count, known), *bounds(entry.limits, 0.0, None))


def _frames(entry: w.FramesEntry, known: Known) -> Rule:
    if entry.frames not in known.messages:
        near = suggestion(entry.frames, known.messages)
        raise ValueError(f"the bench's database has no message '{entry.frames}'{near}")
    message, name = known.messages[entry.frames], entry.rules[0]
    if name in ("jitter_ms", "missing") and not message.cycle_ms:
        raise ValueError(f"the database states no cycle time of {entry.frames}; use period_ms: [LOWEST, HIGHEST]")
    if name in ("counter", "crc") and not message.protected:
        raise ValueError(f"{entry.frames} has no protection in the bench, so that it has no counter and no CRC")
    rule: dict[str, FrameRule] = {"period_ms": "period", "jitter_ms": "jitter"}
    if entry.period_ms is not None:
        return Frames(entry.frames, "period", *entry.period_ms)
    highest = {"jitter_ms": entry.jitter_ms, "missing": entry.missing}.get(name, entry.wrong)
    kind: FrameRule = rule.get(name) or ("missing" if name == "missing" else "counter" if name == "counter" else "crc")
    return Frames(entry.frames, kind, 0.0, float(highest or 0.0))


def _subject(entry: w.Written, known: Known) -> Condition:
    subject = entry.subject
    if isinstance(subject, str):
        return (level_of(subject, entry.limits, known),)
    return condition_of(subject, known)


def _steps(instants: Any, known: Known) -> Iterator[int | Condition]:
    for instant in instants if isinstance(instants, list) else [] if instants is None else [instants]:
        if isinstance(instant, dict):
            yield condition_of(instant, known)
        elif isinstance(instant, str):
            if instant not in known.marks:
                raise ValueError(f"no mark '{instant}'{suggestion(instant, known.marks)}")
            yield known.ticks(known.marks[instant])
        elif isinstance(instant, bool) or instant < 0:
            raise ValueError(f"a time is seconds from the first tick on, not {str(instant).lower()}")
        else:
            yield known.ticks(instant)


def _floor(seconds: float, known: Known) -> int:
    return math.floor(seconds / known.step_s + 1e-6)


def _refuse_beyond(entry: w.Written, rule: Rule, window: Window, known: Known) -> None:
    """Refuse a wait whose end lies beyond the run's, as far as its beginning is known."""
    after = window.after[0] if window.after else 0
    if math.isinf(known.seconds) or not isinstance(after, int) or len(window.after) > 1:
        return
    need = after + _longest(rule)
    if need >= known.ticks(known.seconds):
        raise ValueError(
            f"{entry.key}: its time ends at {need * known.step_s:g} s, the scenario at {known.seconds:g} s; "
            "make the scenario longer"
        )


def _longest(rule: Rule) -> int:
    """Return how many ticks a rule takes from the window's begin; 0 where it takes what there is."""
    if isinstance(rule, Comes):
        return rule.ticks
    if isinstance(rule, Settles):
        return rule.by + (rule.hold or 0)
    return rule.ticks or 0 if isinstance(rule, Stays) else 0


_RULES: dict[type[w.Written], Callable[[Any, Known], Rule]] = {
    w.AlwaysEntry: _holds,
    w.NeverEntry: _holds,
    w.WithinEntry: _comes,
    w.RisesEntry: _edge,
    w.FallsEntry: _edge,
    w.SettlesEntry: _settles,
    w.StaysEntry: _stays,
    w.ResponseEntry: _response,
    w.CountEntry: _count,
    w.FramesEntry: _frames,
}


def _unit(expectation: Expectation, known: Known) -> str:
    rule = expectation.rule
    if isinstance(rule, Frames):
        return "ms" if rule.rule in ("period", "jitter") else "frames"
    if isinstance(rule, Count):
        return "times"
    judged = rule.then if isinstance(rule, Response) else expectation.condition
    units = {known.signals[part.signal].unit if isinstance(part, Level) else "" for part in judged}
    return units.pop() if len(units) == 1 else ""
