"""Draws what acts on the blades: friction over speed (Figures 4-22, 4-26) and the forces of the air (Figure 4-30)."""

from os import PathLike
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.assembly import Bench
from hilplant.plots.picture import plain_figure, save
from hilplant.simulation.air_forces import PUBLISHED, AirSet, bench_air
from hilplant.simulation.crank_torque import WETNESS
from hilplant.simulation.friction_curves import (
    FrictionSet,
    bench_friction,
    blade_speeds,
    mu_over_speed,
    published_sets,
)
from hilplant.units import RAD_PER_S_PER_RPM

_COLORS = {"dry": "#b3261e", "tacky": "#d9730d", "wet": "#0b5cad"}
_GREY = "#6b7280"
#: Turns of the crank a minute at which the blades' speeds are marked: about slow and fast.
TURNS_A_MINUTE = (40.0, 60.0)
#: Forces on a blade [N] at which the wet curve is drawn: it depends on the force, (4.50).
FORCES_N = (5.0, 10.0, 15.0)


def plot_friction(bench: Bench, out: str | PathLike[str]) -> None:
    """Draw a bench's friction over the blades' speed, the range of the literature above, the range in use below."""
    found = bench_friction(bench)
    figure, (low, whole) = plain_figure((10, 8), 2)
    fastest = max(blade_speeds(bench, turns * RAD_PER_S_PER_RPM).largest_mm_s for turns in TURNS_A_MINUTE)
    for axes, highest in ((low, 100.0), (whole, 1.05 * max(fastest, found.curve.velocity_limit_mm_s))):
        _curves(axes, found, np.linspace(0.0, highest, 1001))
        axes.set_xlim(0.0, highest)
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel("coefficient of friction")
    _speeds_in_use(whole, bench)
    low.legend(loc="center right", bbox_to_anchor=(1.0, 0.42), frameon=False, fontsize=9, ncols=2)
    whole.set_xlabel("speed of the blade on the screen [mm/s]")
    figure.suptitle(f"{bench.name}: (4.49), (4.50), at {found.force_n:.3g} N on the blade", parse_math=False)
    save(figure, out, 110)


def _curves(axes: Any, found: FrictionSet, speeds: Floats) -> None:
    for name, color in _COLORS.items():
        assumed = ", assumed" if name == "tacky" else ""
        axes.plot(speeds, mu_over_speed(found, WETNESS[name], speeds), color=color, label=f"{name}{assumed}")
    for force, line in zip(FORCES_N, ("--", "-.", ":"), strict=True):
        wet = mu_over_speed(found._replace(force_n=force), WETNESS["wet"], speeds)
        axes.plot(speeds, wet, color=_COLORS["wet"], linestyle=line, linewidth=0.9, label=f"wet at {force:g} N")


def _speeds_in_use(axes: Any, bench: Bench) -> None:
    """Mark the median and the largest speed of the blades, and where the curves are held."""
    for turns, line in zip(TURNS_A_MINUTE, ("-", "--"), strict=True):
        for word, speed in zip(("median", "largest"), blade_speeds(bench, turns * RAD_PER_S_PER_RPM), strict=True):
            axes.axvline(speed, color=_GREY, linewidth=0.8, linestyle=line)
            text = f" {word} at {turns:g} turns a minute"
            axes.text(speed, 0.98, text, transform=axes.get_xaxis_transform(), rotation=90, va="top", fontsize=7)
    limit = bench.parameters.load.friction.velocity_limit_mm_s
    axes.axvspan(limit, axes.get_xlim()[1], color=_GREY, alpha=0.12, linewidth=0)
    axes.text(limit, 0.02, " held from here on", transform=axes.get_xaxis_transform(), fontsize=8)


def plot_published_friction(out: str | PathLike[str]) -> None:
    """Draw the sets of Tables 4-1 and 4-2 as Figures 4-22 and 4-26 do, and the wet one over the force."""
    figure, (dry, wet, force) = plain_figure((10, 11), 3)
    for axes, screen, speeds in (
        (dry, "dry", np.linspace(0.0, 100.0, 1001)),
        (wet, "wet", np.linspace(0.0, 1000.0, 1001)),
    ):
        for found in published_sets(screen):
            label = found.name if screen == "dry" else f"{found.name}, {found.force_n:g} N"
            axes.plot(speeds, mu_over_speed(found, WETNESS[screen], speeds), label=label)
        axes.set_xlabel("speed [mm/s]")
        axes.legend(loc="lower right" if screen == "dry" else "upper right", frameon=False, fontsize=9, ncols=2)
    dry.set_title("dry, (4.49), Table 4-1, Figure 4-22", loc="left", fontsize=10)
    wet.set_title("wet, (4.50), Table 4-2, Figure 4-26", loc="left", fontsize=10)
    first, forces = published_sets("wet")[0], np.linspace(0.0, 20.0, 101)
    for speed in (10.0, 100.0, 500.0):
        mu = [mu_over_speed(first._replace(force_n=f), WETNESS["wet"], np.array([speed]))[0] for f in forces]
        force.plot(forces, mu, label=f"{speed:g} mm/s")
    force.set_title("wet over the force, Friction 1: it rises, as printed", loc="left", fontsize=10)
    force.set_xlabel("force [N]")
    force.legend(frameon=False, fontsize=9)
    for axes in (dry, wet, force):
        axes.set_ylabel("coefficient of friction")
        axes.set_ylim(bottom=0.0)
    save(figure, out, 110)


def plot_aero(bench: Bench, out: str | PathLike[str], fastest_m_s: float = 40.0) -> None:
    """Draw drag and lift over the vehicle's speed: the published blades, and a bench's with the range of a sweep."""
    figure, (drag, lift) = plain_figure((10, 7.5), 2)
    speeds = np.linspace(0.0, fastest_m_s, 201)
    colors = ("#1f2937", "#2a7f3e", "#0b5cad", "#d9730d")
    for each, color in zip((*PUBLISHED, *bench_air(bench)), colors, strict=True):
        line = "-" if each in PUBLISHED else "--"
        for axes, limits in ((drag, each.drag), (lift, each.lift)):
            _band(axes, each, limits, speeds, (color, line))
    drag.set_ylabel("drag [N], along the forward wipe")
    lift.set_ylabel("lift [N], away from the screen")
    lift.axhline(0.0, color=_GREY, linewidth=0.8)
    lift.set_xlabel("speed of the vehicle [m/s]")
    drag.legend(frameon=False, fontsize=9)
    figure.suptitle(f"{bench.name}: forces of the air on one blade, (4.51), (4.52)", parse_math=False)
    save(figure, out, 110)


def _band(axes: Any, each: AirSet, limits: tuple[float, float], speeds: Floats, look: tuple[str, str]) -> None:
    color, line = look
    low, high = (each.forces_n(limit, speeds) for limit in limits)
    axes.plot(speeds, high, color=color, linestyle=line, label=f"{each.name}: {limits[1]:g}")
    if limits[0] != limits[1]:
        axes.fill_between(speeds, low, high, color=color, alpha=0.15, linewidth=0)
