"""AUTOSAR's E2E state machine: whether a message as a whole is to be trusted, by the results of its last checks.

Source: AUTOSAR Foundation, PRS E2E Protocol, "E2E state machine" (states NODATA, INIT, VALID, INVALID; E2E_SMCheck,
E2E_SMAddStatus). The names of the settings are those of the system description (ARXML), in small letters. Silence is
judged by the message's timeout, which begins the machine anew; the status NONEWDATA is therefore never entered.
"""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, fields
from enum import Enum
from typing import Any, Self

from hilplant.failure import Failure


class ProtectionError(Failure):
    """Settings of a protection that cannot work; says which and what would be right."""


class FrameCheck(Enum):
    """What a check found."""

    OK = "ok"
    WRONG_CRC = "wrong checksum, data id or length"
    WRONG_COUNTER = "counter repeated or out of sequence"
    NOT_VALID = "good, but the state machine is not valid, or not yet"


class Trust(Enum):
    """States of the machine."""

    NODATA = "no data yet"
    INIT = "init"
    VALID = "valid"
    INVALID = "invalid"


@dataclass(frozen=True, slots=True)
class StateMachineSettings:
    """For each state how many checks count, how many good ones it takes, and how many wrong ones are allowed."""

    window_size_init: int
    window_size_valid: int
    window_size_invalid: int
    min_ok_state_init: int
    max_error_state_init: int
    min_ok_state_valid: int
    max_error_state_valid: int
    min_ok_state_invalid: int
    max_error_state_invalid: int
    clear_from_valid_to_invalid: bool = False

    @classmethod
    def from_settings(cls, settings: Any) -> Self:
        """Build from the keys of a bench.

        Raises
        ------
        ProtectionError
            Naming the key, what is wrong with it and what would be right.
        """
        if not isinstance(settings, Mapping):
            raise ProtectionError("state_machine must have keys of its own, such as window_size_valid")
        known = [field.name for field in fields(cls)]
        for name, value in settings.items():
            if name not in known:
                raise ProtectionError(f"state_machine has no key '{name}'; it has {', '.join(known)}")
            kind = bool if name == known[-1] else int
            if type(value) is not kind:
                raise ProtectionError(
                    f"{name} must be {'true or false' if kind is bool else 'a whole number'}, not {value!r}"
                )
        if missing := [name for name in known[:-1] if name not in settings]:
            raise ProtectionError(f"state_machine lacks {', '.join(missing)}: the system description has them")
        made = cls(**settings)
        made._check()
        return made

    def _check(self) -> None:
        for state in ("init", "valid", "invalid"):
            size = getattr(self, f"window_size_{state}")
            least, most = getattr(self, f"min_ok_state_{state}"), getattr(self, f"max_error_state_{state}")
            if not 1 <= size <= self.window_size_valid:
                raise ProtectionError(f"window_size_{state} must be 1 to window_size_valid, which is the largest")
            if not 1 <= least <= size:
                raise ProtectionError(f"min_ok_state_{state} must be 1 to window_size_{state}")
            if not 0 <= most <= size:
                raise ProtectionError(f"max_error_state_{state} must be 0 to window_size_{state}")


class StateMachine:
    """The state of one message, moved on by each check."""

    def __init__(self, settings: StateMachineSettings) -> None:
        self.state = Trust.NODATA
        self._clear = settings.clear_from_valid_to_invalid
        self._limits = {
            state: (
                getattr(settings, f"window_size_{name}"),
                getattr(settings, f"min_ok_state_{name}"),
                getattr(settings, f"max_error_state_{name}"),
            )
            for state, name in (
                (Trust.NODATA, "init"), (Trust.INIT, "init"), (Trust.VALID, "valid"), (Trust.INVALID, "invalid"),
            )
        }  # fmt: skip
        self._window: deque[FrameCheck] = deque(maxlen=settings.window_size_valid)

    def add(self, verdict: FrameCheck) -> Trust:
        """Enter the result of a check and return the state after it."""
        size, least_ok, most_errors = self._limits[self.state]
        self._window.append(verdict)
        latest = list(self._window)[-size:]
        good = latest.count(FrameCheck.OK) >= least_ok
        bad = latest.count(FrameCheck.WRONG_CRC) > most_errors
        if self.state is Trust.NODATA:
            if verdict is not FrameCheck.WRONG_CRC:
                self.state = Trust.INIT
        elif good and not bad:
            self._enter(Trust.VALID, latest)
        elif self.state is Trust.VALID or (self.state is Trust.INIT and bad):
            self._enter(Trust.INVALID, [] if self._clear and self.state is Trust.VALID else latest)
        return self.state

    def reset(self) -> None:
        """Begin anew."""
        self.state = Trust.NODATA
        self._window.clear()

    def _enter(self, state: Trust, kept: list[FrameCheck]) -> None:
        """Change the state; what lies before the window of the last one does not count in the next."""
        if state is not self.state:
            self.state = state
            self._window.clear()
            self._window.extend(kept)
