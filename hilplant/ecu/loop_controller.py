"""A velocity controller inside the loop, in place of the frames of an ECU."""

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from hilplant.bench import Bench
from hilplant.units import SECOND_NS

if TYPE_CHECKING:
    from hilplant.control.own import OwnLoopSeat
    from hilplant.control.seat import LoopSeat


class Inside(NamedTuple):
    """A velocity controller inside the loop: its name, the wanted speed as it is written, its time budget [us]."""

    controller: str
    reference: str
    budget_us: int | None = None


def seated(bench: Bench, inside: Inside) -> tuple[Bench, "LoopSeat | OwnLoopSeat"]:
    """Return the bench as a controller inside its loop needs it, and the controller, whose `drive` the loop calls.

    Relays and supply are the controller's alone, so nobody waits for frames that command them; what else such a frame
    carries is taken as before.
    """
    from hilplant.control.reference import parse_reference  # slow to load, and seldom wanted
    from hilplant.control.seat import COMMANDED
    from hilplant.ecu.controller_choice import ControllerChoice, Driven, seat_in_loop

    wanted = ControllerChoice(inside.controller, parse_reference(inside.reference), inside.budget_us)
    seat = seat_in_loop(wanted, Driven(bench.parameters.motor, bench.step_ns / SECOND_NS), bench.parameter_row)
    received = (replace(m, timeout_ns=0) if COMMANDED & set(m.targets) else m for m in bench.receive)
    return replace(bench, receive=tuple(received)), seat
