"""Databases of which a part cannot be read: that part is left out and said, the mapped messages work."""

from pathlib import Path

import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.bus.database import DatabaseError, load_database, load_sound, parse_database

HEAD = 'VERSION ""\nNS_ :\n\tCM_\n\tVAL_\nBS_:\nBU_: ECU PLANT\n'
COMMAND = """BO_ 288 Cmd: {length} ECU
 SG_ On : 0|1@1+ (1,0) [0|1] "" PLANT
 SG_ Fast : 1|1@1+ (1,0) [0|1] "" PLANT

"""
DOOR = 'BO_ {} {}: {} ECU\n SG_ Lock : 0|1@1+ (1,0) [0|1] "" PLANT\n\n'
FLAWS = [
    (DOOR.format(274923520, "Door", 8), "Door", "more than 11 bits"),
    (DOOR.format(289, "2024_Door", 8), "2024_Door", "its syntax is not that of a DBC"),
    (DOOR.format(289, "Tür", 8), "Tür", "its syntax is not that of a DBC"),
    ('VAL_ 289 Gone 0 "a" 1 "b" ;\n', None, "VAL_ of 289 Gone, which is not there"),
    ('VAL_ 288 Gone 0 "a" 1 "b" ;\n', None, "VAL_ of 288 Gone, which is not there"),
    ("SIG_VALTYPE_ 289 Gone : 1;\n", None, "SIG_VALTYPE_ of 289 Gone, which is not there"),
]
BENCH = """extends: virtual.yaml
name: x
bus:
  interface: {interface: virtual, channel: a}
  database: x.dbc
  receive: {MESSAGE: {timeout_ms: 20, signals: {On: relay_on, Fast: relay_fast}}}
  send: {}
"""


def bench(folder: Path, text: str, message: str = "Cmd") -> Path:
    (folder / "x.dbc").write_text(text, encoding="cp1252")
    path = folder / "bench.yaml"
    path.write_text(BENCH.replace("MESSAGE", message))
    return path


@pytest.mark.parametrize(("flaw", "name", "reason"), FLAWS)
@pytest.mark.parametrize("first", [True, False])
def test_what_cannot_be_read_is_left_out_and_said(
    tmp_path: Path, flaw: str, name: str | None, reason: str, first: bool
) -> None:
    command = COMMAND.format(length=8)
    comment = 'CM_ BO_ 288 "BO_ 1 in a comment\nVAL_ 7 is none";\nVAL_ 288 On 0 "Off" 1 "On" ;\n'
    parts = [flaw, command] if first and "BO_" in flaw else [command, flaw]
    made = load_bench(bench(tmp_path, "".join([HEAD, *parts, comment])))
    assert made.receive[0].decode(b"\3" + bytes(7)) == (1.0, 1.0)
    (warning,) = made.warnings
    assert warning.line == 5
    assert reason in warning.text
    counts = "0 messages and 1 other entries" if name is None else "1 messages and 0 other entries"
    assert counts in warning.text
    if name is not None and name.isascii():
        (problem,) = check_bench(bench(tmp_path, "".join([HEAD, *parts]), name))
        assert f"message '{name}' cannot be read: " in problem.text


def test_all_flaws_together_and_what_is_said_of_them(tmp_path: Path) -> None:
    about = 'CM_ BO_ 289 "gone";\nBO_TX_BU_ 289 : ECU;\n'
    text = "".join([HEAD, COMMAND.format(length=8), *(flaw for flaw, _, _ in FLAWS), about])
    path = tmp_path / "x.dbc"
    path.write_text(text, encoding="cp1252")
    database, left_out = load_sound(path)
    assert [message.name for message in database.messages] == ["Cmd"]
    assert [each.message for each in left_out if each.message] == [name for _, name, _ in FLAWS if name]
    assert len(left_out) == len(FLAWS) + 2
    assert [message.name for message in parse_database(text, "dbc").messages] == ["Cmd"]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_a_byte_order_mark_is_no_content(tmp_path: Path, encoding: str) -> None:
    path = tmp_path / "x.dbc"
    path.write_text(HEAD + COMMAND.format(length=8).replace('""', '"Ω"' if encoding[0] == "u" else '"µ"'), encoding)
    database, left_out = load_sound(path)
    assert left_out == ()
    assert database.messages[0].signals[0].unit == ("Ω" if encoding[0] == "u" else "µ")


def test_a_file_of_which_nothing_can_be_read_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "x.dbc"
    path.write_text(HEAD + DOOR.format(289, "2024_Door", 8))
    with pytest.raises(DatabaseError, match="cannot be read as a bus database"):
        load_sound(path)


@pytest.mark.parametrize(("length", "fd"), [(8, False), (12, True), (24, True), (64, True)])
def test_a_message_of_more_than_8_bytes_is_an_fd_frame(tmp_path: Path, length: int, fd: bool) -> None:
    (received,) = load_bench(bench(tmp_path, HEAD + COMMAND.format(length=length))).receive
    assert (received.fd, received.length) == (fd, length)


@pytest.mark.parametrize(
    ("length", "keys", "fd", "on_bus"),
    [
        (9, "", True, 12),
        (5, "fd: true,", True, 5),
        (5, "bytes: 8,", False, 8),
        (5, "fd: true, bytes: 16,", True, 16),
        (33, "", True, 48),
    ],
)
def test_frames_are_padded_to_a_length_that_there_is(
    tmp_path: Path, length: int, keys: str, fd: bool, on_bus: int
) -> None:
    path = bench(tmp_path, HEAD + COMMAND.format(length=length))
    path.write_text(path.read_text().replace("{timeout_ms", f"{{{keys} timeout_ms"))
    made = load_bench(path)
    (received,), (sent,) = made.receive, made.ecu_side().send
    assert (received.fd, received.length) == (sent.fd, sent.length) == (fd, on_bus)
    assert received.decode(b"\3" + bytes(on_bus - 1)) == (1.0, 1.0)
    assert len(sent.encode([1.0] * 40)[0]) == on_bus


@pytest.mark.parametrize("padding", [0, 0xFF, 0xAA, 0x55, 0xCC])
@pytest.mark.parametrize(("length", "keys"), [(8, ""), (5, "bytes: 8,"), (9, ""), (5, "fd: true, bytes: 16,")])
def test_what_no_signal_uses_has_the_padding(tmp_path: Path, padding: int, length: int, keys: str) -> None:
    """cantools' own padding is the truth within the database's length; the mapped bits are the first two."""
    path = bench(tmp_path, HEAD + COMMAND.format(length=length))
    path.write_text(path.read_text().replace("{timeout_ms", f"{{{keys} padding: {padding}, timeout_ms"))
    made = load_bench(path)
    (sent,) = made.ecu_side().send
    frame = sent.encode([1.0] * 40)[0]
    message = load_database(path.with_name("x.dbc")).get_message_by_name("Cmd")
    message.unused_bit_pattern = padding
    values = dict.fromkeys((signal.name for signal in message.signals), 0)
    expected = message.encode(values | {"On": 1, "Fast": 1}, padding=True)
    assert frame == expected.ljust(sent.length, bytes([padding]))
    assert made.receive[0].decode(frame) == (1.0, 1.0)


@pytest.mark.parametrize(
    ("length", "keys", "said"),
    [
        (9, "fd: false,", "Cmd: 9 bytes need an FD frame"),
        (9, "bytes: 13,", "Cmd: no FD frame has 13 bytes"),
        (9, "bytes: 8,", "Cmd has 9 bytes in the database, so never 8"),
        (65, "", "Cmd: no FD frame has 65 bytes"),
        (4, "bytes: 9,", "Cmd: 9 bytes need an FD frame"),
    ],
)
def test_lengths_that_no_frame_has_are_refused(tmp_path: Path, length: int, keys: str, said: str) -> None:
    path = bench(tmp_path, HEAD + COMMAND.format(length=length))
    path.write_text(path.read_text().replace("{timeout_ms", f"{{{keys} timeout_ms"))
    assert any(said in problem.text for problem in check_bench(path)), check_bench(path)
