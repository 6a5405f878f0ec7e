"""Prints what the examination of this machine found."""

import textwrap

from rich.console import Console
from rich.text import Text

from hilplant.doctor import MachineFinding

_COLOURS = {"ok": "green", "warn": "yellow", "bad": "red"}


def print_findings(findings: list[MachineFinding]) -> None:
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
