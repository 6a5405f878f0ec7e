"""The thesis' own checks of its models, one line each, with what this plant does beside them."""

from dataclasses import dataclass

import numpy as np

from hilplant.bench.assembly import Bench
from hilplant.models.records import Arm, Brush, Load, Parameters, ParkSwitch
from hilplant.models.tables import channels
from hilplant.motor_bench.no_load_fit import Miss, misses_of, read_motor, read_no_load, steady_state
from hilplant.signals import OUTPUT_INDEX
from hilplant.simulation.five_wipes import Wipe, five_wipes, shape_difference
from hilplant.simulation.run import simulate
from hilplant.thesis.solver import Rows, run_step

#: Of a motor fitted to Table 5-4, the largest miss of a current or a speed that is accepted.
FITTED_WITHIN = 0.04
#: What is called a slight difference of shapes, as a part of the mean.
SLIGHTLY = (0.01, 0.2)
_SETS = ("table_5_6", "table_5_8", "table_5_9")


@dataclass(frozen=True, slots=True)
class Check:
    """One claim: where it is made, what is looked at, what the thesis has (or, said so, what was
    computed from it), what we have, and whether it holds."""

    where: str
    what: str
    theirs: str
    ours: str
    holds: bool


def thesis_checks(bench: Bench) -> list[Check]:
    """Return all checks; the wiper of `bench` stands for the one of section 4.6."""
    return [*_appendix_a(), *_park_sequences(), *_section_4_6(five_wipes(bench)), *_table_5_4()]


def _appendix_a() -> list[Check]:
    """Run Table 3-1 as Appendix A does: slow from 1 s, fast from 2 s, off from 3 s, nothing on the shaft."""
    motor, supply_v = read_motor("table_3_1"), 12.0
    switch, arm = ParkSwitch(0.0, 0.12, 0.0, 0.0), Arm(0.0, 1.0)
    parameters = Parameters(1e-3, motor, switch, Load(0.0), arm, arm)
    rows = Rows(4000, supply_v=supply_v).set(1000, 3000, relay_on=1).set(2000, 4000, relay_fast=1).rows
    outputs = run_step(parameters, np.zeros((9, channels(1), 2)), rows)
    current, speed = (outputs[:, OUTPUT_INDEX[name]] for name in ("current_a", "motor_speed_rad_s"))
    found = [(float(current[tick]), float(speed[tick])) for tick in (1900, 2900, 3900)]
    slow, fast = (steady_state(brush, motor.damping_n_m_s, 0.0, supply_v) for brush in (motor.slow, motor.fast))
    return [
        _steady("slow", slow, found[0]),
        _steady("fast", fast, found[1]),
        Check(
            "Figure 3-10", "current and speed, slow and fast", "slow below fast",
            f"{found[0][0]:.3f} A < {found[1][0]:.3f} A, {found[0][1]:.4f} < {found[1][1]:.4f} rad/s",
            found[0][0] < found[1][0] and found[0][1] < found[1][1],
        ),
        Check("Appendix A", "after off", "at rest", f"{found[2][0]:.1e} A, {found[2][1]:.1e} rad/s",
              abs(found[2][0]) < 1e-9 and abs(found[2][1]) < 1e-9),
    ]  # fmt: skip


def _steady(stage: str, exact: tuple[float, float], ours: tuple[float, float]) -> Check:
    apart = max(abs(mine / true - 1.0) for mine, true in zip(ours, exact, strict=True))
    return Check(
        "Table 3-1",
        f"steady state, {stage}, 12 V, against (3.30), (3.31) at rest",
        f"computed: {exact[0]:.6f} A, {exact[1]:.6f} rad/s",
        f"{ours[0]:.6f} A, {ours[1]:.6f} rad/s",
        apart < 1e-9,
    )


def _park_sequences() -> list[Check]:
    """Slow, fast, off at 4 s with both circuits whose contacts carry the current."""
    mechanical, depressed = (simulate(circuit, "slow_fast_off") for circuit in ("mechanical", "depressed"))
    off_s, stop_s = 4.0, 0.3
    cut = _first(mechanical.time_s, mechanical.time_s > off_s, mechanical["terminal_v"] == 0.0)
    rest = _first(mechanical.time_s, mechanical.time_s > cut, mechanical["motor_speed_rad_s"] == 0.0)
    back = _first(depressed.time_s, depressed.time_s > off_s, depressed["terminal_v"] < 0.0)
    opened = _first(depressed.time_s, depressed.time_s > back, depressed["terminal_v"] == 0.0)
    slow = mechanical["terminal_53_v"][(mechanical.time_s > off_s) & (mechanical.time_s < cut - 0.01)]
    reversed_speed = float(
        depressed["crank_speed_rad_s"][(depressed.time_s > back) & (depressed.time_s < opened)].min()
    )
    return [
        Check("Figure 3-17", "off at 4 s: 53 is fed until park", "slow speed until about 5.3 s",
              f"{slow.min():.1f} V until {cut:.3f} s", bool((slow > 1.0).all()) and abs(cut - 5.3) < 0.1),
        Check("Figure 3-17", "at park", "stops immediately", f"at rest {1e3 * (rest - cut):.0f} ms later",
              rest - cut < stop_s),
        Check("Figure 3-22", "at park the motor turns back", "at about 5.25 s",
              f"at {back:.3f} s, to {reversed_speed:.1f} rad/s", abs(back - 5.25) < 0.05 and reversed_speed < 0.0),
        Check("Figure 3-22", "then it is disconnected; when depends on angle and motor", "at about 5.5 s",
              f"at {opened:.3f} s", back < opened < 5.6),
    ]  # fmt: skip


def _first(time_s: np.ndarray, *where: np.ndarray) -> float:
    found = np.flatnonzero(np.logical_and.reduce(where))
    return float(time_s[found[0]]) if len(found) else float("inf")


def _section_4_6(wipes: list[Wipe]) -> list[Check]:
    still, _, fast, again, dry = wipes
    means = [wipe.mean_n_m for wipe in wipes]
    apart = shape_difference(dry, still)
    return [
        Check("Figure 4-32", "mean torque at 0, 20, 40 m/s, wet", "falls, by lift",
              f"{means[0]:.2f}, {means[1]:.2f}, {means[2]:.2f} N m", means[0] > means[1] > means[2]),
        Check("Figure 4-32", "forward and reverse wipe at 40 m/s", "reverse above forward",
              f"{fast.forward_n_m:.2f} and {fast.reverse_n_m:.2f} N m", fast.reverse_n_m > fast.forward_n_m),
        Check("Figure 4-32", "back at 0 m/s", "as in the first wipe", f"{means[3]:.2f} N m",
              bool(np.array_equal(again.torque_n_m, still.torque_n_m))),
        Check("Figure 4-32", "dry against wet", "higher", f"{means[4]:.2f} and {means[0]:.2f} N m",
              means[4] > means[0]),
        Check("Figure 4-32", "shape dry against wet, friction over its mean", "differs slightly",
              f"RMS {100.0 * apart:.1f} % of the mean apart", SLIGHTLY[0] < apart < SLIGHTLY[1]),
    ]  # fmt: skip


def _table_5_4() -> list[Check]:
    """Measured currents and speeds of a real motor beside the fitted set, then beside the thesis' own sets."""
    measured = read_no_load()
    fitted = misses_of(read_motor("table_5_4"), measured.rows)
    checks = [_row(miss) for miss in fitted]
    motor = read_motor("table_5_4")
    checks.append(
        Check("(5.16)", "resistance slow, fast", "1.0, 0.8 ohm",
              f"{motor.slow.resistance_ohm}, {motor.fast.resistance_ohm} ohm",
              _resistances(motor.slow, motor.fast) == (1.0, 0.8))
    )  # fmt: skip
    worst_of_all = 0.0
    for name in _SETS:
        worst = max(abs(miss.current) for miss in misses_of(read_motor(name), measured.used))
        worst_of_all = max(worst, worst_of_all)
        checks.append(_own_set(name.replace("table_", "Table ").replace("_", "-"), worst))
    checks.append(
        Check("Table 5-4", "worst miss of the thesis' own sets", "computed by hand: 57 %",
              f"{100.0 * worst_of_all:.0f} %", round(100.0 * worst_of_all) == 57)
    )  # fmt: skip
    return checks


def _own_set(where: str, worst: float) -> Check:
    """Show how far a set without dry friction is off; that it is off is the claim."""
    found = f"off by up to {100.0 * worst:.0f} %"
    return Check(where, "its no-load currents against Table 5-4", "no dry friction", found, worst > FITTED_WITHIN)


def _resistances(slow: Brush, fast: Brush) -> tuple[float, float]:
    return slow.resistance_ohm, fast.resistance_ohm


def _row(miss: Miss) -> Check:
    row = miss.row
    within = max(abs(miss.current), abs(miss.speed)) <= FITTED_WITHIN
    left_out = ", left out of the fit: it does not fit its neighbours" if row.left_out else ""
    return Check(
        "Table 5-4",
        f"{row.stage}, {row.supply_v:g} V{left_out}",
        f"{row.current_a:.3f} A, {row.speed_rad_s:.2f} rad/s",
        f"{row.current_a * (1.0 + miss.current):.3f} A ({100.0 * miss.current:+.1f} %), "
        f"{row.speed_rad_s * (1.0 + miss.speed):.2f} rad/s ({100.0 * miss.speed:+.1f} %)",
        within != bool(row.left_out),
    )
