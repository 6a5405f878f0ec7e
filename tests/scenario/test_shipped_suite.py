"""The shipped tests of a wiper ECU: the stand-in passes them all, and does not with a bug seeded into it."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from hilplant import resources
from hilplant.bench import Bench
from hilplant.ecu import node, relay_controller
from hilplant.ecu.chart import EXITS, SPEEDS, Phase
from hilplant.ecu.vocabulary import Fault
from hilplant.simulation.scenario import load_scenario
from hilplant.testing.scenario_test import run_virtually
from hilplant.testing.suite import DEFAULT_BENCH, Benches
from hilplant.testing.words import lines_of

SUITE = resources.shipped("config", "tests")
FILES = sorted(SUITE.glob("*.yaml"))


@pytest.fixture(scope="module")
def benches() -> Benches:
    return Benches()


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_the_stand_in_ecu_passes(path: Path, benches: Benches) -> None:
    scenario = load_scenario(path)
    bench = benches.named(scenario.bench or DEFAULT_BENCH)
    assert scenario.requirement, f"{path.name} names no requirement"
    done = run_virtually(scenario, bench)
    assert done.ruling == "pass", "\n".join(lines_of(done))


Seed = Callable[[pytest.MonkeyPatch, Bench], Bench]


def setting(**changed: Any) -> Seed:
    def seed(_patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
        return replace(bench, ecu=bench.ecu.model_copy(update=changed))

    return seed


def exits(phases: tuple[Phase, ...], change: Callable[[Any], Any]) -> Seed:
    """Change each transition out of these phases; None takes it away."""

    def seed(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
        for phase in phases:
            rows = [change(row) for row in EXITS[phase]]
            patch.setitem(EXITS, phase, tuple(row for row in rows if row is not None))
        return bench

    return seed


def to(target: Phase, instead: Phase) -> Callable[[Any], Any]:
    return lambda row: row._replace(target=instead) if row.target is target else row


def flick_is_slow(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
    patch.setitem(SPEEDS, Phase.FLICK, False)
    return bench


def never_forgives(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
    patch.setattr(relay_controller, "_forgive", lambda state, *_: state)
    return bench


def sends_seldom(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
    own = node._commands
    patch.setattr(node, "_commands", lambda sent: [replace(each, period_ns=200_000_000) for each in own(sent)])
    return bench


def deaf_to_silence(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
    patch.setattr(node.EcuNode, "_known", lambda self, target: self._node.values[target])
    return bench


def ignores_crc(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
    from hilplant.bus.protection import Checker, FrameCheck

    patch.setattr(Checker, "check", lambda self, data: FrameCheck.OK)
    return bench


def ignores_counter(patch: pytest.MonkeyPatch, bench: Bench) -> Bench:
    from hilplant.bus.protection import Checker, FrameCheck

    own = Checker.check
    patch.setattr(
        Checker,
        "check",
        lambda self, data: FrameCheck.OK if (found := own(self, data)) is FrameCheck.WRONG_COUNTER else found,
    )
    return bench


PAUSES = tuple(Phase(f"pause_{number}") for number in range(1, 7))
#: A bug, and the shipped test that finds it.
BUGS: dict[str, tuple[Seed, str]] = {
    "wrong pause": (setting(pauses_s=(1.0, 2.0, 4.5, 7.0, 12.0, 18.0)), "09_intermittent_3"),
    "interval switch ignored": (setting(pauses_s=(1.0,) * 6), "08_intermittent_2"),
    "off stops at once": (exits((Phase.SLOW, Phase.FAST), to(Phase.WAIT, Phase.OFF)), "04_park_from_slow"),
    "speed change off park": (exits((Phase.SLOW,), to(Phase.FAST_WAIT, Phase.FAST)), "13_speed_change_at_park"),
    "park never seen": (setting(debounce_s=1e9), "05_park_from_fast"),
    "slow is ignored in a pause": (
        exits(PAUSES, lambda row: None if row.target is Phase.SLOW else row),
        "14_slow_from_pause",
    ),
    "flick at the slow speed": (flick_is_slow, "15_flick"),
    "one wipe after washing": (setting(wash_wipes=1), "16_wash"),
    "no stall protection": (setting(stall_current_a=1e9), "17_stall"),
    "stall protection is late": (setting(stall_s=2.0), "17_stall"),
    "retry without end": (setting(tries=10**9), "17_stall"),
    "retry without rest": (setting(retry_pause_s=0.1), "17_stall"),
    "lockout never ends": (exits((Phase.LOCKOUT,), lambda row: None), "17_stall"),
    "no reaction to a brown-out": (setting(brown_out_v=0.0), "18_brown_out"),
    "resumes at too low a supply": (setting(resume_v=6.0), "18_brown_out"),
    "resumes without waiting": (setting(resume_s=0.0), "18_brown_out"),
    "the fault is never forgotten": (never_forgives, "18_brown_out"),
    "wrong fault is reported": (
        exits((Phase.SLOW,), lambda row: row._replace(fault=Fault.STALL) if row.target is Phase.BROWN_OUT else row),
        "18_brown_out",
    ),
    "found off park and left there": (
        exits((Phase.OFF,), lambda row: None if row.fault is Fault.OFF_PARK else row),
        "23_found_off_park",
    ),
    "drives without end": (setting(turn_timeout_s=1e9), "26_creeps_off_park"),
    "relay command too seldom": (sends_seldom, "27_bus_timing"),
    "deaf to a silent park switch": (deaf_to_silence, "38_park_switch_silent"),
    "wrong checksums are taken": (ignores_crc, "39_park_switch_wrong_checksum"),
    "a counter that stands is taken": (ignores_counter, "40_park_switch_stuck_counter"),
    "a park contact that chatters is driven on": (setting(bounce_edges=10**9), "32_park_contact_chatters"),
    "a contact that never opens is waited for": (setting(leave_timeout_s=1e9), "30_park_contact_stuck_closed"),
    "a bounce counts as an opening": (setting(debounce_s=0.0), "31_park_contact_bounces"),
}


@pytest.mark.parametrize("name", BUGS)
def test_a_seeded_bug_is_found(name: str, benches: Benches, monkeypatch: pytest.MonkeyPatch) -> None:
    seed, found_by = BUGS[name]
    scenario = load_scenario(SUITE / f"{found_by}.yaml")
    done = run_virtually(scenario, seed(monkeypatch, benches.named(scenario.bench or DEFAULT_BENCH)))
    assert done.ruling == "fail", f"{name}: {done.ruling}"
