"""What of this machine helps or hinders real time and CAN, with the command that mends it."""

from collections.abc import Callable, Iterable
from pathlib import Path

from hilplant.doctor import can_bus, installation, real_time
from hilplant.doctor.finding import Finding

__all__ = ["Finding", "examine"]

Check = Callable[[Path], Iterable[Finding]]
_CHECKS: tuple[Check, ...] = (*can_bus.CHECKS, *real_time.CHECKS, *installation.CHECKS)


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
