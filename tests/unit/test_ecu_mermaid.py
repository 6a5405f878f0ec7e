"""The drawn chart is the one that runs, and the one in the documentation."""

import re
from pathlib import Path

from typer.testing import CliRunner

from hilplant.cli.main import app
from hilplant.ecu.chart import CHART, Phase
from hilplant.ecu.mermaid import chart_text

ROOT = Path(__file__).parents[2]
ARROW = re.compile(r"    (\w+|\[\*\]) --> (\w+)(?: : ([\w ()/]+))?")
GROUP = re.compile(r"    (any_\w+) : [\w ]+\(([\w, ]+)\)")


def test_every_line_is_an_arrow_or_a_group_of_known_states():
    lines = chart_text().splitlines()
    assert lines[:2] == ["stateDiagram-v2", "    [*] --> off"]
    groups = {found[1]: set(found[2].split(", ")) for line in lines if (found := GROUP.fullmatch(line))}
    states = {phase.value for phase in Phase}
    assert all(members <= states for members in groups.values())
    arrows = [found for line in lines[1:] if (found := ARROW.fullmatch(line))]
    assert len(arrows) + len(groups) == len(lines) - 1
    assert {arrow[1] for arrow in arrows} <= states | set(groups) | {"[*]"}
    assert {arrow[2] for arrow in arrows} == states


def test_the_arrows_are_the_transitions_of_the_table_each_once():
    groups = {found[1]: found[2].split(", ") for line in chart_text().splitlines() if (found := GROUP.fullmatch(line))}
    drawn = [
        (source, arrow[2], arrow[3].split(" / ")[0])
        for line in chart_text().splitlines()[2:]
        if (arrow := ARROW.fullmatch(line))
        for source in groups.get(arrow[1], [arrow[1]])
    ]
    table = [(phase.value, row.target.value, row.condition.words) for row in CHART for phase in row.sources]
    assert sorted(drawn) == sorted(table)


def test_the_documentation_shows_the_chart_as_it_is():
    page = (ROOT / "docs" / "ecu.md").read_text(encoding="utf-8")
    assert f"```mermaid\n{chart_text()}\n```" in page


def test_the_command_line_prints_it():
    result = CliRunner().invoke(app, ["ecu", "--chart"])
    assert result.exit_code == 0
    assert result.stdout == chart_text() + "\n"
