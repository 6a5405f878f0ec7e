"""What of this machine helps or hinders real time and CAN, with the command that fixes it."""

from collections.abc import Callable, Iterable
from pathlib import Path

from hilplant.doctor import can_bus, installation, real_time
from hilplant.doctor.finding import MachineFinding

__all__ = ["MachineFinding", "examine"]

Check = Callable[[Path], Iterable[MachineFinding]]
_CHECKS: tuple[Check, ...] = (*can_bus.CHECKS, *real_time.CHECKS, *installation.CHECKS)


def examine(root: Path = Path("/")) -> list[MachineFinding]:
    """Examine this machine; `root` is where ``proc``, ``sys`` and ``dev`` are. Changes nothing."""
    findings: list[MachineFinding] = []
    for check in _CHECKS:
        try:
            findings.extend(check(root))
        except (OSError, AttributeError, ValueError, ImportError) as error:
            name = check.__name__.replace("_", " ")
            findings.append(MachineFinding(name, "warn", f"cannot be examined here: {error}"))
    return findings
