"""A velocity controller inside the loop, in place of the frames of an ECU."""

from dataclasses import replace
from typing import NamedTuple

from hilplant.bench import Bench
from hilplant.runtime.loop import Control
from hilplant.units import SECOND_NS


class Inside(NamedTuple):
    """A velocity controller inside the loop: its name in the catalogue, and the wanted speed as it is written."""

    controller: str
    reference: str


def seated(bench: Bench, inside: Inside) -> tuple[Bench, Control]:
    """Return the bench as a controller inside its loop needs it, and what its loop calls.

    Relays and supply are the controller's alone, so nobody waits for frames that command them; what else such a frame
    carries is taken as before.
    """
    from hilplant.control.catalogue import controller_named, without_network  # slow to load, and seldom wanted
    from hilplant.control.reference import parse_reference
    from hilplant.control.seat import COMMANDED, LoopSeat

    reference = parse_reference(inside.reference)
    controller = controller_named(inside.controller, bench.parameters.motor, bench.step_ns / SECOND_NS)
    seat = LoopSeat(controller, without_network(), reference, bench.parameter_row)
    received = (replace(m, timeout_ns=0) if COMMANDED & set(m.targets) else m for m in bench.receive)
    return replace(bench, receive=tuple(received)), seat.drive
