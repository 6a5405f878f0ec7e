"""A measurement in a process of its own: its figures come back as one marked line of its output."""

import json
import subprocess
import sys
from collections.abc import Sequence
from typing import Any

from hilplant.perf.results import NotMeasurable

_MARK = "hilplant-perf "


def figures_of(module: str, *arguments: str, inside: Sequence[str] = ()) -> dict[str, Any]:
    """Run a module of this package, `inside` another command if given, and return what it handed back."""
    command = [*inside, sys.executable, "-m", module, *arguments]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    for line in ended.stdout.splitlines():
        if line.startswith(_MARK):
            figures: dict[str, Any] = json.loads(line.removeprefix(_MARK))
            return figures
    said = ended.stderr.strip() or f"no figures, exit code {ended.returncode}"
    raise NotMeasurable(said.splitlines()[-1].removeprefix(f"{NotMeasurable.__module__}.NotMeasurable: "))


def hand_back(figures: dict[str, Any]) -> None:
    """Give figures to the process that started this one."""
    sys.stdout.write(_MARK + json.dumps(figures) + "\n")
