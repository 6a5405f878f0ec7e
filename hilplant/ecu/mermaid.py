"""Draws the chart as a Mermaid state diagram, from the table that runs."""

from hilplant.ecu.chart import CHART, PAUSES, WIPING, Phase, Transition

#: Groups that are drawn as one where all of their phases do the same.
_GROUPS = {"any_that_wipes": WIPING, "any_pause": PAUSES}
_Words = tuple[str, str]


def chart_text() -> str:
    """Return the diagram; an arrow's words are its condition and, behind a slash, the fault that it reports."""
    lines = ["stateDiagram-v2", "    [*] --> off"]
    for name, phases in _GROUPS.items():
        members = ", ".join(phase.value for phase in phases)
        lines.append(f"    {name} : {name.replace('_', ' ')} ({members})")
    arrows: dict[_Words, dict[Phase, None]] = {}
    for row in CHART:
        arrows.setdefault((row.target.value, _words(row)), {}).update(dict.fromkeys(row.sources))
    for (target, words), sources in arrows.items():
        lines += [f"    {source} --> {target} : {words}" for source in _grouped(sources)]
    return "\n".join(lines)


def _words(row: Transition) -> str:
    return row.condition.words + (f" / {row.fault.value}" if row.fault else "")


def _grouped(sources: dict[Phase, None]) -> list[str]:
    """Return the names of the sources, with one name for each group that is complete."""
    left, names = dict(sources), []
    for name, phases in _GROUPS.items():
        if left.keys() >= set(phases):
            names.append(name)
            for phase in phases:
                del left[phase]
    return [phase.value for phase in left] + names
