"""Resistances, breaks and short circuits between the switches and the motor, reduced to what the armature sees.

Battery (30) and ground (31) reach the motor through wires with resistance. Each motor terminal is a node: its wire
comes from where the switches lead, and conductances lead to 30, to ground, and from 53 to 53b. All is linear, so it
reduces exactly, for the armature current i that flows from a brush to the common terminal, to

    terminal voltage = source_v - resistance i,

and the armature keeps its closed form with the resistance added to its own (:mod:`hilplant.models.armature`).

A terminal at potential V that gives the current i to the motor has V = share P - R i, where P is the potential of 30
against the motor's ground, and takes load P + share i from it. With the battery's voltage E behind Rs this gives
P = (E - Rs sum(share i)) / (1 + Rs sum(load)).

Where both brushes are connected, the one that the switches chose keeps its dynamics. The current of the other one
follows at once, (V - K w)/R, without inductance and without mutual induction (assumed): seen from the shaft it is
viscous friction and a constant push.
"""

from typing import NamedTuple

from hilplant.jit import compiled
from hilplant.models.records import Brush, Wire, Wiring


class Port(NamedTuple):
    """A terminal as the motor sees it: `driven` 0 where nothing reaches it. SI; see the head of this file."""

    share: float
    resistance_ohm: float
    load_s: float
    driven: float


OPEN = Port(0.0, 0.0, 0.0, 0.0)


@compiled
def wired(share: float, driven: float, behind_ohm: float, load_s: float, wire: Wire) -> Port:
    """Return the terminal at the end of a wire.

    `share` is 1 where the wire begins at 30, 0 where at ground, anything between for a divider of `behind_ohm` that
    itself takes `load_s` from 30.
    """
    series = behind_ohm + wire.resistance_ohm
    connected = driven > 0.5 and wire.opened < 0.5
    if connected and wire.to_supply_s + wire.to_ground_s == 0.0:  # as below, without its quotients
        return Port(share, series, load_s, 1.0)
    if connected and series == 0.0:
        away = 1.0 - share
        return Port(share, 0.0, load_s + wire.to_ground_s * share * share + wire.to_supply_s * away * away, 1.0)
    through = 1.0 / series if connected else 0.0
    total = through + wire.to_supply_s + wire.to_ground_s
    if total == 0.0:
        return Port(0.0, 0.0, load_s, 0.0)
    from_supply = through * share + wire.to_supply_s
    # pair by pair, so that a terminal which takes nothing from 30 takes exactly nothing
    away = 1.0 - share
    pairs = through * (wire.to_supply_s * away * away + wire.to_ground_s * share * share)
    load = load_s + (pairs + wire.to_supply_s * wire.to_ground_s) / total
    return Port(from_supply / total, 1.0 / total, load, 1.0)


class Ports(NamedTuple):
    """The chosen brush, the other one and the common terminal; `mutual_ohm` is the resistance that both brushes share.

    `load_s` is what all terminals together take from 30.
    """

    first: Port
    second: Port
    common: Port
    mutual_ohm: float
    load_s: float


@compiled
def bridged(first: Port, second: Port, common: Port, brushes_s: float, others_s: float) -> Ports:
    """Return the terminals with a conductance between the two brushes; `others_s` is what other wires take from 30."""
    load = first.load_s + second.load_s + common.load_s + others_s
    if brushes_s == 0.0 or first.driven < 0.5:
        return Ports(first, second, common, 0.0, load)
    between, r1 = 1.0 / brushes_s, first.resistance_ohm
    if second.driven < 0.5:
        reached = Port(first.share, r1 + between, 0.0, 1.0)
        return Ports(first, reached, common, r1, load)
    r2, apart = second.resistance_ohm, first.share - second.share
    k = 1.0 / (between + r1 + r2)
    one = Port(first.share - k * r1 * apart, r1 - k * r1 * r1, first.load_s, 1.0)
    other = Port(second.share + k * r2 * apart, r2 - k * r2 * r2, second.load_s, 1.0)
    return Ports(one, other, common, k * r1 * r2, load + k * apart * apart)


class Second(NamedTuple):
    """What the current through the other brush does to the shaft besides lowering the constant, and how large it is."""

    damping_n_m_s: float = 0.0
    push_n_m: float = 0.0
    current_a: float = 0.0


NO_SECOND = Second(0.0, 0.0, 0.0)


class Shaft(NamedTuple):
    """Armature current [A] in the wiping direction, speed [rad/s], and 1 where the armature is cut out."""

    current_a: float
    speed_rad_s: float
    cut: float = 0.0


class Mesh(NamedTuple):
    """The network between the chosen brush and the common terminal, one way round: the wiping direction is positive.

    `level_v` and `inner_ohm` are the supply with all that loads it; `first` and `second` the shares of it that drive
    the two brushes.
    """

    closed: bool
    paired: bool
    level_v: float
    inner_ohm: float
    first: float
    second: float


@compiled
def cut_out(mesh: Mesh) -> Mesh:
    """Return the mesh with its armature cut out; what else loads the supply goes on doing so."""
    return Mesh(False, False, mesh.level_v, mesh.inner_ohm, mesh.first, mesh.second)


class Reduced(NamedTuple):
    """What the chosen armature path sees: a voltage, resistance and constant of its own, and the other brush's path."""

    source_v: float
    brush: Brush
    second: Second


class Potentials(NamedTuple):
    """Of the terminals against the ECU's ground [V], and the current that leaves the battery [A]."""

    first_v: float
    second_v: float
    common_v: float
    supply_v: float
    supply_current_a: float


@compiled
def meshed(ports: Ports, supply_v: float, polarity: float, wiring: Wiring) -> Mesh:
    """Return the mesh; `polarity` is -1 where the wiping direction is from the common terminal to the brush."""
    first = polarity * (ports.first.share - ports.common.share)
    second = polarity * (ports.second.share - ports.common.share)
    closed = ports.first.driven > 0.5 and ports.common.driven > 0.5
    drop = 1.0 + wiring.supply_resistance_ohm * ports.load_s
    level, inner = (supply_v - wiring.ground_offset_v) / drop, wiring.supply_resistance_ohm / drop
    paired = closed and ports.second.driven > 0.5
    if wiring.supply_opened > 0.5:
        level, inner, loaded = 0.0, 0.0, ports.load_s > 0.0
        if loaded:
            inner = 1.0 / ports.load_s
        closed = closed and (loaded or first == 0.0)
        paired = paired and closed and (loaded or second == 0.0)
    return Mesh(closed, paired, level, inner, first, second)


@compiled
def reduced(ports: Ports, mesh: Mesh, chosen: Brush, other: Brush, now: Shaft) -> Reduced:
    """Return the network as the path through the chosen brush sees it."""
    source, resistance = mesh.first * mesh.level_v, chosen.resistance_ohm + ports.first.resistance_ohm
    resistance += ports.common.resistance_ohm + mesh.inner_ohm * mesh.first * mesh.first
    if not mesh.paired:
        return Reduced(source, Brush(resistance, chosen.inductance_henry, chosen.constant_v_s), NO_SECOND)
    mutual = ports.mutual_ohm + ports.common.resistance_ohm + mesh.inner_ohm * mesh.first * mesh.second
    whole = other.resistance_ohm + ports.second.resistance_ohm + ports.common.resistance_ohm
    whole += mesh.inner_ohm * mesh.second * mesh.second
    coupling, driving, k = mutual / whole, mesh.second * mesh.level_v, other.constant_v_s
    brush = Brush(resistance - coupling * mutual, chosen.inductance_henry, chosen.constant_v_s - coupling * k)
    current = (driving - mutual * now.current_a - k * now.speed_rad_s) / whole
    return Reduced(source - coupling * driving, brush, Second(k * k / whole, k * driving / whole, current))


@compiled
def potentials(ports: Ports, mesh: Mesh, currents: tuple[float, float], polarity: float, wiring: Wiring) -> Potentials:
    """Return the potentials of the terminals that are driven while the two brushes carry `currents`; 0 of others."""
    one, other = polarity * currents[0], polarity * currents[1]
    taken = mesh.first * currents[0] + mesh.second * currents[1]
    supply = mesh.level_v - mesh.inner_ohm * taken
    first, second, common, ground = ports.first, ports.second, ports.common, wiring.ground_offset_v
    return Potentials(
        first_v=first.share * supply - first.resistance_ohm * one - ports.mutual_ohm * other + ground,
        second_v=second.share * supply - second.resistance_ohm * other - ports.mutual_ohm * one + ground,
        common_v=common.share * supply + common.resistance_ohm * (one + other) + ground,
        supply_v=supply + ground,
        supply_current_a=0.0 if wiring.supply_opened > 0.5 else ports.load_s * supply + taken,
    )
