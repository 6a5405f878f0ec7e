"""The catalogue as text: a list, one fault in full, the table of the documentation."""

from itertools import groupby

from hilplant.faults.catalogue import FAULTS, fault_named
from hilplant.faults.fault import Quantity


def list_lines() -> list[str]:
    """Return every fault by kind, a line each."""
    width = max(len(fault.name) for fault in FAULTS)
    lines: list[str] = []
    for kind, faults in groupby(FAULTS, lambda fault: fault.kind):
        lines += ["", f"{kind}:", *(f"  {fault.name:{width}}  {fault.meaning}" for fault in faults)]
    return lines[1:]


def fault_lines(name: str) -> list[str]:
    """Return one fault in full.

    Raises
    ------
    Failure
        When there is none of that name.

    """
    fault = fault_named(name)
    written = ", ".join(f"{each.name}: {_example(each):g}" for each in fault.quantities)
    given = f", with: {{{written}}}" if written else ""
    return [
        f"{fault.name} ({fault.kind}): {fault.meaning}",
        f"effect: {fault.effect}",
        *(f"  {_told(quantity)}" for quantity in fault.quantities),
        "in a scenario:",
        "  faults:",
        f"    - {{fault: {fault.name}{given}, at: 2.0, for: 1.0}}",
    ]


def table() -> str:
    """Return the catalogue as a table in Markdown."""
    rows = ["| fault | kind | meaning | quantities | effect |", "|---|---|---|---|---|"]
    for fault in FAULTS:
        quantities = "; ".join(_told(quantity) for quantity in fault.quantities)
        rows.append(f"| `{fault.name}` | {fault.kind} | {fault.meaning} | {quantities} | {fault.effect} |")
    return "\n".join(rows) + "\n"


def _told(quantity: Quantity) -> str:
    default = "" if quantity.default is None else f", {quantity.default:g} if left out"
    return f"{quantity.name}: {quantity.meaning}, {quantity.minimum:g} to {quantity.maximum:g}{default}"


def _example(quantity: Quantity) -> float:
    if quantity.default is not None:
        return quantity.default
    return min(quantity.maximum, max(quantity.minimum, 0.5))
