"""KCD, SYM and ARXML of which a part cannot be read: it is left out and said, the rest decodes as before."""

import random
from pathlib import Path

import pytest

from hilplant.bench import check_bench, load_bench
from hilplant.bus.database import DatabaseError, load_sound, parse_database

DATA = Path(__file__).parents[1] / "data" / "bus"
ARXML = """<CAN-FRAME-TRIGGERING><SHORT-NAME>T{0}</SHORT-NAME><FRAME-REF DEST="CAN-FRAME">/Body/{0}</FRAME-REF>
<CAN-ADDRESSING-MODE>STANDARD</CAN-ADDRESSING-MODE><IDENTIFIER>{1}</IDENTIFIER></CAN-FRAME-TRIGGERING>
"""
#: Where a message goes: before which text. What follows is put in there, and what is said of it.
PLACES = {"kcd": ["<Message ", "</Bus>"], "sym": ['["WiperCommand"]', "\n\n"], "arxml": ["</FRAME-TRIGGERINGS>"]}
FLAWS = [
    ("kcd", '<Message id="no" name="Door"/>\n', "invalid literal for int() with base 0: 'no', at line "),
    ("kcd", '<Message id="0x122" name="Door"><Signal name="L"/></Message>', "something that it needs is missing"),
    ("kcd", '<Message id="0x10630000" name="Door" length="2"/>', "more than 11 bits in message Door, at line "),
    ("sym", '\n["Door"]\nID=200h\nLen=2\nSig="Gone" 0\n\n', "'Gone' is not there, at line "),
    ("sym", "\n[Door]\nID=XYZh\nLen=2\n\n", "Invalid syntax at line "),
    (
        "sym",
        "\n[Door]\nID=200h\nLen=2\nMux=A 0,3 0\n\n[Door]\nLen=2\nMux=B 0,3 1\nSig=Gone 3\n\n",
        "'Gone' is not there",
    ),
    ("arxml", ARXML.format("Door", 290), "dangling reference FRAME-REF"),
]
BENCH = """extends: virtual.yaml
name: x
bus:
  interface: {interface: virtual, channel: a}
  database: x.ENDING
  receive: {MESSAGE: {timeout_ms: 20, signals: {WiperPower: {signal: relay_on, choices: {Parked: off, Wiping: on}}}}}
  send: {}
"""


def bench(folder: Path, ending: str, text: str, message: str) -> Path:
    (folder / f"x.{ending}").write_text(text, encoding="utf-8")
    path = folder / "bench.yaml"
    path.write_text(BENCH.replace("ENDING", ending).replace("MESSAGE", message))
    return path


@pytest.mark.parametrize(
    ("ending", "flaw", "said", "place"), [(*each, place) for each in FLAWS for place in range(len(PLACES[each[0]]))]
)
def test_a_message_that_cannot_be_read_is_left_out_and_said(
    tmp_path: Path, ending: str, flaw: str, said: str, place: int
) -> None:
    before = PLACES[ending][place]
    sound = (DATA / f"relay.{ending}").read_text()
    at = sound.rindex(before) if place else sound.index(before)
    text = sound[:at] + flaw + sound[at:]
    name = "WiperCommandFrame" if ending == "arxml" else "WiperCommand"
    made = load_bench(bench(tmp_path, ending, text, name))
    assert [made.receive[0].decode(bytes([power << 2, 1])) for power in (0, 2)] == [(0.0,), (1.0,)]
    (warning,) = made.warnings
    assert "left out 1 messages and 0 other entries" in warning.text
    assert said in warning.text
    (problem,) = check_bench(bench(tmp_path, ending, text, "Door"))
    assert "message 'Door' cannot be read: " in problem.text


@pytest.mark.parametrize("entry", ['Sig="Lock" strange 2 /e:None\n', "Sig=Lock unsigned x\n", 'Enum=Bad(x="a")\n'])
def test_a_sym_without_one_of_its_entries(tmp_path: Path, entry: str) -> None:
    head = "{ENUMS}" if entry.startswith("Enum") else "{SIGNALS}"
    text = (DATA / "relay.sym").read_text().replace(f"{head}\n", f"{head}\n{entry}")
    (tmp_path / "x.sym").write_text(text)
    database, left_out = load_sound(tmp_path / "x.sym")
    assert [message.name for message in database.messages] == ["WiperCommand"]
    assert [each.message for each in left_out] == [None]
    assert left_out[0].text.startswith("Bad: " if entry.startswith("Enum") else "Lock: ")
    assert len(parse_database(text, "sym").messages) == 1


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("ending", ["kcd", "sym"])
def test_flaws_among_many_messages(tmp_path: Path, ending: str, seed: int) -> None:
    """Whichever messages are unsound, these and no others are left out, each at its line."""
    rng = random.Random(seed)
    names = [f"Door{number}" for number in range(rng.randint(1, 40))]
    flawed = set(rng.sample(names, rng.randint(1, min(5, len(names)))))
    form, wrong = ('<Message id="{1}" name="{0}"/>\n', "?") if ending == "kcd" else ("[{0}]\nID={1}h\nLen=0\n\n", "Q")
    base = "0x" if ending == "kcd" else ""
    rows = [form.format(name, wrong if name in flawed else f"{base}{k + 512:X}") for k, name in enumerate(names)]
    sound = (DATA / f"relay.{ending}").read_text()
    at = sound.index(PLACES[ending][0])
    text = "".join([sound[:at], *rows, sound[at:]])
    (tmp_path / f"x.{ending}").write_text(text)
    database, left_out = load_sound(tmp_path / f"x.{ending}")
    assert {message.name for message in database.messages} == {*names, "WiperCommand"} - flawed
    assert {each.message for each in left_out} == flawed
    lines = text.splitlines()
    for each in left_out:
        number = int(each.text.split("at line ")[1].split(",")[0])
        assert any(f"{each.message}" in line for line in lines[max(0, number - 2) : number])


@pytest.mark.parametrize(
    ("ending", "damage"), [(e, d) for e in PLACES for d in ("head", "end", "other") if (e, d) != ("sym", "end")]
)
def test_a_file_that_is_none_is_refused_in_one_line(tmp_path: Path, ending: str, damage: str) -> None:
    sound = (DATA / f"relay.{ending}").read_text()
    text = {"head": sound[60:], "end": sound[:-30], "other": "BU_: A B\n"}[damage]
    path = tmp_path / f"x.{ending}"
    path.write_text(text)
    with pytest.raises(DatabaseError, match=r"cannot be read as a bus database") as told:
        load_sound(path)
    assert "\n" not in str(told.value)
