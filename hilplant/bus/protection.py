"""AUTOSAR end-to-end protection: a checksum and an alive counter in each frame.

The checksums come from the `autosar-e2e` library, which has no more than these; the sequence of counters is added
here, and the state machine in :mod:`hilplant.bus.e2e_state`. Source: AUTOSAR Foundation, PRS E2E Protocol.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

from hilplant.bus.e2e_profiles import PROFILES, Profile
from hilplant.bus.e2e_state import FrameCheck, ProtectionError, StateMachine, StateMachineSettings, Trust

__all__ = ["Checker", "Forger", "FrameCheck", "Protection", "ProtectionError", "Protector"]

_DATA_IDS_OF_2 = 16
_BYTE_MAX = 255


@dataclass(frozen=True, slots=True)
class Protection:
    """How one message is protected.

    `profile` is 1, 2, 4, 5, 6, 7 or 11; `length` the frame's bytes; `data_id` the number both ends know
    (profile 2 has `data_id_list`, 16 of them, instead); `offset` the byte at which the header starts;
    `data_id_mode` both, alternating, low or nibble (profile 1), both or nibble (profile 11).
    `max_delta_counter` is the largest step of the counter that is accepted: 1, the default, forgives no lost
    frame, 3 forgives two in a row. Without `state_machine` each frame is judged alone.
    """

    profile: int
    length: int
    data_id: int = 0
    data_id_list: bytes = b""
    offset: int = 0
    max_delta_counter: int = 1
    data_id_mode: str = "both"
    state_machine: StateMachineSettings | None = None

    def __post_init__(self) -> None:
        """Refuse settings that cannot work."""
        if self.profile not in PROFILES:
            known = ", ".join(map(str, PROFILES))
            raise ProtectionError(f"profile must be one of {known}, not {self.profile!r}")
        profile = PROFILES[self.profile]
        _check_identity(self, profile)
        if self.offset < 0 or self.offset + profile.header_bytes > self.length:
            raise ProtectionError(
                f"profile {self.profile} has a header of {profile.header_bytes} bytes, which does not fit in a frame "
                f"of {self.length} bytes at offset {self.offset}"
            )
        if not 1 <= self.max_delta_counter < profile.modulus:
            raise ProtectionError(f"max_delta_counter must be 1 to {profile.modulus - 1}")

    @classmethod
    def from_settings(cls, settings: Mapping[str, Any], length: int) -> Self:
        """Build from the keys of a bench; `length` is the frame's [bytes].

        Raises
        ------
        ProtectionError
            Naming the key, what is wrong with it and what would be right.

        """
        known = [name for name in cls.__dataclass_fields__ if name != "length"]
        for name, value in settings.items():
            if name not in known:
                raise ProtectionError(f"protection has no key '{name}'; it has {', '.join(known)}")
            if name == "data_id_mode" and not isinstance(value, str):
                raise ProtectionError(f"{name} must be a word, not {value!r}")
            if name not in ("data_id_list", "data_id_mode", "state_machine") and type(value) is not int:
                raise ProtectionError(f"{name} must be a whole number, not {value!r}")
        if "profile" not in settings:
            raise ProtectionError(f"profile is missing; it must be one of {', '.join(map(str, PROFILES))}")
        identities = _identities(settings.get("data_id_list", ()))
        machine = settings.get("state_machine")
        built = {
            "data_id_list": identities,
            "length": length,
            "state_machine": None if machine is None else StateMachineSettings.from_settings(machine),
        }
        made = cls(**{**settings, **built})
        if not identities and "data_id" not in settings:
            raise ProtectionError("data_id is missing: the number of this message that both ends know")
        return made

    def reserved_places(self) -> frozenset[int]:
        """Return the places (8 * byte + bit) that the header occupies, where no signal may lie."""
        profile = PROFILES[self.profile]
        bits = 8 * profile.header_bytes
        if profile.counter_bits == 4 and self.data_id_mode != "nibble":
            bits -= 4  # the nibble beside the counter is free
        return frozenset(range(8 * self.offset, 8 * self.offset + bits))


def _identities(values: Any) -> bytes:
    whole = isinstance(values, (list, tuple, bytes)) and all(type(v) is int and 0 <= v <= _BYTE_MAX for v in values)
    if not whole:
        raise ProtectionError("data_id_list must be a list of 16 whole numbers from 0 to 255")
    return bytes(values)


def _check_identity(protection: Protection, profile: Profile) -> None:
    if profile.id_bits == 0:
        if len(protection.data_id_list) != _DATA_IDS_OF_2:
            raise ProtectionError("profile 2 needs data_id_list, a list of 16 whole numbers from 0 to 255")
        if protection.offset or protection.data_id:
            raise ProtectionError("profile 2 has its header at offset 0, and data_id_list instead of data_id")
    elif protection.data_id_list:
        raise ProtectionError(f"profile {protection.profile} has data_id; data_id_list is for profile 2")
    elif not 0 <= protection.data_id < 1 << profile.id_bits:
        raise ProtectionError(f"data_id must be 0 to {(1 << profile.id_bits) - 1} for profile {protection.profile}")
    if protection.data_id_mode not in (profile.id_modes or ("both",)):
        modes = ", ".join(profile.id_modes) or "both"
        raise ProtectionError(f"data_id_mode of profile {protection.profile} must be {modes}")


class _Header:
    """A profile with its settings applied: what the checker and the protector share."""

    def __init__(self, protection: Protection) -> None:
        profile = PROFILES[protection.profile]
        self.profile = profile
        self.first = protection.offset + profile.counter_byte
        self.last = self.first + (profile.counter_bits + 7) // 8
        self.mask = (1 << profile.counter_bits) - 1
        self.identity = protection.data_id if profile.id_bits else protection.data_id_list
        self.keywords: dict[str, int] = {"offset": protection.offset} if profile.id_bits else {}
        if profile.id_modes:
            self.keywords["data_id_mode"] = profile.id_modes[protection.data_id_mode]

    def counter(self, data: bytes) -> int:
        """Return the counter in a frame."""
        return int.from_bytes(data[self.first : self.last], "big") & self.mask

    def sign(self, data: bytearray, counter: int) -> None:
        """Write a counter, and the checksum that is right for it, in place."""
        whole = int.from_bytes(data[self.first : self.last], "big") & ~self.mask | counter
        data[self.first : self.last] = whole.to_bytes(self.last - self.first, "big")
        self.profile.protect(data, self.identity, **self.keywords, increment_counter=False)


class Checker:
    """Judges received frames of one message.

    Any counter is good for the first frame, and again after `reset`. From then on it must have moved on since the last
    frame whose checksum was right, used or not, by no more than `max_delta_counter`: PRS E2E Protocol, E2E_PXXCheck, in
    which each such frame's counter becomes the next one's reference. So one lost frame costs one frame more.
    """

    def __init__(self, protection: Protection) -> None:
        self._header = _Header(protection)
        self._max_delta = protection.max_delta_counter
        self._last: int | None = None
        self._machine = StateMachine(protection.state_machine) if protection.state_machine else None

    @property
    def invalid(self) -> bool:
        """Whether the state machine has found that the message is not to be trusted."""
        return self._machine is not None and self._machine.state is Trust.INVALID

    def check(self, data: bytes) -> FrameCheck:
        """Judge a frame."""
        verdict = self._judge(data)
        if self._machine is not None and self._machine.add(verdict) is not Trust.VALID and verdict is FrameCheck.OK:
            return FrameCheck.NOT_VALID
        return verdict

    def reset(self) -> None:
        """Begin anew: the next frame may have any counter. For when frames have stayed away for too long."""
        self._last = None
        if self._machine is not None:
            self._machine.reset()

    def _judge(self, data: bytes) -> FrameCheck:
        header = self._header
        copy = bytearray(data)  # the library's profiles 1 and 11 check nothing that cannot be changed
        if not header.profile.check(copy, header.identity, **header.keywords):
            return FrameCheck.WRONG_CRC
        last, self._last = self._last, header.counter(data)
        if last is not None and not 1 <= (self._last - last) % header.profile.modulus <= self._max_delta:
            return FrameCheck.WRONG_COUNTER
        return FrameCheck.OK


class Protector:
    """Protects the frames of one message, one after the other; the first one's counter is 0."""

    def __init__(self, protection: Protection) -> None:
        self._header = _Header(protection)
        self._counter = 0

    def protect(self, data: bytearray) -> None:
        """Write counter and checksum into a frame, in place."""
        self._header.sign(data, self._counter)
        self._counter = (self._counter + 1) % self._header.profile.modulus


class Forger:
    """Rewrites the counter and the checksum of one message's frames, for faults of the bus."""

    def __init__(self, protection: Protection) -> None:
        self._header = _Header(protection)
        counter = range(8 * (self._header.last - 1), 8 * self._header.last)
        self._checked = max(protection.reserved_places() - frozenset(counter))
        self.modulus = self._header.profile.modulus

    def counter(self, data: bytes) -> int:
        """Return the counter in a frame."""
        return self._header.counter(data)

    def signed(self, data: bytes, counter: int) -> bytes:
        """Return a frame with this counter, and the checksum that is right for it."""
        changed = bytearray(data)
        self._header.sign(changed, counter % self.modulus)
        return bytes(changed)

    def corrupted(self, data: bytes) -> bytes:
        """Return a frame with one bit of its header turned over, not of its counter: no receiver may take it."""
        changed = bytearray(data)
        changed[self._checked // 8] ^= 1 << self._checked % 8
        return bytes(changed)
