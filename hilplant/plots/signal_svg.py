"""Draws one signal over time as SVG text: the limits as a band, the window shaded, marks on the axis, the violation."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

from hilplant.arrays import Floats

_WIDTH, _HEIGHT = 760, 190
_LEFT, _RIGHT, _TOP, _BOTTOM = 62, 12, 22, 34
_COLUMNS = 700
#: Width of a letter and height of a line of the labels.
_LETTER, _LINE = 6.5, 12
_BLUE, _RED, _GREEN, _GREY = "#0b5cad", "#b3261e", "#2a7f3e", "#6b7280"


@dataclass(frozen=True)
class SignalDrawing:
    """What to draw: values of each tick, limits (infinite: none), times [s] of the window, marks and violation.

    `forbidden`: the values between the limits are those that must not be.
    """

    name: str
    unit: str
    step_s: float
    values: Floats
    limits: tuple[float, float]
    window: tuple[float, float]
    marks: Mapping[str, float] = field(default_factory=dict)
    violation_s: float | None = None
    forbidden: bool = False


def signal_svg(drawing: SignalDrawing) -> str:
    """Return the drawing; its width follows the page."""
    values = drawing.values
    finite = values[np.isfinite(values)]
    if not len(finite):
        return f"<p>{escape(drawing.name)}: no value came</p>"
    duration = max(len(values) * drawing.step_s, drawing.step_s)
    limits = [limit for limit in drawing.limits if np.isfinite(limit)]
    low, high = _range(float(finite.min()), float(finite.max()), limits)
    axes = _Axes(duration, low, high)
    parts = [
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(drawing.name)} over time">',
        *_background(axes, drawing),
        *_grid(axes, drawing),
        f'<path d="{_path(axes, values, drawing.step_s)}" fill="none" stroke="{_BLUE}" stroke-width="1.4"/>',
        *_marks(axes, drawing),
        "</svg>",
    ]
    return "".join(parts)


@dataclass(frozen=True)
class _Axes:
    duration: float
    low: float
    high: float

    def x(self, time_s: float) -> float:
        inside = min(max(time_s / self.duration, 0.0), 1.0)
        return _LEFT + inside * (_WIDTH - _LEFT - _RIGHT)

    def y(self, value: float) -> float:
        inside = min(max((value - self.low) / (self.high - self.low), 0.0), 1.0)
        return _HEIGHT - _BOTTOM - inside * (_HEIGHT - _TOP - _BOTTOM)


def _range(lowest: float, highest: float, limits: Sequence[float]) -> tuple[float, float]:
    """Return the vertical range: all values, and the limits unless they are far away."""
    span = max(highest - lowest, 1e-9 * max(abs(lowest), abs(highest), 1.0))
    flat = span < 1e-6
    near = [limit for limit in limits if flat or lowest - 4.0 * span <= limit <= highest + 4.0 * span]
    low, high = min([lowest, *near]), max([highest, *near])
    room = 0.06 * (high - low) or 0.5
    return low - room, high + room


def _background(axes: _Axes, drawing: SignalDrawing) -> list[str]:
    left, right = axes.x(drawing.window[0]), axes.x(drawing.window[1])
    top, bottom = axes.y(min(drawing.limits[1], axes.high)), axes.y(max(drawing.limits[0], axes.low))
    parts = [_rect(_LEFT, _TOP, _WIDTH - _RIGHT, _HEIGHT - _BOTTOM, "#f6f7f9")]
    parts.append(_rect(left, top, right, bottom, "#fbe3e1" if drawing.forbidden else "#dff0e3"))
    for limit in drawing.limits:
        if np.isfinite(limit) and axes.low <= limit <= axes.high:
            line = f'x1="{left:.1f}" x2="{right:.1f}" y1="{axes.y(limit):.1f}" y2="{axes.y(limit):.1f}"'
            parts.append(f'<line {line} stroke="{_GREEN}" stroke-width="1.2" stroke-dasharray="5 3"/>')
    return parts


def _rect(left: float, top: float, right: float, bottom: float, fill: str) -> str:
    width, height = max(right - left, 0.0), max(bottom - top, 0.0)
    return f'<rect x="{left:.1f}" y="{top:.1f}" width="{width:.1f}" height="{height:.1f}" fill="{fill}"/>'


def _grid(axes: _Axes, drawing: SignalDrawing) -> list[str]:
    parts = []
    for value in _ticks(axes.low, axes.high, 4):
        y = axes.y(value)
        parts.append(f'<line x1="{_LEFT}" x2="{_WIDTH - _RIGHT}" y1="{y:.1f}" y2="{y:.1f}" stroke="#d8dbe0"/>')
        parts.append(_text(_LEFT - 6, y + 4, f"{value:.6g}", "end"))
    for value in _ticks(0.0, axes.duration, 8):
        parts.append(_text(axes.x(value), _HEIGHT - _BOTTOM + 14, f"{value:g}", "middle"))
    unit = f" [{drawing.unit}]" if drawing.unit else ""
    parts.append(_text(_LEFT, _TOP - 7, f"{drawing.name}{unit}", "start", _BLUE))
    parts.append(_text(_WIDTH - _RIGHT, _HEIGHT - 4, "time [s]", "end"))
    return parts


def _ticks(low: float, high: float, most: int) -> list[float]:
    raw = (high - low) / most
    power = 10.0 ** np.floor(np.log10(raw))
    step = next(power * factor for factor in (1.0, 2.0, 5.0, 10.0) if power * factor >= raw)
    first = np.ceil(low / step - 1e-9)
    return [float(k * step) + 0.0 for k in np.arange(first + 0.0, np.floor(high / step + 1e-9) + 1)]


def _path(axes: _Axes, values: Floats, step_s: float) -> str:
    """Return lowest and highest of each column, so that no peak is lost."""
    stride = max(1, -(-len(values) // _COLUMNS))
    points: list[str] = []
    for first in range(0, len(values), stride):
        column = values[first : first + stride]
        known = column[np.isfinite(column)]
        if not len(known):
            continue
        ends = [known[0]] if len(known) == 1 else [known[0], known.min(), known.max(), known[-1]]
        x = axes.x((first + 0.5 * (len(column) - 1)) * step_s)
        points += [f"{x:.1f} {axes.y(float(value)):.1f}" for value in dict.fromkeys(ends)]
    return "M" + "L".join(points)


def _marks(axes: _Axes, drawing: SignalDrawing) -> list[str]:
    parts: list[str] = []
    written: list[tuple[float, float, int]] = []
    for name, time_s in sorted(drawing.marks.items(), key=lambda mark: mark[1]):
        x, wide = axes.x(time_s), len(name) * _LETTER
        line = f'x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}"'
        parts.append(f'<line {line} stroke="{_GREY}" stroke-dasharray="2 3"/>')
        begin = x + 3 if x + 3 + wide < _WIDTH else x - 3 - wide
        taken = {row for first, last, row in written if first < begin + wide and begin < last}
        row = next(row for row in range(len(written) + 1) if row not in taken)
        written.append((begin, begin + wide, row))
        base = _HEIGHT - _BOTTOM - 5 - row * _LINE
        parts.append(_text(begin, base, name, "start") if begin > x else _text(x - 3, base, name, "end"))
    if drawing.violation_s is not None:
        place = min(max(round(drawing.violation_s / drawing.step_s), 0), len(drawing.values) - 1)
        x, value = axes.x(drawing.violation_s), drawing.values[place]
        y = axes.y(float(value)) if np.isfinite(value) else _HEIGHT - _BOTTOM
        parts.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{_TOP}" y2="{_HEIGHT - _BOTTOM}" stroke="{_RED}"/>')
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4.5" fill="none" stroke="{_RED}" stroke-width="2"/>')
    return parts


def _text(x: float, y: float, text: str, anchor: str, fill: str = "#374151") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{fill}">{escape(text)}</text>'
