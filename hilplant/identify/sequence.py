"""The test that a rig is recorded in: steps of voltage and mode, each held for turns of the crank (5.2, Figure 5-4).

A stage ends when the park contact has closed often enough, so each covers whole turns whatever the speed; a limit in
time keeps a dead park switch from holding a stage for ever. Time comes in as an argument: the same player serves a
bench in virtual time and a rig on a bus.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

#: Level that the pause before and after has, long enough for the offset of the current [s].
REST_S = 1.0


class SequenceStage(NamedTuple):
    """Voltage and mode until the park contact has closed `edges` times, or for `longest_s` at most.

    With 0 edges it simply lasts `longest_s`.
    """

    on: bool
    fast: bool
    voltage_v: float
    edges: int
    longest_s: float


class Player(NamedTuple):
    """Where a sequence stands."""

    place: int = 0
    entered_s: float = 0.0
    edges: int = 0
    contact: bool = True  # an edge counts only after the contact was seen open


OFF = SequenceStage(False, False, 0.0, 0, REST_S)


def figure_5_4(voltages_v: Sequence[float] = (10.0, 12.0, 14.0, 16.0), longest_s: float = 10.0) -> list[SequenceStage]:
    """Return the published sequence: each voltage for one turn, all in slow mode, then all in fast mode, then off."""
    first = voltages_v[0] if voltages_v else 0.0
    stages = [SequenceStage(True, fast, volts, 1, longest_s) for fast in (False, True) for volts in voltages_v]
    return [OFF._replace(voltage_v=first), *stages, OFF._replace(voltage_v=first)]


def informative(
    voltages_v: Sequence[float] = (10.0, 12.0, 14.0, 16.0), turns: int = 2, longest_s: float = 10.0
) -> list[SequenceStage]:
    """Return a sequence that tells more: switching on from rest at each voltage in both modes, and a step in motion.

    A start from rest has no back-EMF, so its first milliseconds show resistance and inductance alone; what follows
    shows inertia; steady turns at several voltages show constant, damping and dry torque; both modes share inertia and
    friction. All steps come at the park edge, where the wipers turn round and the load is alike.
    """
    stages = [OFF]
    lowest, highest = min(voltages_v), max(voltages_v)
    for fast in (False, True):
        for volts in voltages_v:
            other = highest if volts < 0.5 * (lowest + highest) else lowest
            stages += [
                OFF._replace(fast=fast, voltage_v=volts),
                SequenceStage(True, fast, volts, turns, longest_s),
                SequenceStage(True, fast, other, 1, longest_s),
            ]
    return [*stages, OFF._replace(voltage_v=lowest)]


def advance(player: Player, stages: Sequence[SequenceStage], contact: bool, now_s: float) -> Player:
    """Take one look at the park contact; return where the sequence stands. At the end the place is past the last."""
    if player.place >= len(stages):
        return player
    closed = contact and not player.contact
    player = player._replace(edges=player.edges + closed, contact=contact)
    stage = stages[player.place]
    done = 0 < stage.edges <= player.edges or now_s - player.entered_s >= stage.longest_s - 1e-9
    return Player(player.place + 1, now_s, 0, contact) if done else player


def play(
    stages: Sequence[SequenceStage], step_s: float, contact_after: Callable[[SequenceStage], bool]
) -> list[tuple[float, SequenceStage]]:
    """Run a sequence in virtual time; `contact_after` lets the plant take one step and gives its park contact.

    Returns when each stage began [s], and at the end the stage in which nothing is on any more.
    """
    player, tick, begun = Player(), 0, [(0.0, stages[0])]
    while player.place < len(stages):
        contact = contact_after(stages[player.place])
        tick += 1
        moved = advance(player, stages, contact, tick * step_s)
        if moved.place != player.place and moved.place < len(stages):
            begun.append((tick * step_s, stages[moved.place]))
        player = moved
    return [*begun, (tick * step_s, stages[-1])]


def scenario_text(begun: Sequence[tuple[float, SequenceStage]], title: str) -> str:
    """Return a scenario file with the instants at which a bench came to each stage."""
    signals: dict[str, list[tuple[float, str]]] = {"relay_on": [], "relay_fast": [], "supply_v": []}
    for time_s, stage in begun[:-1]:
        values = (str(stage.on).lower(), str(stage.fast).lower(), f"{stage.voltage_v:g}")
        for entries, value in zip(signals.values(), values, strict=True):
            if not entries or entries[-1][1] != value:
                entries.append((time_s, value))
    lines = [f"title: {title}", f"seconds: {begun[-1][0]:.9g}", "signals:"]
    for name, entries in signals.items():
        lines.append(f"  {name}:")
        lines += [f"    - [{time_s:.9g}, {value}]" for time_s, value in entries]
    return "\n".join(lines) + "\n"
