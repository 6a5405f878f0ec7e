"""Drag and lift of a blade on the modelling page: a number, or a table over the arm's angle."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from playwright.sync_api import Page, expect
from web.modelling import enter, modelling, show

from hilplant.modelling.session import ModellingSession

pytestmark = pytest.mark.browser

NAME = "plant.blades.left.drag"
BOX = f'div.coefficient[data-at="{NAME}"]'


def test_a_coefficient_of_the_air_is_a_number_or_a_table_over_the_arm_s_angle(page: Page, tmp_path: Path) -> None:
    """The file has what the page shows; a table that means nothing marks its cells, with the line and the reason."""
    with modelling(page, tmp_path) as session:
        show(page, "environment")
        page.click(f"{BOX} button")
        expect(page.locator(f"{BOX} tbody tr")).to_have_count(3)
        enter(page, f"{NAME} 2 coefficient", "0.3")
        assert drag_of(session) == [[0, 0.175], [90, 0.3], [180, 0.175]]
        enter(page, f"{NAME} 3 angle", "90")
        expect(page.locator(".problems")).to_contain_text("the arm's angles must rise, but 90.0 follows 90.0 deg")
        expect(page.locator(f"{BOX} input.wrong")).to_have_count(6)
        page.click(f"{BOX} >> text=+ row")
        expect(page.locator(f"{BOX} tbody tr")).to_have_count(4)
        page.click(f'{BOX} button[aria-label="drag coefficient: take row 3 out"]')
        expect(page.locator(f"{BOX} tbody tr")).to_have_count(3)
        expect(page.locator("#verdict")).to_contain_text("does not run")
        page.click(f"{BOX} >> text=one number")
        expect(page.locator(f'[aria-label="{NAME}"]')).to_have_value("0.216666666667")
        expect(page.locator("#verdict")).to_contain_text("can run")
        assert drag_of(session) == pytest.approx((0.175 + 0.3 + 0.175) / 3.0)


def drag_of(session: ModellingSession) -> Any:
    """Return what the bench's text has."""
    return yaml.safe_load(session.model.texts["bench.yaml"])["plant"]["blades"]["left"]["drag"]
