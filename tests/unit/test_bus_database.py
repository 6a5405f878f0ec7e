"""The same relay command in every format of database, and files that are none."""

from pathlib import Path

import pytest

from hilplant.bus.codec import SignalMapping, Timing, received_message, sent_message
from hilplant.bus.database import DatabaseError, load_database
from hilplant.signals import INPUTS

DATA = Path(__file__).parents[1] / "data" / "bus"
MAPPINGS = [
    SignalMapping("WiperPower", "relay_on", choices={"Parked": "off", "Wiping": "on"}),
    SignalMapping("WiperSpeed", "relay_fast", choices={"Low": "off", "High": "on"}),
]


@pytest.mark.parametrize("name", ["relay.dbc", "relay.arxml", "relay.kcd", "relay.sym"])
def test_every_format_carries_the_same_command(name: str) -> None:
    (message,) = load_database(DATA / name).messages
    incoming = received_message(message, MAPPINGS, INPUTS)
    outgoing = sent_message(message, MAPPINGS, INPUTS, Timing(period_ns=0))
    assert (incoming.identifier, incoming.length) == (0x121, 2)
    assert incoming.decode(b"\x08\x03") == (1.0, 1.0)
    assert incoming.decode(b"\x00\x01") == (0.0, 0.0)
    no_choice = incoming.decode(b"\x04\x00")
    assert all(value < lowest for value, (lowest, _) in zip(no_choice, incoming.limits, strict=True))
    assert outgoing.encode([1.0, 0.0, *([0.0] * len(INPUTS))]) == (b"\x08\x01", 0)


def test_a_file_that_is_missing_or_no_database_is_one_clear_error(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.dbc"
    wrong.write_text("BO_ this is no database", encoding="utf-8")
    with pytest.raises(DatabaseError, match=r"wrong\.dbc cannot be read as a bus database: .*line 1"):
        load_database(wrong)
    with pytest.raises(DatabaseError, match=r"missing\.dbc cannot be read: No such file"):
        load_database(tmp_path / "missing.dbc")
    with pytest.raises(DatabaseError, match=r"bench\.yaml: a bus database ends in \.dbc, \.arxml, \.kcd, \.sym"):
        load_database(tmp_path / "bench.yaml")
