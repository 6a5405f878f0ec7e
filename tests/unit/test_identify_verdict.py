"""A model that leaves more than the noise is said not to explain the data, with the same words wherever it is told."""

from types import SimpleNamespace
from typing import Any

import pytest

from hilplant.cli.actions.identify import _print_parameters
from hilplant.identify.from_files import figures
from hilplant.identify.profile import ConfidenceInterval
from hilplant.identify.result_files import ResultOrigin, _facts
from hilplant.identify.stages import ALL
from hilplant.identify.starting_point import StartingPoint
from hilplant.identify.three_stages import Identified, Times
from hilplant.identify.uncertainty import Identifiability
from hilplant.identify.validation import unexplained
from hilplant.reports import identification as report


def compared(rms_a: float, noise_a: float) -> Any:
    return SimpleNamespace(error=SimpleNamespace(name="rig.csv", rms_current_a=rms_a, noise_a=noise_a))


@pytest.mark.parametrize(("rms_a", "said"), [(0.1, False), (0.119, False), (0.121, True), (0.56, True)])
def test_what_is_left_beyond_the_noise_is_told(rms_a: float, said: bool) -> None:
    lines = unexplained([compared(0.05, 0.1), compared(rms_a, 0.1)])
    assert bool(lines) == said
    assert all(f"{10.0 * rms_a:.1f} times the noise" in line and "--also" in line for line in lines)


def found(rms_a: float, computed: int = 100, settled: bool = True) -> Any:
    """Return a result of two parameters, of which one is identifiable, that leaves so much of the current."""
    choice = SimpleNamespace(values=[1.0, 2.0], parameters=[SimpleNamespace(unit="ohm")] * 2)
    noise = SimpleNamespace(current_a=rms_a, edge_s=1e-3)
    parts: dict[str, Any] = dict.fromkeys(Identified._fields) | {
        "task": SimpleNamespace(choice=choice, bench=SimpleNamespace(name="bench"), stages=ALL),
        "outcome": SimpleNamespace(values=[1.0, 2.0], cost=1.0),
        "space": SimpleNamespace(low=[0.0, 0.0], high=[9.0, 9.0]),
        "solution": SimpleNamespace(noise=noise, moved_on=(), settled=settled),
        "verdicts": [
            Identifiability("slow_resistance_ohm", 1.28, 0.005, True, ()),
            Identifiability("force_n", 7.6, 0.025, False, ()),
        ],
        "intervals": [ConfidenceInterval(1.27, 1.29), ConfidenceInterval(None, None)],
        "forces": [], "advice": [], "fitted": [compared(rms_a, 0.1)], "held_out": [], "final_cost": 1.0,
        "times": Times(1.0, 100, computed, 1.0, 10, 1.0),
    }  # fmt: skip
    return Identified(**parts)


ORIGIN = ResultOrigin((), (), "2026-01-01", 0, "genetic")


def page(result: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Any) -> str:
    for name in ("convergence_picture", "correlation_picture"):
        monkeypatch.setattr(report, name, lambda *_: "")
    monkeypatch.setattr(
        report,
        "_run",
        lambda *_: {
            "error": SimpleNamespace(
                name="rig.csv", rms_current_a=1.0, worst_current_a=1.0, noise_a=1.0, rms_edge_s=1.0
            ),
            "role": "",
            "picture": "",
        },
    )
    report.write_report(tmp_path / "car.html", result, StartingPoint(None, {}, ()), ORIGIN, [])  # type: ignore[arg-type]
    return str((tmp_path / "car.html").read_text(encoding="utf-8"))


@pytest.mark.parametrize(
    ("rms_a", "settled", "fits"),
    [(0.1, True, True), (0.119, True, True), (0.13, True, False), (0.56, True, False), (0.1, False, False)],
)
def test_no_interval_is_given_for_a_model_that_does_not_fit_nor_for_an_unfinished_search(  # noqa: PLR0913, PLR0917
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Any,
    rms_a: float,
    settled: bool,
    fits: bool,
) -> None:
    """The terminal, the JSON, the bench's files and the report say the same."""
    result = found(rms_a, settled=settled)
    _print_parameters(result)
    printed, html = capsys.readouterr().out, page(result, monkeypatch, tmp_path)
    flat, facts = figures(result), _facts(result, ORIGIN)
    assert ("1.27" in printed) == ("1.27" in html) == ("slow_resistance_ohm_low" in flat) == fits
    assert ("withheld" in printed) == ("<td>withheld</td>" in html.replace("\n", "")) != fits
    assert flat["current_explained"] is (fits or not settled)
    assert flat["slow_resistance_ohm"] == 1.28
    assert facts["intervals_95"] == ({"slow_resistance_ohm": [1.27, 1.29]} if fits else {})
    assert ("withheld" in facts) != fits
    assert ("1 of 2" in html) == fits
    assert facts["not_told"] == flat["not_told"] == ["force_n"]


@pytest.mark.parametrize("computed", [0, 40, 100])
def test_what_a_journal_answered_is_not_counted_as_speed(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Any, computed: int
) -> None:
    result = found(0.1, computed)
    flat = figures(result)
    assert flat["evaluations_per_s"] == computed
    assert flat["search_evaluations_from_journal"] == 100 - computed
    said = f"{100 - computed} of them from the journal of an earlier run"
    assert (said in page(result, monkeypatch, tmp_path)) == (computed < 100)
