"""What a system description says of protection: E2E is offered, SecOC refused."""

from types import SimpleNamespace
from typing import Any

import pytest
from cantools.database.can.message import Message
from cantools.database.can.signal import Signal as DatabaseSignal

from hilplant.bench.doubts import offer_protection
from hilplant.bench.mapping import MappedMessage
from hilplant.bus.codec import MappingError, SignalMapping, received_message
from hilplant.checked_yaml.spot import Spot
from hilplant.signals import INPUTS


def message(**autosar: Any) -> Message:
    made = Message(0x100, "Cmd", 8, [DatabaseSignal("On", 16, 1)])
    made.autosar = SimpleNamespace(**{"e2e": None, "secoc": None} | autosar)  # type: ignore[assignment]
    return made


@pytest.mark.parametrize(
    ("category", "ids", "said"),
    [
        ("PROFILE_05", [123], "'protection: {profile: 5, data_id: 123}'"),
        ("PROFILE_11", [7], "'protection: {profile: 11, data_id: 7}'"),
        ("PROFILE_02", list(range(16)), "'protection: {profile: 2, data_id_list: [0, 1, 2,"),
        ("SHINY", [1], "profile: ... ('SHINY' in the file), data_id: 1"),
    ],
)
def test_the_databases_end_to_end_protection_is_offered(category: str, ids: list[int], said: str) -> None:
    spot = Spot(("bus",))
    protected = message(e2e=SimpleNamespace(category=category, data_ids=ids))
    offer_protection(spot, [MappedMessage(protected, (), None)], [MappedMessage(message(), (), None)])
    (finding,) = spot.findings
    assert finding.severity == "warning"
    assert finding.location == ("bus", "receive", "Cmd")
    assert said in finding.text


def test_a_message_with_secoc_is_refused_in_words() -> None:
    secured = message(secoc=SimpleNamespace(auth_algorithm_name="KnockKnock"))
    with pytest.raises(MappingError, match=r"authenticated by SecOC \(KnockKnock\), which is not supported"):
        received_message(secured, [SignalMapping("On", "relay_on")], INPUTS)
