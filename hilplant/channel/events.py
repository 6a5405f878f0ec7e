"""What the loop's events say to clients of the channel."""

from typing import Any

from hilplant.models.records import PARAMETER_INDEX
from hilplant.runtime import commands as c
from hilplant.runtime.commands import ChannelCommand
from hilplant.signals import INPUTS


class PresentFaults:
    """The faults that are there, by the events that they came and went with."""

    def __init__(self) -> None:
        self.listed: list[dict[str, Any]] = []

    def note(self, event: ChannelCommand) -> dict[str, Any]:
        """Keep in mind that a fault came or went; return what tells it to the client that inserted it."""
        who = {"name": name_of(event), "owner": c.OWNERS[event.owner], "client": event.client}
        if event.kind == c.COMES:
            self.listed.append(who | {"tick": event.tick})
        else:
            gone = next((each for each in self.listed if {**each, **who} == each), None)
            if gone is not None:
                self.listed.remove(gone)
        return {"event": "fault", "name": who["name"], "there": event.kind == c.COMES, "tick": event.tick}


def name_of(event: ChannelCommand) -> str:
    """Return the name of the input, parameter or fault that an event is about."""
    if event.kind >= c.FAULT:
        return event.text.decode(errors="replace")
    if event.kind == c.PARAMETER:
        return list(PARAMETER_INDEX)[event.element]
    return INPUTS[event.element].name if event.kind < c.PARAMETER else ""


def reason(event: ChannelCommand) -> str:
    """Return why something was refused."""
    if event.outcome == c.REFUSED:
        return name_of(event)
    return f"{name_of(event)}: {c.OUTCOMES[event.outcome]}".lstrip(": ")
