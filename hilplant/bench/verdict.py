"""What `hilplant check` says of a bench: all that is wrong with it, or what it amounts to."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from hilplant.bench.assembly import load_bench
from hilplant.bench.summary import summarise, summary_lines
from hilplant.checked_yaml.problems import BenchError, visible


@dataclass(frozen=True, slots=True)
class BenchCheck:
    """Errors and warnings as lines with file and line, what to tell the user, and the figures for programs."""

    problems: list[str]
    lines: list[str]
    figures: dict[str, Any]
    warnings: list[str] = field(default_factory=list)


def verdict_on(name: str | Path) -> BenchCheck:
    """Load a bench, and sum it up if nothing is wrong with it."""
    try:
        bench = load_bench(name)
    except BenchError as error:
        problems = [str(problem) for problem in error.problems]
        return BenchCheck(problems, [f"{visible(str(name))}: {len(problems)} problem(s)"], _figures(problems, []))
    warnings = [str(problem) for problem in bench.warnings]
    doubts = f", but see {len(warnings)} warning(s)" if warnings else ""
    lines = [f"{visible(str(name))}: nothing is wrong{doubts}", *summary_lines(bench)]
    return BenchCheck(
        [], [visible(line) for line in lines], _figures([], warnings) | asdict(summarise(bench)), warnings
    )


def _figures(problems: list[str], warnings: list[str]) -> dict[str, Any]:
    counts = {"problems": len(problems), "warnings": len(warnings)}
    return counts | {"messages": problems, "warning_messages": warnings}
