"""The modelling page as an engineer uses it: Figure 8-3's motor, a linkage that breaks, a drawing that is right."""

import cmath
import math
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from web.modelling import enter, modelling, put_point, show

from hilplant.modelling.opening import open_model
from hilplant.modelling.view import checked

pytestmark = pytest.mark.browser

POINTS = "plant.linkage.points_m"
#: Of the screen under Figure 8-3, [m].
LINKAGE = {
    "O": 0j, "A": 0.0445 + 0.0055j, "B": -0.2240 - 0.0218j, "C": -0.2720 + 0.0270j,
    "D": -0.2345 - 0.0111j, "E": 0.2325 - 0.0175j, "F": 0.2030 + 0.0270j,
}  # fmt: skip
#: First rod of each arm, from its pivot.
ARMS = {"left": -0.5700 + 0.0100j, "right": -0.3000 + 0.1000j}


def circle_cut(first: complex, radius: float, second: complex, other: float, near: complex) -> complex:
    """Return where two circles cut, the one of two places that is nearer to `near`."""
    apart = abs(second - first)
    along = (radius**2 - other**2 + apart**2) / (2.0 * apart)
    across = math.sqrt(radius**2 - along**2)
    way = (second - first) / apart
    places = [first + way * (along + sign * 1j * across) for sign in (1.0, -1.0)]
    return min(places, key=lambda place: abs(place - near))


def arm_angles(turned_rad: float, steps: int = 720) -> dict[str, float]:
    """Return the arms' angles from +X by the closed form of both four-bar loops, followed from the design position."""
    o, a, b, c, d, e, f = LINKAGE.values()
    # (4.10): D lies on the line through B and C but for the rounding of the printed points
    on_line = c + abs((d - c) * (b - c).conjugate()) / abs(b - c) * (b - c) / abs(b - c)
    at_b, at_e, zero, angles = b, e, {}, {}
    for step in range(steps + 1):
        pin = o + (a - o) * cmath.exp(1j * turned_rad * step / steps)
        at_b = circle_cut(pin, abs(b - a), c, abs(b - c), at_b)
        at_d = c + (on_line - c) * (at_b - c) / (b - c)
        at_e = circle_cut(at_d, abs(e - d), f, abs(e - f), at_e)
        angles = {"left": cmath.phase((at_b - c) / (b - c)), "right": cmath.phase((at_e - f) / (e - f))}
        zero = zero or angles
    return {side: cmath.phase(ARMS[side]) + angles[side] - zero[side] for side in ARMS}


def test_figure_8_3_gives_its_current_and_speed(page: Page, tmp_path: Path) -> None:
    page.set_default_timeout(280_000)  # the step is compiled once
    with modelling(page, tmp_path):
        assert page.input_value('[aria-label="plant.motor.fast.constant_v_s"]') == "0.000072"
        page.click("#simulate-motor")
        page.wait_for_selector("#motor-settled tr[data-mode=fast]")

        def value(mode: str, kind: str, key: str) -> float:
            cell = page.locator(f'#motor-settled tr[data-mode={mode}][data-kind={kind}] td[data-key="{key}"]')
            return float(str(cell.get_attribute("data-value")))

        for kind in ("settled", "closed_form"):
            assert value("slow", kind, "current_a") == pytest.approx(1.68740, abs=5e-6)
            assert value("slow", kind, "motor_speed_rad_s") == pytest.approx(0.81770, abs=5e-6)
            assert value("slow", kind, "output_speed_rad_s") == pytest.approx(0.012979, abs=5e-7)
            assert value("fast", kind, "current_a") == pytest.approx(3.46126, abs=5e-6)
            assert value("fast", kind, "output_speed_rad_s") == pytest.approx(0.025177, abs=5e-7)
        expect(page.locator('.chart[data-title="Current Plot"] canvas')).to_be_visible()


def test_a_constant_is_written_in_the_unit_that_was_chosen(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path) as session:
        enter(page, "plant.motor.slow.constant_v_s", "2e-4")
        assert checked(session.model).values["plant"]["motor"]["slow"]["constant_v_s"] == pytest.approx(
            2e-4 * 30 / math.pi
        )
        page.select_option('[data-at="plant.motor.slow.constant_v_s"] select', "V s/rad")
        assert float(page.input_value('[aria-label="plant.motor.slow.constant_v_s"]')) == pytest.approx(
            2e-4 * 30 / math.pi
        )


def test_a_point_that_breaks_grashof_marks_its_field_with_the_constraint(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path):
        show(page, "linkages")
        cell = page.locator(f'table[data-at="{POINTS}"] tr[data-point=A] input[data-axis="0"]')
        expect(cell).to_have_attribute("aria-invalid", "false")
        put_point(page, POINTS, "A", (0.08, 0.0055))
        expect(cell).to_have_attribute("aria-invalid", "true")
        assert "the crank OA is the shortest" in str(cell.get_attribute("title"))
        assert "shorten OA below" in str(cell.get_attribute("title"))
        expect(page.locator("#validity [role=status]")).to_contain_text("Not possible")
        expect(page.locator("#verdict")).to_have_text("does not run")
        expect(page.locator("nav button[data-panel=linkages] .count")).to_have_text("1")
        expect(page.locator("svg.drawing circle[data-point=A].wrong").first).to_be_visible()
        page.click("#undo")
        expect(cell).to_have_attribute("aria-invalid", "false")
        expect(page.locator("#validity [role=status]")).to_have_text("The configuration is possible.")


def test_coordinates_that_are_typed_quickly_are_all_taken(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path) as session:
        show(page, "linkages")
        for letter, point in {"A": (0.04, 0.005), "E": (0.2331, -0.0171)}.items():
            put_point(page, POINTS, letter, point)
            assert checked(session.model).values["plant"]["linkage"]["points_m"][letter][:2] == list(point)


def test_a_pivot_is_dragged_in_the_drawing(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path) as session:
        show(page, "linkages")
        pivot = page.locator("svg.drawing circle[data-point=E]").first
        pivot.wait_for()
        page.wait_for_timeout(300)
        box = pivot.bounding_box()
        assert box is not None
        middle = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] + 3, middle[1] + 2, steps=4)
        with page.expect_response(lambda answer: answer.url.endswith("/api/edit")):
            page.mouse.up()
        x, y, _ = checked(session.model).values["plant"]["linkage"]["points_m"]["E"]
        assert 0.2325 < x < 0.2425
        assert -0.0275 < y < -0.0175
        assert "E: [" + f"{x!r}, {y!r}" in session.model.texts["linkage.yaml"]


def test_the_arms_of_the_drawing_stand_as_the_closed_form_says(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path):
        show(page, "linkages")
        page.wait_for_selector("line[data-body=left_arm_1]")
        for frame in (0, 17, 60, 90, 133):
            page.evaluate(
                "frame => { const slider = document.querySelector('[aria-label=\"crank angle\"]');"
                " slider.value = frame; slider.dispatchEvent(new Event('input')); }",
                frame,
            )
            expect(page.locator("#crank-angle")).to_have_text(f"crank {2 * frame} deg")
            for side, angle_rad in arm_angles(math.radians(2.0 * frame)).items():
                line = page.locator(f"line[data-body={side}_arm_1]").first
                x1, y1, x2, y2 = (float(str(line.get_attribute(name))) for name in ("x1", "y1", "x2", "y2"))
                drawn = cmath.phase(complex(x2 - x1, y2 - y1))
                assert math.remainder(drawn - angle_rad, math.tau) == pytest.approx(0.0, abs=1e-6)


def test_the_park_drawing_shows_where_each_contact_is(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path) as session:
        page.select_option('[aria-label="motor type"]', "mechanical")
        page.click("text=Display motor diagram")
        lead = page.locator('circle[data-lead="slow"]')
        expect(lead).to_have_attribute("data-to", "supply")  # off, not yet at park: fed through the park contact
        page.check('[aria-label="cam at park"]')
        expect(lead).to_have_attribute("data-to", "ground")
        page.select_option('[aria-label="motor type"]', "depressed")
        back = page.locator('[aria-label="plant.park_switch.reverse_angle_deg"]')
        expect(back).to_be_visible()
        assert float(back.input_value()) == pytest.approx(0.2, abs=2e-5)  # as Figure 8-3 prints it
        assert checked(session.model).bench is not None


def test_text_and_form_lead_to_the_same_model(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path) as session:
        area = page.locator("textarea")
        page.click("[role=tab]:has-text('motor.yaml')")
        with page.expect_response(lambda answer: answer.url.endswith("/api/text")):
            area.fill(session.model.texts["motor.yaml"].replace("gear_ratio: 63.0", "gear_ratio: 71 # measured"))
        expect(page.locator('[aria-label="plant.motor.gear_ratio"]')).to_have_value("71")
        enter(page, "plant.motor.gear_ratio", "72")
        expect(area).to_have_value(session.model.texts["motor.yaml"])
        assert "gear_ratio: 72 # measured" in session.model.texts["motor.yaml"]
        with page.expect_response(lambda answer: answer.url.endswith("/api/text")):
            area.fill("name: [\n")
        expect(page.locator("#verdict")).to_have_text("does not run")
        expect(page.locator(".problems")).to_contain_text("motor.yaml:")


def test_solve_shows_every_body_and_its_joints(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path):
        show(page, "linkages")
        page.click("#solve")
        expect(page.locator("#solved canvas")).to_have_count(4)
        names = page.locator('[aria-label="body"] option').all_text_contents()
        assert {"crank", "coupler", "left_rocker", "link", "right_rocker", "left_blade_joint"} <= set(names)


def test_ten_edits_on_the_page_keep_every_comment(page: Page, tmp_path: Path) -> None:
    with modelling(page, tmp_path) as session:
        before = {name: text.count("#") for name, text in session.model.texts.items()}
        for number, key in enumerate(
            ("slow.resistance_ohm", "fast.resistance_ohm", "slow.inductance_henry", "gear_ratio"), 1
        ):
            enter(page, f"plant.motor.{key}", str(10 - number))
        show(page, "environment")
        for name in ("dry.mu_dry_1", "dry.mu_dry_2", "wet.mu_wet_1", "tacky.mu_tacky_3"):
            enter(page, f"plant.screen.{name}", "0.5")
        show(page, "blades")
        for side in ("left", "right"):
            enter(page, f"plant.linkage.{side}_blade.mass_kg", "0.25")
        assert {name: text.count("#") for name, text in session.model.texts.items()} == before
        values = checked(session.model).values["plant"]
        assert values["motor"]["slow"]["resistance_ohm"] == 9
        assert values["linkage"]["right_blade"]["mass_kg"] == 0.25
        assert open_model().texts.keys() == session.model.texts.keys()
