"""Tests as one page of HTML that needs no other file: summary, each expectation drawn, versions, and how to rerun."""

import hashlib
import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jinja2

from hilplant.atomic_write import write_text
from hilplant.plots.signal_svg import SignalDrawing, signal_svg
from hilplant.recording.metadata import current_build
from hilplant.testing.scenario_test import RULINGS, Judged, ScenarioTest
from hilplant.testing.words import distance, why
from hilplant.verdicts.expectations import Edge, Frames, Holds, Level, Response, Settles, Window


def write_report(path: Path, tests: Sequence[ScenarioTest]) -> None:
    """Write the page, whole or not at all."""
    write_text(path, page_of(tests))


def page_of(tests: Sequence[ScenarioTest]) -> str:
    """Return the page."""
    template = Path(__file__).with_name("report.html.j2").read_text(encoding="utf-8")
    count = Counter(test.ruling for test in tests)
    return (
        jinja2.Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
        .from_string(template)
        .render(
            tests=[_test(number, test) for number, test in enumerate(tests)],
            count=[(ruling, count[ruling]) for ruling in reversed(RULINGS)],
            build=current_build(),
            ruling=next((ruling for ruling in RULINGS if count[ruling]), "pass"),
        )
    )


def _test(number: int, test: ScenarioTest) -> dict[str, Any]:
    stimuli = [f"{turn.time_s:g} s: stalk {_moved(turn.move)}" for turn in test.scenario.stalk]
    stimuli += [f"{time_s:g} s: fault {name}" for name, time_s in test.faults.items()]
    return {
        "id": f"test{number}",
        "test": test,
        "hash": hashlib.sha256(test.scenario.text.encode()).hexdigest()[:16],
        "stimuli": stimuli,
        "expectations": drawn_expectations(test) if test.drawn is None else test.drawn,
        "passed": sum(each.judgement.ruling == "pass" for each in test.judged),
    }


def drawn_expectations(test: ScenarioTest) -> list[dict[str, Any]]:
    """Return what the page shows of each expectation, drawn."""
    return [_expectation(test, each) for each in test.judged]


def _moved(move: Any) -> str:
    if move.press is not None:
        return str(move.press)
    position = "" if move.master is None else move.master.name.lower()
    return f"{position} {move.interval or ''}".strip()


def _expectation(test: ScenarioTest, judged: Judged) -> dict[str, Any]:
    judgement = judged.judgement
    return {
        "text": judged.expectation.text,
        "place": judged.expectation.place,
        "ruling": judgement.ruling,
        "why": why(judged, test.step_s).removeprefix(": "),
        "distance": distance(judged) if judgement.ruling == "pass" else "",
        "svg": "".join(signal_svg(drawing) for drawing in _drawings(test, judged)),
    }


def _drawings(test: ScenarioTest, judged: Judged) -> list[SignalDrawing]:
    """Return the drawings of the signals that an expectation asks about; a rule about frames has none."""
    expectation, judgement = judged.expectation, judged.judgement
    if isinstance(expectation.rule, Frames):
        return []
    rule = expectation.rule
    parts = [*expectation.condition, *(rule.then if isinstance(rule, Response) else ())]
    violation = None if judgement.tick is None or judgement.ruling == "pass" else judgement.tick * test.step_s
    units = {part.signal: "" for part in parts}
    known = test.database.known(test.step_s, test.scenario.seconds, {}).signals
    duration = len(test.evidence.rows) * test.step_s
    window = _window(expectation.window, test.step_s, duration)
    drawn = {part.signal: part for part in reversed(parts)}
    return [
        SignalDrawing(
            name,
            known[name].unit,
            test.step_s,
            test.evidence.signal(name, test.database),
            _limits(drawn[name]) if not isinstance(rule, Settles) else (rule.level.lowest, rule.level.highest),
            window,
            {**test.scenario.marks, **test.faults},
            violation,
            isinstance(rule, Holds) and rule.never,
        )
        for name in units
    ]


def _limits(part: Level | Edge) -> tuple[float, float]:
    return (part.lowest, part.highest) if isinstance(part, Level) else (-math.inf, math.inf)


def _window(window: Window, step_s: float, duration: float) -> tuple[float, float]:
    """Return begin and end as far as they are times."""
    first, last = (steps[0] if steps else None for steps in (window.after, window.until))
    begin = first * step_s if isinstance(first, int) else 0.0
    return begin, last * step_s if isinstance(last, int) else duration
