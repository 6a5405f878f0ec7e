"""AUTOSAR E2E against known frames and a bit-by-bit checksum; what a checker remembers and what it does not."""

from typing import Any

import pytest

from hilplant.bus.e2e_profiles import PROFILES
from hilplant.bus.protection import Checker, FrameCheck, Protection, ProtectionError, Protector

#: First frames of zeros, with counter 0: the examples in the tests of the autosar-e2e library.
PUBLISHED_FRAMES = [
    (Protection(1, 8, data_id=0x123), "cc00000000000000"),
    (Protection(1, 8, data_id=0x123, data_id_mode="alternating"), "ce00000000000000"),
    (Protection(1, 8, data_id=0x123, data_id_mode="low"), "ce00000000000000"),
    (Protection(1, 8, data_id=0x123, data_id_mode="nibble"), "2a10000000000000"),
    (Protection(4, 16, data_id=0x0A0B0C0D), "001000000a0b0c0d862b055600000000"),
    (Protection(4, 24, data_id=0x0A0B0C0D, offset=8), "0000000000000000001800000a0b0c0d69d7502e00000000"),
    (Protection(5, 8, data_id=0x1234), "1cca000000000000"),
    (Protection(5, 16, data_id=0x1234, offset=8), "00000000000000002891000000000000"),
    (Protection(6, 8, data_id=0x1234), "b155000800000000"),
    (Protection(6, 16, data_id=0x1234, offset=8), "00000000000000004eb7001000000000"),
    (Protection(7, 24, data_id=0x0A0B0C0D), "1fb2e737fcedbcd900000018000000000a0b0c0d00000000"),
    (Protection(11, 8, data_id=0x123), "cc00000000000000"),
    (Protection(11, 8, data_id=0x123, data_id_mode="nibble"), "2a10000000000000"),
]

ONE_OF_EACH = [
    Protection(profile, 32, data_id_list=bytes(range(16)))
    if profile == 2
    else Protection(profile, 32, data_id=0x1234, offset=4)
    for profile in PROFILES
]


def frames(protection: Protection, count: int) -> list[bytes]:
    """Return successive protected frames with some content."""
    protector = Protector(protection)
    made = []
    for _ in range(count):
        frame = bytearray(range(protection.length))
        protector.protect(frame)
        made.append(bytes(frame))
    return made


def crc_by_bits(data: bytes, width: int, polynomial: int, start: int) -> int:
    """Return a checksum bit by bit, most significant first."""
    crc = start
    for byte in data:
        crc ^= byte << width - 8
        for _ in range(8):
            crc = (crc << 1) ^ (polynomial if crc >> width - 1 else 0)
            crc &= (1 << width) - 1
    return crc


@pytest.mark.parametrize(("protection", "expected"), PUBLISHED_FRAMES)
def test_the_first_frame_of_zeros_is_the_published_one(protection: Protection, expected: str) -> None:
    frame = bytearray(protection.length)
    Protector(protection).protect(frame)
    assert frame.hex() == expected
    assert Checker(protection).check(bytes(frame)) is FrameCheck.OK


def test_profile_2_equals_the_published_frame() -> None:
    protector = Protector(Protection(2, 8, data_id_list=bytes(16)))
    protector.protect(bytearray(8))
    frame = bytearray(8)
    protector.protect(frame)
    assert frame.hex() == "4501000000000000"


def test_profiles_1_and_5_equal_a_checksum_computed_bit_by_bit() -> None:
    for frame in frames(Protection(1, 8, data_id=0x0ABC), 15):
        assert frame[0] == crc_by_bits(b"\xbc\x0a" + frame[1:], 8, 0x1D, 0)
    for frame in frames(Protection(5, 20, data_id=0x0ABC), 15):
        crc = crc_by_bits(frame[2:] + b"\xbc\x0a", 16, 0x1021, 0xFFFF)
        assert frame[:2] == crc.to_bytes(2, "little")


@pytest.mark.parametrize("protection", ONE_OF_EACH, ids=lambda p: f"profile {p.profile}")
def test_a_long_sequence_is_accepted_and_only_reserved_bits_change(protection: Protection) -> None:
    checker = Checker(protection)
    reserved = protection.reserved_places()
    for frame in frames(protection, 600):
        assert checker.check(frame) is FrameCheck.OK
        changed = int.from_bytes(frame, "little") ^ int.from_bytes(bytes(range(32)), "little")
        assert all(place in reserved for place in range(8 * 32) if changed >> place & 1)


@pytest.mark.parametrize("protection", ONE_OF_EACH, ids=lambda p: f"profile {p.profile}")
def test_every_flipped_bit_is_found(protection: Protection) -> None:
    (frame,) = frames(protection, 1)
    checker = Checker(protection)
    for place in range(8 * len(frame)):
        flipped = bytearray(frame)
        flipped[place // 8] ^= 1 << place % 8
        assert checker.check(bytes(flipped)) is FrameCheck.WRONG_CRC


@pytest.mark.parametrize("protection", ONE_OF_EACH, ids=lambda p: f"profile {p.profile}")
def test_a_repeated_frame_and_the_one_behind_a_lost_one_have_a_wrong_counter(protection: Protection) -> None:
    first, _, third, fourth = frames(protection, 4)
    checker = Checker(protection)
    wanted = [
        (first, FrameCheck.OK),
        (first, FrameCheck.WRONG_COUNTER),
        (third, FrameCheck.WRONG_COUNTER),
        (fourth, FrameCheck.OK),
    ]
    assert [checker.check(frame) for frame, _ in wanted] == [verdict for _, verdict in wanted]


@pytest.mark.parametrize("protection", ONE_OF_EACH, ids=lambda p: f"profile {p.profile}")
@pytest.mark.parametrize("lost", [1, 2, 5, 9])
def test_however_many_frames_are_lost_one_more_is_refused(protection: Protection, lost: int) -> None:
    made = frames(protection, 20)
    checker = Checker(protection)
    heard = [made[0], *made[1 + lost : 16]]
    verdicts = [checker.check(frame) for frame in heard]
    assert verdicts == [FrameCheck.OK, FrameCheck.WRONG_COUNTER, *[FrameCheck.OK] * (len(heard) - 2)]


@pytest.mark.parametrize("profile", [1, 2, 11])
def test_the_nibble_beside_a_short_counter_is_the_signals_own(profile: int) -> None:
    """It changes with each frame, is sent as it was, and the counter is read without it."""
    identity: dict[str, Any] = {"data_id_list": bytes(16)} if profile == 2 else {"data_id": 0x123}
    protection = Protection(profile, 8, **identity)
    protector, checker = Protector(protection), Checker(protection)
    for nibble in (0, 1, 15, 1, 2, 4, 8, 0, 3, 14, 1, 0, 5, 10, 0, 1, 1, 0, 15):
        frame = bytearray([0, nibble << 4, *range(6)])
        protector.protect(frame)
        assert checker.check(bytes(frame)) is FrameCheck.OK
        assert frame[1] >> 4 == nibble


def test_a_wrong_checksum_moves_no_counter() -> None:
    protection = Protection(5, 8, data_id=1)
    first, second = frames(protection, 2)
    checker = Checker(protection)
    broken = bytes([second[0] ^ 1]) + second[1:]
    wanted = [(first, FrameCheck.OK), (broken, FrameCheck.WRONG_CRC), (second, FrameCheck.OK)]
    assert [checker.check(frame) for frame, _ in wanted] == [verdict for _, verdict in wanted]


def test_lost_frames_are_forgiven_up_to_the_largest_step() -> None:
    protection = Protection(5, 8, data_id=1, max_delta_counter=3)
    made = frames(protection, 6)
    for index, verdict in ((3, FrameCheck.OK), (4, FrameCheck.WRONG_COUNTER)):
        checker = Checker(protection)
        checker.check(made[0])
        assert checker.check(made[index]) is verdict


def test_after_a_reset_any_counter_is_good_again() -> None:
    protection = Protection(1, 8, data_id=1)
    made = frames(protection, 9)
    checker = Checker(protection)
    checker.check(made[0])
    assert checker.check(made[8]) is FrameCheck.WRONG_COUNTER
    checker.reset()
    assert checker.check(made[8]) is FrameCheck.OK


@pytest.mark.parametrize(("profile", "header"), [(1, 2), (4, 12), (5, 3), (6, 5), (7, 20), (11, 2)])
@pytest.mark.parametrize("offset", [0, 3, 8])
def test_a_header_that_just_fits_is_taken_and_one_byte_less_refused(profile: int, header: int, offset: int) -> None:
    assert Protection(profile, offset + header, data_id=1, offset=offset).offset == offset
    with pytest.raises(ProtectionError, match="does not fit"):
        Protection(profile, offset + header - 1, data_id=1, offset=offset)


def test_the_free_nibble_beside_a_short_counter_stays_free() -> None:
    assert Protection(1, 8).reserved_places() == frozenset(range(12))
    assert Protection(1, 8, data_id_mode="nibble").reserved_places() == frozenset(range(16))
    assert Protection(5, 8, offset=2).reserved_places() == frozenset(range(16, 40))


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({}, "profile is missing"),
        ({"profile": 3}, "profile must be one of 1, 2, 4, 5, 6, 7, 11, not 3"),
        ({"profile": True}, "profile must be a whole number"),
        ({"profile": 1, "data_id": 0x10000}, "data_id must be 0 to 65535 for profile 1"),
        ({"profile": 1, "crc": 3}, "protection has no key 'crc'; it has profile, data_id"),
        ({"profile": 1, "data_id_mode": "high"}, "data_id_mode of profile 1 must be both, alternating, low, nibble"),
        ({"profile": 5, "data_id_mode": "low"}, "data_id_mode of profile 5 must be both"),
        ({"profile": 1, "max_delta_counter": 15}, "max_delta_counter must be 1 to 14"),
        ({"profile": 4, "data_id": 1}, "header of 12 bytes, which does not fit in a frame of 8 bytes at offset 0"),
        ({"profile": 5, "offset": 6}, "header of 3 bytes, which does not fit in a frame of 8 bytes at offset 6"),
        ({"profile": 2, "data_id": 7}, "profile 2 needs data_id_list"),
        ({"profile": 2, "data_id_list": [1] * 16, "data_id": 7}, "profile 2 has .* data_id_list instead of data_id"),
        ({"profile": 2, "data_id_list": [1] * 16, "offset": 1}, "profile 2 has its header at offset 0"),
        ({"profile": 2, "data_id_list": [1, 2]}, "profile 2 needs data_id_list, a list of 16"),
        ({"profile": 2, "data_id_list": [300] * 16}, "list of 16 whole numbers from 0 to 255"),
        ({"profile": 1, "data_id_list": [1] * 16}, "data_id_list is for profile 2"),
        ({"profile": 1, "data_id": 1, "data_id_mode": ["low"]}, "data_id_mode must be a word"),
        ({"profile": 5}, "data_id is missing"),
    ],
)
def test_wrong_settings_are_refused_with_what_would_be_right(settings: dict[str, Any], words: str) -> None:
    with pytest.raises(ProtectionError, match=words):
        Protection.from_settings(settings, 8)


def test_settings_of_a_bench_become_a_protection() -> None:
    identities = bytes([0, *range(241, 256)])
    settings = {"profile": 2, "data_id_list": list(identities), "max_delta_counter": 2}
    assert Protection.from_settings(settings, 8) == Protection(2, 8, data_id_list=identities, max_delta_counter=2)
