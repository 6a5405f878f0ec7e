"""What every contact of a park circuit connects, position by position: what the drawing of the motor shows (3.6)."""

from typing import Any

from hilplant.models.park_switch import Contact
from hilplant.models.wiring import CIRCUITS, PARKED, TURNING_BACK, WIPING, Lead, Leads, depressed, digital, mechanical
from hilplant.signals import INPUT_INDEX, INPUTS, Inputs

#: Commands of the two relays: on, fast.
COMMANDS = {"off": (0.0, 0.0), "slow": (1.0, 0.0), "fast": (1.0, 1.0)}
PHASES = {"wiping": WIPING, "turning_back": TURNING_BACK, "parked": PARKED}


def circuit_states(circuit: str) -> list[dict[str, Any]]:
    """Return each state of a circuit with what it puts on the terminals 53, 53b, 31 and 53e.

    A lead is `supply`, `ground` or `open`; `joined` says that 53 is connected with the line from the park contact.
    `closed` is the cam's contact, `phase` that of the depressed circuit; the other circuits have only `wiping`.
    """
    phases = PHASES if circuit == "depressed" else {"wiping": WIPING}
    return [
        {"command": command, "closed": closed, "phase": phase, **_shown(_leads(circuit, relays, closed, value))}
        for command, relays in COMMANDS.items()
        for closed in (False, True)
        for phase, value in phases.items()
    ]


def _leads(circuit: str, relays: tuple[float, float], closed: bool, phase: float) -> Leads:
    row = [signal.default for signal in INPUTS]
    row[INPUT_INDEX["relay_on"]], row[INPUT_INDEX["relay_fast"]] = relays
    inputs, contact = Inputs(*row), Contact(float(closed), float(closed), 0.0)
    made = {"digital": lambda: digital(inputs), "mechanical": lambda: mechanical(inputs, contact)}
    if circuit in made:
        return made[circuit]()
    if circuit not in CIRCUITS:
        raise ValueError(f"there is no park circuit {circuit!r}")
    return depressed(inputs, contact, phase)


def _shown(leads: Leads) -> dict[str, Any]:
    named = {"slow": leads.slow, "fast": leads.fast, "common": leads.common, "park": leads.park}
    return {name: _word(lead) for name, lead in named.items()} | {"joined": leads.joined > 0.5}


def _word(lead: Lead) -> str:
    if lead.driven < 0.5:
        return "open"
    return "supply" if lead.share > 0.5 else "ground"
