"""The live view: what it shows of a row, that it fits 80 x 24, and when it falls back to lines."""

import io
import math

import numpy as np
import pytest
from numpy.typing import NDArray
from rich.console import Console

from hilplant.cli.canvas import Canvas
from hilplant.cli.display import Scene, picture, plain_line, reading, watch
from hilplant.signals import INPUT_INDEX, INPUTS, OUTPUT_INDEX, OUTPUTS, STATUS, STATUS_INDEX

FIRST_INPUT = 2
FIRST_OUTPUT = FIRST_INPUT + len(INPUTS)
FIRST_STATUS = FIRST_OUTPUT + len(OUTPUTS)


def row_at(time_s: float, **outputs: float) -> NDArray[np.float64]:
    """Return a row of a wiper that runs fast, at a time."""
    row = np.zeros(FIRST_STATUS + len(STATUS))
    row[1] = time_s * 1e9
    row[FIRST_INPUT + INPUT_INDEX["relay_on"]] = 1.0
    row[FIRST_INPUT + INPUT_INDEX["relay_fast"]] = 1.0
    row[FIRST_STATUS + STATUS_INDEX["tick"]] = time_s * 1000.0
    row[FIRST_STATUS + STATUS_INDEX["mode"]] = 1.0
    for name, value in outputs.items():
        row[FIRST_OUTPUT + OUTPUT_INDEX[name]] = value
    return row


def shown(row: NDArray[np.float64], width: int = 80) -> list[str]:
    console = Console(file=io.StringIO(), width=width, height=24, force_terminal=True, color_system=None)
    with console.capture() as capture:
        console.print(picture(reading(row), Scene("title", "1.0 of 2 s", "intermittent")))
    return capture.get().splitlines()


def test_the_picture_fits_a_terminal_of_80_by_24_at_extreme_values():
    extreme = {signal.name: signal.minimum for signal in OUTPUTS}
    row = row_at(86400.0, **extreme)
    row[FIRST_STATUS:] = 1e9
    row[FIRST_STATUS + STATUS_INDEX["mode"]] = 3.0
    for lines in (shown(row), shown(row_at(0.0))):
        assert len(lines) <= 22
        assert max(len(line) for line in lines) <= 80


def test_the_picture_names_relays_park_mode_crank_and_current():
    row = row_at(3.0, crank_angle_rad=math.radians(123.4), current_a=4.56, park_contact=1.0)
    text = "\n".join(shown(row))
    for part in ("FAST", "closed", "running", "123.4 deg", "4.56 A", "tick 3000", "stalk intermittent"):
        assert part in text


@pytest.mark.parametrize("stalk", ["intermittent 6", "off + flick", "off + wash"])
def test_what_the_driver_does_stands_apart_from_the_relays(stalk):
    console = Console(file=io.StringIO(), width=80, height=24, force_terminal=True, color_system=None)
    with console.capture() as capture:
        console.print(picture(reading(row_at(1.0)), Scene("title", stalk=stalk)))
    assert f"stalk {stalk}  " in capture.get()


def test_a_plain_line_holds_the_figures():
    line = plain_line(reading(row_at(3.25, crank_speed_rad_s=2.0 * math.pi, current_a=4.5)))
    assert line.split()[:3] == ["3.25", "s", "FAST"]
    assert "60.0 /min" in line
    assert "4.50 A" in line


@pytest.mark.parametrize("size", [(None, None), (60, 24), (80, 20)])
def test_without_a_terminal_or_in_a_small_one_there_is_one_line_a_second(size):
    width, height = size
    file = io.StringIO()
    terminal = width is not None
    console = Console(file=file, width=width, height=height, force_terminal=terminal, color_system=None)
    times = iter(np.arange(0.01, 3.0, 0.05))
    now_s = [0.0]

    def done() -> bool:
        now_s[0] = next(times, math.inf)
        return math.isinf(now_s[0])

    watch(lambda: row_at(now_s[0]), done, lambda _: Scene("title"), console, pause=lambda _: None)
    lines = file.getvalue().splitlines()
    assert [line.split()[0].split(".")[0] for line in lines] == ["0", "1", "2"]


def test_a_line_on_the_canvas_runs_from_corner_to_corner_and_what_is_outside_is_left_out():
    canvas = Canvas(2, 1, (0.0, 0.0), 1.0)
    canvas.line((0.0, 0.0), (3.0, 3.0))
    canvas.dot((4.0, 0.0))
    canvas.dot((0.0, -1.0))
    assert str(canvas) == chr(0x2800 + 0x40 + 0x20) + chr(0x2800 + 0x02 + 0x08)
