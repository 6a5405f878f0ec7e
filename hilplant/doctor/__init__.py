"""What of this machine helps or hinders real time and CAN, with the command that mends it."""

import textwrap
from collections.abc import Callable, Iterable
from pathlib import Path

from rich.console import Console
from rich.text import Text

from hilplant.doctor import can_bus, installation, real_time
from hilplant.doctor.finding import Finding

__all__ = ["Finding", "examine", "print_findings"]

Check = Callable[[Path], Iterable[Finding]]
_CHECKS: tuple[Check, ...] = (*can_bus.CHECKS, *real_time.CHECKS, *installation.CHECKS)
_COLOURS = {"ok": "green", "warn": "yellow", "bad": "red"}


def examine(root: Path = Path("/")) -> list[Finding]:
    """Examine this machine; `root` is where ``proc``, ``sys`` and ``dev`` are. Changes nothing."""
    findings: list[Finding] = []
    for check in _CHECKS:
        try:
            findings.extend(check(root))
        except (OSError, AttributeError, ValueError, ImportError) as error:
            name = check.__name__.replace("_", " ")
            findings.append(Finding(name, "warn", f"cannot be examined here: {error}"))
    return findings


def print_findings(findings: list[Finding]) -> None:
    """Show the findings on stdout, one to a line where no terminal is to be fitted, each command whole to be copied."""
    console = Console(highlight=False)
    width = max(len(finding.name) for finding in findings)
    indent = " " * (len("warn ") + width + 2)
    for finding in findings:
        state = Text(f"{finding.state:<5}", style=_COLOURS[finding.state])
        what = finding.what
        if console.is_terminal:
            what = f"\n{indent}".join(textwrap.wrap(what, max(30, console.width - len(indent)), break_long_words=False))
        console.print(state, f"{finding.name:<{width}}  {what}", sep="", soft_wrap=True, markup=False)
        if finding.mend_command:
            console.print(f"     $ {finding.mend_command}", style="bold", soft_wrap=True, markup=False)
