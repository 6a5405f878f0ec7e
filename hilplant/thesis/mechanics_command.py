"""What `hilplant study thesis`, `wiping` and `solver` do: print tables, return their figures."""

import re
from typing import Any

from rich.console import Console
from rich.table import Table

from hilplant.bench.assembly import load_bench
from hilplant.mechanics.tables import run_time_table
from hilplant.models.wiring import DIGITAL
from hilplant.thesis.reference import channels_of
from hilplant.thesis.solver import SCENARIOS, compare
from hilplant.thesis.thesis_checks import Check, thesis_checks
from hilplant.thesis.wiping import INDEPENDENT, RULE_SUPPLY_V, SCREENS, STAGES, Wiping, demands, wiping

_WIDTH = 132

#: RMS error of range that the step may have [%].
SOLVER_WITHIN_PERCENT = 0.5
#: The reference reads the mechanics at this many knots, so that the step's own table is part of what is judged.
_REFERENCE_KNOTS = 8192


def thesis_study(bench: str) -> tuple[dict[str, Any], bool]:
    """Print the source's checks beside ours; return the figures, and whether all hold."""
    checks = thesis_checks(load_bench(bench))
    table = _table("The source's own checks", ("where", "what", "source", "here", "holds"))
    for check in checks:
        table.add_row(check.where, check.what, check.theirs, check.ours, _verdict(check.holds))
    _print(table)
    return {_key(check): check.ours for check in checks} | {"failed": sum(not c.holds for c in checks)}, all(
        check.holds for check in checks
    )


def wiping_study(bench: str) -> dict[str, Any]:
    """Print cycles a minute and currents over supply, screen and stage, with the rule's figures; return all."""
    rows = wiping(load_bench(bench))
    columns = [f"{screen} {stage}" for screen in SCREENS for stage in STAGES]
    table = _table(f"{bench}: cycles a minute, mean and peak current [A]", ("supply [V]", *columns))
    for first in range(0, len(rows), len(columns)):
        cells = [_cell(row) for row in rows[first : first + len(columns)]]
        table.add_row(f"{rows[first].supply_v:g}", *cells)
    _print(table)
    Console(width=_WIDTH, highlight=False).print(f"\nFMVSS 104 at {RULE_SUPPLY_V:g} V on a wet screen, cycles a minute")
    rule = _table("", ("what", "at least", "found", "met"))
    found = demands(rows, RULE_SUPPLY_V)
    for demand in found:
        rule.add_row(demand.what, f"{demand.at_least:g}", f"{demand.found:.1f}", _verdict(demand.met))
    _print(rule)
    told = ", ".join(f"{value:g} {stage}" for stage, value in INDEPENDENT.items())
    Console(width=_WIDTH, highlight=False).print(
        f"An integration of Table 5-9 made without this code, without gravity and with other assumed masses: {told}."
    )
    figures: dict[str, Any] = {}
    for row in rows:
        name = f"{row.screen}_{row.stage}_{row.supply_v:g}_v".replace(".", "_")
        figures |= {
            f"{name}_cycles_per_minute": row.cycles_per_minute,
            f"{name}_mean_current_a": row.mean_current_a,
            f"{name}_peak_current_a": row.peak_current_a,
        }
    return figures | {f"fmvss_104_{demand.what}_met": demand.met for demand in found}


def solver_study(bench: str) -> tuple[dict[str, Any], bool]:
    """Print the step's errors against the adaptive solver; return them, and whether all are within the bound.

    Motor and load are judged. The relays are wired as in the digital park circuit, whatever the bench's is: with the
    others the wiper would go on to park when it is switched off, which the solver's scenarios do not do.
    """
    loaded = load_bench(bench)
    switch = loaded.parameters.park_switch
    parameters = loaded.parameters._replace(park_switch=switch._replace(circuit=DIGITAL))
    channels = channels_of(run_time_table(loaded.plant.mechanics.wiper, _REFERENCE_KNOTS))
    table = _table(
        f"{bench}: the step against an adaptive solver of the same equations, RMS in % of range",
        ("scenario", "current", "speed", "angle"),
    )
    figures: dict[str, Any] = {}
    for name, rows in SCENARIOS.items():
        errors = compare(parameters, loaded.tables, channels, rows())
        found = {"current": errors.current_percent, "speed": errors.speed_percent, "angle": errors.angle_percent}
        table.add_row(name, *(f"{value:.1e}" for value in found.values()))
        key = re.sub(r"\W+", "_", name.lower())
        figures |= {f"{key}_{signal}_rms_percent": value for signal, value in found.items()}
    _print(table)
    worst = max(figures.values())
    Console(width=_WIDTH, highlight=False).print(f"worst {worst:.1e} %; bound {SOLVER_WITHIN_PERCENT} %")
    if switch.circuit != DIGITAL:
        Console(width=_WIDTH, highlight=False).print(
            "Relays as in the digital park circuit; docs/park.md has the others."
        )
    return figures | {"worst_rms_percent": worst}, worst <= SOLVER_WITHIN_PERCENT


def _cell(row: Wiping) -> str:
    if row.cycles_per_minute == 0.0:
        return f"stands  {row.mean_current_a:.2f}"
    return f"{row.cycles_per_minute:.1f}  {row.mean_current_a:.2f}  {row.peak_current_a:.2f}"


def _table(title: str, columns: tuple[str, ...]) -> Table:
    table = Table(title=title or None, title_justify="left", box=None, pad_edge=False)
    for column in columns:
        table.add_column(column)
    return table


def _print(table: Table) -> None:
    Console(width=_WIDTH, highlight=False).print(table)


def _verdict(holds: bool) -> str:
    return "[green]yes[/]" if holds else "[bold red]NO[/]"


def _key(check: Check) -> str:
    return re.sub(r"\W+", "_", f"{check.where} {check.what}").strip("_").lower()
