"""A model that leaves more than the noise is said not to explain the data, with the same words wherever it is told."""

from types import SimpleNamespace
from typing import Any

import pytest

from hilplant.cli.actions.identify import _print_parameters
from hilplant.identify.validation import unexplained


def compared(rms_a: float, noise_a: float) -> Any:
    return SimpleNamespace(error=SimpleNamespace(name="rig.csv", rms_current_a=rms_a, noise_a=noise_a))


@pytest.mark.parametrize(("rms_a", "said"), [(0.1, False), (0.119, False), (0.121, True), (0.56, True)])
def test_what_is_left_beyond_the_noise_is_told(rms_a: float, said: bool) -> None:
    lines = unexplained([compared(0.05, 0.1), compared(rms_a, 0.1)])
    assert bool(lines) == said
    assert all(f"{10.0 * rms_a:.1f} times the noise" in line and "--also" in line for line in lines)


@pytest.mark.parametrize(("rms_a", "shown"), [(0.1, "1.27 to 1.29"), (0.56, "withheld: the model does not fit")])
def test_no_interval_is_shown_for_a_model_that_does_not_fit(
    capsys: pytest.CaptureFixture[str], rms_a: float, shown: str
) -> None:
    found: Any = SimpleNamespace(
        verdicts=[SimpleNamespace(name="slow_resistance_ohm", value=1.28, told=True, together=())],
        intervals=[(1.27, 1.29)],
        task=SimpleNamespace(choice=SimpleNamespace(values=[1.0])),
        fitted=[compared(rms_a, 0.1)],
    )
    _print_parameters(found)
    printed = capsys.readouterr().out
    assert shown in printed
    assert ("1.27" in printed) == (rms_a < 0.2)
