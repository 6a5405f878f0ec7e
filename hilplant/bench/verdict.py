"""What `hilplant check` says of a bench: all that is wrong with it, or what it amounts to."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hilplant.bench.assembly import load_bench
from hilplant.bench.summary import summarise, summary_lines
from hilplant.checked_yaml.problems import BenchError


@dataclass(frozen=True, slots=True)
class Verdict:
    """Problems as lines with file and line, what to tell the user, and the figures for programs."""

    problems: list[str]
    lines: list[str]
    figures: dict[str, Any]


def verdict_on(name: str | Path) -> Verdict:
    """Load a bench, and sum it up if nothing is wrong with it."""
    try:
        bench = load_bench(name)
    except BenchError as error:
        problems = [str(problem) for problem in error.problems]
        return Verdict(problems, [f"{name}: {len(problems)} problem(s)"], _figures(problems))
    return Verdict([], [f"{name}: nothing is wrong", *summary_lines(bench)], _figures([]) | asdict(summarise(bench)))


def _figures(problems: list[str]) -> dict[str, Any]:
    return {"problems": len(problems), "messages": problems}
