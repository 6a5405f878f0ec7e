"""The studies of motor, park circuits and mechanics: their tables, their figures, and whether they hold."""

import re
from typing import Any, NamedTuple

from hilplant.bench.assembly import load_bench
from hilplant.mechanics.tables import run_time_table
from hilplant.models.wiring import DIGITAL
from hilplant.thesis.reference import channels_of
from hilplant.thesis.solver import SCENARIOS, compare
from hilplant.thesis.text_table import Part, TextTable, yes_or_no
from hilplant.thesis.thesis_checks import Check, thesis_checks
from hilplant.thesis.wiping import INDEPENDENT, RULE_SUPPLY_V, SCREENS, STAGES, Wiping, demands, wiping

#: RMS error of range that the step may have [%].
SOLVER_WITHIN_PERCENT = 0.5
#: The reference reads the mechanics at this many knots, so that the step's own table is part of what is judged.
_REFERENCE_KNOTS = 8192


class StudyReport(NamedTuple):
    """What a study found: its parts in their order, its figures by flat names, and whether all of it holds."""

    parts: list[Part]
    figures: dict[str, Any]
    holds: bool = True


def thesis_study(bench: str) -> StudyReport:
    """Put the thesis' checks beside ours."""
    checks = thesis_checks(load_bench(bench))
    rows = [[check.where, check.what, check.theirs, check.ours, yes_or_no(check.holds)] for check in checks]
    table = TextTable("The thesis' own checks", ("where", "what", "compared with", "here", "holds"), rows)
    figures = {_key(check): check.ours for check in checks} | {"failed": sum(not c.holds for c in checks)}
    return StudyReport([table], figures, all(check.holds for check in checks))


def wiping_study(bench: str) -> StudyReport:
    """Return cycles a minute and currents over supply, screen and stage, with the rule's figures."""
    rows = wiping(load_bench(bench))
    columns = [f"{screen} {stage}" for screen in SCREENS for stage in STAGES]
    cells = [
        [f"{rows[first].supply_v:g}", *(_cell(row) for row in rows[first : first + len(columns)])]
        for first in range(0, len(rows), len(columns))
    ]
    found = demands(rows, RULE_SUPPLY_V)
    rule = [[demand.what, f"{demand.at_least:g}", f"{demand.found:.1f}", yes_or_no(demand.met)] for demand in found]
    theirs = ", ".join(f"{value:g} {stage}" for stage, value in INDEPENDENT.items())
    parts: list[Part] = [
        TextTable(f"{bench}: cycles a minute, mean and peak current [A]", ("supply [V]", *columns), cells),
        f"\nFMVSS 104 at {RULE_SUPPLY_V:g} V on a wet screen, cycles a minute",
        TextTable("", ("what", "at least", "found", "met"), rule),
        f"An integration of Table 5-9 made without this code, without gravity and with other assumed masses: {theirs}.",
    ]
    figures: dict[str, Any] = {}
    for row in rows:
        name = f"{row.screen}_{row.stage}_{row.supply_v:g}_v".replace(".", "_")
        figures |= {
            f"{name}_cycles_per_minute": row.cycles_per_minute,
            f"{name}_mean_current_a": row.mean_current_a,
            f"{name}_peak_current_a": row.peak_current_a,
        }
    return StudyReport(parts, figures | {f"fmvss_104_{demand.what}_met": demand.met for demand in found})


def solver_study(bench: str) -> StudyReport:
    """Return the step's errors against the adaptive solver; they hold when all are within the bound.

    Motor and load are judged. The relays are wired as in the digital park circuit, whatever the bench's is: with the
    others the wiper would go on to park when it is switched off, which the solver's scenarios do not do.
    """
    loaded = load_bench(bench)
    switch = loaded.parameters.park_switch
    parameters = loaded.parameters._replace(park_switch=switch._replace(circuit=DIGITAL))
    channels = channels_of(run_time_table(loaded.plant.mechanics.wiper, _REFERENCE_KNOTS))
    rows, figures = [], dict[str, Any]()
    for name, drive in SCENARIOS.items():
        errors = compare(parameters, loaded.tables, channels, drive())
        found = {"current": errors.current_percent, "speed": errors.speed_percent, "angle": errors.angle_percent}
        rows.append([name, *(f"{value:.1e}" for value in found.values())])
        key = re.sub(r"\W+", "_", name.lower())
        figures |= {f"{key}_{signal}_rms_percent": value for signal, value in found.items()}
    title = f"{bench}: the step against an adaptive solver of the same equations, RMS in % of range"
    worst = max(figures.values())
    parts: list[Part] = [
        TextTable(title, ("scenario", "current", "speed", "angle"), rows),
        f"worst {worst:.1e} %; bound {SOLVER_WITHIN_PERCENT} %",
    ]
    if switch.circuit != DIGITAL:
        parts.append("Relays as in the digital park circuit; docs/park.md has the others.")
    return StudyReport(parts, figures | {"worst_rms_percent": worst}, worst <= SOLVER_WITHIN_PERCENT)


def _cell(row: Wiping) -> str:
    if row.cycles_per_minute == 0.0:
        return f"stands  {row.mean_current_a:.2f}"
    return f"{row.cycles_per_minute:.1f}  {row.mean_current_a:.2f}  {row.peak_current_a:.2f}"


def _key(check: Check) -> str:
    return re.sub(r"\W+", "_", f"{check.where} {check.what}").strip("_").lower()
