"""What came of a test in words: one line for each expectation, with where, how far, and what was seen there."""

import math

from hilplant.testing.scenario_test import Judged, ScenarioTest
from hilplant.verdicts.arrays import AROUND


def line_of(judged: Judged, step_s: float) -> str:
    """Return place, ruling, expectation and what decided it."""
    expectation = judged.expectation
    return f"{expectation.place}: {judged.judgement.ruling}: {expectation.text}{why(judged, step_s)}"


def why(judged: Judged, step_s: float) -> str:
    """Return what decided it, beginning with a colon; nothing where nothing did."""
    judgement = judged.judgement
    parts = [judgement.reason] if judgement.reason else []
    if judgement.tick is not None and judgement.ruling != "pass":
        parts.append(f"at {judgement.tick * step_s:.3f} s{_values(judged)}")
    if judgement.ruling == "fail":
        parts.append(distance(judged))
    return ": " + ", ".join(parts) if parts else ""


def distance(judged: Judged) -> str:
    """Return how far from the limit it came, in the signal's unit."""
    robustness, unit = judged.judgement.robustness, judged.expectation.unit
    if not math.isfinite(robustness):
        return "" if math.isnan(robustness) else "no value came"
    unit = f" {unit}" if unit else ""
    side = "beyond" if judged.judgement.ruling == "fail" else "from"
    return f"{abs(robustness):.4g}{unit} {side} the limit"


def _values(judged: Judged) -> str:
    """Return the signals' values in the tick that decided it."""
    judgement, tick = judged.judgement, judged.judgement.tick
    if tick is None or not judgement.values:
        return ""
    place = min(AROUND, tick)
    told = [f"{name} {_short(values[place])}" for name, values in judgement.values.items() if place < len(values)]
    return f" ({', '.join(told)})"


def _short(value: float) -> str:
    return "nothing yet" if math.isnan(value) else f"{value:.5g}"


def lines_of(test: ScenarioTest) -> list[str]:
    """Return the test's line, and below it each expectation that did not pass."""
    passed = sum(each.judgement.ruling == "pass" for each in test.judged)
    head = f"{test.ruling:12s} {test.name} ({passed} of {len(test.judged)} hold)"
    return [head, *(f"    {line_of(each, test.step_s)}" for each in test.judged if each.judgement.ruling != "pass")]
