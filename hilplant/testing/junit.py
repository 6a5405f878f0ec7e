"""JUnit XML of tests: a suite for each scenario, a case for each expectation."""

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

from hilplant.atomic_write import write_text
from hilplant.testing.scenario_test import Judged, ScenarioTest
from hilplant.testing.words import line_of


def write_junit(path: Path, tests: Sequence[ScenarioTest]) -> None:
    """Write all tests; blocked and inconclusive are errors, because nothing was shown either way."""
    root = ElementTree.Element("testsuites", name="hilplant")
    for test in tests:
        root.append(_suite(test))
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    write_text(path, f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n')


def _suite(test: ScenarioTest) -> ElementTree.Element:
    rulings = [each.judgement.ruling for each in test.judged]
    failures = rulings.count("fail")
    errors = len(rulings) - failures - rulings.count("pass")
    count = {"tests": len(rulings), "failures": failures, "errors": errors, "skipped": 0}
    suite = ElementTree.Element("testsuite", {"name": test.name} | {key: str(value) for key, value in count.items()})
    properties = ElementTree.SubElement(suite, "properties")
    for name, value in (("bench", test.bench_name), ("requirement", test.scenario.requirement), ("rerun", test.rerun)):
        ElementTree.SubElement(properties, "property", name=name, value=value)
    for each in test.judged:
        suite.append(_case(test, each))
    return suite


def _case(test: ScenarioTest, judged: Judged) -> ElementTree.Element:
    expectation, ruling = judged.expectation, judged.judgement.ruling
    file, _, line = expectation.place.rpartition(":")
    attributes = {"classname": test.name, "name": expectation.text, "file": file, "line": line, "time": "0"}
    case = ElementTree.Element("testcase", attributes)
    if ruling != "pass":
        kind = "failure" if ruling == "fail" else "error"
        told = line_of(judged, test.step_s)
        ElementTree.SubElement(case, kind, type=ruling, message=told).text = f"{told}\nagain: {test.rerun}"
    return case
