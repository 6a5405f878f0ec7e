"""The catalogue as text: a list, one fault in full, the table of the documentation."""

from itertools import groupby

from hilplant.faults.catalogue import BY_NAME, NUMBERS, fault_named
from hilplant.faults.fault import ABOUT, FaultDefinition, Quantity


def list_lines() -> list[str]:
    """Return every fault by kind, a line each."""
    width = max(map(len, BY_NAME))
    lines: list[str] = []
    for kind, faults in groupby(BY_NAME.values(), lambda fault: fault.kind):
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
        *(f"  {told}" for told in _takes(fault)),
        "in a scenario:",
        "  faults:",
        f"    - {{fault: {fault.name}{given}{_example_about(fault)}, at: 2.0, for: 1.0}}",
    ]


def table() -> str:
    """Return the catalogue as a table in Markdown."""
    rows = ["| no. | fault | kind | meaning | quantities | effect |", "|---|---|---|---|---|---|"]
    for name, fault in BY_NAME.items():
        quantities = "; ".join(_takes(fault))
        cells = (NUMBERS[name], f"`{name}`", fault.kind, fault.meaning, quantities, fault.effect)
        rows.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join(rows) + "\n"


def value_table() -> str:
    """Return the line of a DBC that gives the numbers of `FaultShown` their names."""
    labels = " ".join(f'{number} "{name}"' for name, number in reversed(NUMBERS.items()))
    return f'VAL_ 534 FaultShown {labels} 0 "none" ;'


def _takes(fault: FaultDefinition) -> list[str]:
    """Return what it is told by quantities and, of the bus, what it is about."""
    told = [_told(quantity) for quantity in fault.quantities]
    if fault.on_frames is None:
        return told
    if "protection" in fault.about:
        return [*told, "message: one with end-to-end protection"]
    return (
        [*told, *(f"{name}: {ABOUT[name]}" for name in fault.about)] if fault.about else [*told, "message or direction"]
    )


def _example_about(fault: FaultDefinition) -> str:
    if fault.on_frames is None:
        return ""
    given = {"message": "RelayCommand", "signal": "RelayOn", "value": "1", "direction": "to plant"}
    return "".join(f", {name}: {given[name]}" for name in fault.about or ("message",) if name in given)


def _told(quantity: Quantity) -> str:
    default = "" if quantity.default is None else f", {quantity.default:g} if left out"
    return f"{quantity.name}: {quantity.meaning}, {quantity.minimum:g} to {quantity.maximum:g}{default}"


def _example(quantity: Quantity) -> float:
    if quantity.default is not None:
        return quantity.default
    return min(quantity.maximum, max(quantity.minimum, 0.5))
