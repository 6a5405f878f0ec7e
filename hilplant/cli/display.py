"""The live view of a running plant in a terminal: a picture at 80 x 24, or a plain line a second elsewhere.

It looks at the newest row in the ring and takes nothing from it, so neither loop nor recorder notices.
"""

import math
import time
from collections.abc import Callable
from typing import NamedTuple

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.table import Table
from rich.text import Text

from hilplant.arrays import Floats
from hilplant.cli.canvas import Canvas, Point
from hilplant.signals import INPUTS, MODES, OUTPUTS, STATUS
from hilplant.units import RAD_PER_DEG, SECOND_NS, TURN_RAD

_COLUMNS, _ROWS = 78, 22
_BAR_CELLS = 26
_PICTURES_PER_SECOND = 12.0
_MODE_STYLES = dict(zip(MODES, ("yellow", "green", "red", "yellow", "dim", "red"), strict=True))

# The screen is a sketch: right proportions for the shipped linkage, the angles are the plant's.
_LEFT_PIVOT, _RIGHT_PIVOT = (-0.27, 0.03), (0.20, 0.03)
_ARM_LENGTH, _BLADE_HALF_LENGTH = 0.69, 0.40
_GLASS: list[Point] = [(-1.52, 0.0), (-1.12, 1.14), (0.52, 1.14), (0.92, 0.0), (-1.52, 0.0)]


Newest = Callable[[], Floats]


class ShownRow(NamedTuple):
    """One row of the ring by name: inputs, outputs and status of a tick."""

    time_s: float
    inputs: dict[str, float]
    outputs: dict[str, float]
    status: dict[str, float]

    @property
    def mode(self) -> str:
        """What the server is doing."""
        return MODES[int(self.status["mode"])]

    @property
    def relays(self) -> str:
        """What the relays select."""
        if not self.inputs["relay_on"]:
            return "OFF"
        return "FAST" if self.inputs["relay_fast"] else "SLOW"


class Scene(NamedTuple):
    """What is shown beside the reading: a title, how far the run is, and what the driver wants."""

    title: str
    progress: str = ""
    stalk: str = ""


def reading(row: Floats) -> ShownRow:
    """Name the values of a row: tick, time [ns], inputs, outputs, status."""
    values = iter(row.tolist())
    next(values)
    time_s = next(values) / SECOND_NS
    named = [{signal.name: next(values) for signal in signals} for signals in (INPUTS, OUTPUTS, STATUS)]
    return ShownRow(time_s, *named)


def plain_line(now: ShownRow) -> str:
    """Return one line of figures, for a log or a pipe."""
    outputs, status = now.outputs, now.status
    return (
        f"{now.time_s:7.2f} s  {now.relays:<4}  crank {outputs['crank_angle_rad'] / RAD_PER_DEG:5.1f} deg  "
        f"{_per_minute(now):5.1f} /min  {outputs['current_a']:z6.2f} A  {outputs['terminal_v']:5.2f} V  "
        f"{'park' if outputs['park_contact'] else '    '}  {now.mode}  overruns {status['overruns']:.0f}"
    )


def picture(now: ShownRow, scene: Scene) -> RenderableType:
    """Return the whole picture, 78 columns by 21 rows."""
    head = Table.grid(expand=True)
    head.add_column()
    head.add_column(justify="right")
    head.add_row(Text(scene.title, "bold"), Text(scene.progress, "bold"))
    drawing = Table.grid(padding=(0, 2))
    drawing.add_row(Text(str(_screen(now)), "cyan"), _dial(now))
    return Group(head, _switches(now, scene), Text(), drawing, Text(), _gauges(now), Text(), _health(now))


def watch(
    newest: Newest,
    done: Callable[[], bool],
    scene: Callable[[float], Scene],
    console: Console,
    pause: Callable[[float], None] = time.sleep,
) -> None:
    """Show the newest row until `done`: a picture in a terminal that can show it, else one line a second."""
    if not _shows_pictures(console):
        _print_lines(newest, done, console, pause)
        return
    first = reading(newest())
    with Live(picture(first, scene(first.time_s)), console=console, auto_refresh=False) as live:
        while not done():
            now = reading(newest())
            live.update(picture(now, scene(now.time_s)), refresh=True)
            pause(1.0 / _PICTURES_PER_SECOND)


def _shows_pictures(console: Console) -> bool:
    large = console.width >= _COLUMNS and console.height >= _ROWS
    return console.is_terminal and large and console.encoding.startswith("utf")


def _print_lines(newest: Newest, done: Callable[[], bool], console: Console, pause: Callable[[float], None]) -> None:
    shown_s = -1.0
    while not done():
        now = reading(newest())
        if math.floor(now.time_s) > shown_s and now.status["tick"]:
            shown_s = math.floor(now.time_s)
            console.print(plain_line(now), highlight=False, soft_wrap=True)
        pause(0.05)


def _per_minute(now: ShownRow) -> float:
    return now.outputs["crank_speed_rad_s"] / TURN_RAD * 60.0


def _screen(now: ShownRow) -> Canvas:
    canvas = Canvas(48, 11, (-1.55, -0.02), 36.0)
    canvas.path(_GLASS)
    for pivot, name in ((_LEFT_PIVOT, "left_arm_rad"), (_RIGHT_PIVOT, "right_arm_rad")):
        _draw_arm(canvas, pivot, now.outputs[name])
    return canvas


def _draw_arm(canvas: Canvas, pivot: Point, angle_rad: float) -> None:
    along = (math.cos(angle_rad), math.sin(angle_rad))

    def at(distance: float, aside: float = 0.0) -> Point:
        return (
            pivot[0] + distance * along[0] - aside * along[1],
            pivot[1] + distance * along[1] + aside * along[0],
        )

    canvas.line(pivot, at(_ARM_LENGTH))
    for aside in (-0.03, 0.03):
        canvas.line(at(_ARM_LENGTH - _BLADE_HALF_LENGTH, aside), at(_ARM_LENGTH + _BLADE_HALF_LENGTH, aside))


def _dial(now: ShownRow) -> Text:
    """Draw the crank as a hand on a dial, park upwards; anticlockwise like the angle."""
    canvas = Canvas(22, 9, (-1.22, -1.0), 17.0)
    for index in range(120):
        canvas.dot(_on_dial(index / 120 * TURN_RAD, 1.0))
    angle_rad = now.outputs["crank_angle_rad"]
    canvas.line((0.0, 0.0), _on_dial(angle_rad, 0.85))
    label = f"crank {angle_rad / RAD_PER_DEG:5.1f} deg"
    return Text.assemble((f"{'park':^22}\n", "dim"), (f"{canvas}\n", "magenta"), f"{label:^22}")


def _on_dial(angle_rad: float, radius: float) -> Point:
    return -radius * math.sin(angle_rad), radius * math.cos(angle_rad)


def _switches(now: ShownRow, scene: Scene) -> Text:
    relay_style = {"OFF": "dim", "SLOW": "bold green", "FAST": "bold yellow"}[now.relays]
    park = ("closed", "bold green") if now.outputs["park_contact"] else ("open", "dim")
    stalk = ("stalk ", (f"{scene.stalk:<16}", "bold")) if scene.stalk else ()
    return Text.assemble(
        *stalk, "relays ", (f"{now.relays:<6}", relay_style), "park switch ", (f"{park[0]:<8}", park[1]),
        "mode ", (now.mode, _MODE_STYLES[now.mode]),
    )  # fmt: skip


def _gauges(now: ShownRow) -> Table:
    table = Table.grid(padding=(0, 1))
    outputs = now.outputs
    for name, value, unit, full in (
        ("speed", _per_minute(now), "cycles/min", 80.0),
        ("current", outputs["current_a"], "A", 10.0),
        ("terminal voltage", outputs["terminal_v"], "V", 16.0),
        ("load at the crank", outputs["load_torque_n_m"], "N m", 5.0),
    ):
        table.add_row(name, _bar(value, full), f"{value:z7.2f} {unit}")
    return table


def _bar(value: float, full: float) -> Text:
    filled = min(_BAR_CELLS, round(abs(value) / full * _BAR_CELLS))
    style = "green" if value >= 0.0 else "red"
    return Text.assemble(("█" * filled, style), ("░" * (_BAR_CELLS - filled), "dim"))


def _health(now: ShownRow) -> Text:
    status = now.status
    late = "red" if status["overruns"] else "green"
    return Text.assemble(
        f"tick {status['tick']:.0f}   overruns ", (f"{status['overruns']:.0f}", late),
        f"   worst latency {status['worst_latency_us']:.0f} us   not recorded {status['ring_lost']:.0f}",
    )  # fmt: skip
