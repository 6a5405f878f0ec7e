"""The catalogue of faults: an entry is all that a fault needs, in scenarios, on the running bench and in the docs."""

import math

from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure
from hilplant.faults.bus_catalogue import BUS_FAULTS
from hilplant.faults.fault import Change, FaultDefinition, Quantity, Way
from hilplant.faults.mechanical_catalogue import MECHANICAL_FAULTS

#: The motor's terminals by DIN 72552, and what hangs on each.
TERMINALS = {"53": "slow brush", "53b": "fast brush", "53e": "park contact", "31": "common brush"}
RELAYS = {"on": "ON/OFF relay", "fast": "FAST/SLOW relay"}

#: The least resistance of a short circuit: welded, with the wire to it.
_WELDED_OHM = 1e-3


def _plain(element: str, quantity: str, way: Way = "add") -> Change:
    return Change(element, way, lambda values, step_s: values[quantity])


def _constant(element: str, value: float) -> Change:
    return Change(element, "set", lambda values, step_s: value)


def _conductance(element: str) -> Change:
    return Change(element, "add", lambda values, step_s: 1.0 / values["resistance_ohm"])


def _ticks(element: str) -> Change:
    return Change(element, "add", lambda values, step_s: float(round(values["time_s"] / step_s)))


_SHORT = Quantity("resistance_ohm", _WELDED_OHM, 1e6, "resistance of the short circuit [ohm]", 0.01)
_SERIES = Quantity("resistance_ohm", 0.0, 1e6, "resistance in series [ohm]")
_TIME = Quantity("time_s", 0.0, 10.0, "how long it takes [s]")


def _at_terminal(terminal: str, what: str) -> list[FaultDefinition]:
    wire = f"wiring.wire_{terminal}"
    beside = "; nothing while its wire is sound, another way to ground where that is broken" if terminal == "31" else ""
    return [
        FaultDefinition(
            f"open_{terminal}", "electrical", f"wire to terminal {terminal} ({what}) broken",
            "no current through the wire; short circuits at the motor's end stay", (_constant(f"{wire}.opened", 1.0),),
        ),
        FaultDefinition(
            f"resistance_{terminal}", "electrical", f"contact resistance at terminal {terminal} ({what})",
            "V(terminal) = V(switch) - R i", (_plain(f"{wire}.resistance_ohm", "resistance_ohm"),), (_SERIES,),
        ),
        FaultDefinition(
            f"short_{terminal}_to_30", "electrical", f"terminal {terminal} ({what}) touches the supply",
            "a conductance 1/R from the terminal to 30", (_conductance(f"{wire}.to_supply_s"),), (_SHORT,),
        ),
        FaultDefinition(
            f"short_{terminal}_to_31", "electrical", f"terminal {terminal} ({what}) touches ground",
            f"a conductance 1/R from the terminal to ground{beside}", (_conductance(f"{wire}.to_ground_s"),), (_SHORT,),
        ),
    ]  # fmt: skip


#: What the contact does in the time after its command changes; before and after, it is where it was and where it goes.
_RELAY_EFFECTS = {
    "operates_late": "commanded on: for the time at rest still, then pulled in",
    "releases_late": "commanded off: for the time pulled in still, then at rest",
    "transfers_slowly": "commanded anew: for the time touching neither contact, no current, then there",
    "bounces": "arrived: for the time in every second tick lifted off, no current, then there",
}


def _at_relay(relay: str, what: str) -> list[FaultDefinition]:
    at = f"relays.{relay}"
    timings = {"operates_late": "operate_ticks", "releases_late": "release_ticks", "transfers_slowly": "transfer_ticks"}
    slow = [
        FaultDefinition(f"relay_{relay}_{name}", "relay", f"{what} {name.replace('_', ' ')}",
              _RELAY_EFFECTS[name], (_ticks(f"{at}.{element}"),), (_TIME,))
        for name, element in (timings | {"bounces": "bounce_ticks"}).items()
    ]  # fmt: skip
    return [
        FaultDefinition(f"relay_{relay}_stuck_released", "relay", f"{what} does not pull in",
              "contact at rest whatever is commanded", (_constant(f"{at}.stuck", 1.0),)),
        FaultDefinition(f"relay_{relay}_stuck_operated", "relay", f"{what} welded",
              "contact pulled in whatever is commanded", (_constant(f"{at}.stuck", 2.0),)),
        *slow,
    ]  # fmt: skip


def _scaled(element: str, factor: float | None, power: int = 1) -> Change:
    """Scale by 1 - `share` to a power, or by the quantity `factor`."""
    if factor is None:
        return Change(element, "scale", lambda values, step_s: values["factor"])
    return Change(element, "scale", lambda values, step_s: (1.0 - values["share"]) ** power)


_BRUSHES = ("motor.slow", "motor.fast")
#: What goes with a power of the number of turns.
_BY_TURNS = (("resistance_ohm", 1), ("constant_v_s", 1), ("inductance_henry", 2))
_SHARE = Quantity("share", 0.0, 0.9, "part of the turns that is shorted")
_FACTOR = Quantity("factor", 0.0, 10.0, "what is left, as a factor")

#: Every fault of the plant, by kind.
FAULTS: tuple[FaultDefinition, ...] = (
    *(fault for terminal, what in TERMINALS.items() for fault in _at_terminal(terminal, what)),
    FaultDefinition("short_53_to_53b", "electrical", "the two brushes' wires touch",
          "a conductance 1/R between 53 and 53b; the second path follows without inductance",
          (_conductance("wiring.brushes_s"),), (_SHORT,)),
    FaultDefinition("supply_open", "electrical", "fuse blown or main switch off",
          "no current from the supply: the motor coasts, it does not brake", (_constant("wiring.supply_opened", 1.0),)),
    FaultDefinition("supply_resistance", "electrical", "corroded battery clamp or long harness",
          "V(30) = E - R i", (_plain("wiring.supply_resistance_ohm", "resistance_ohm"),), (_SERIES,)),
    FaultDefinition("ground_offset", "electrical", "the motor's ground is not the ECU's",
          "all terminals of the motor are shifted; E is less by it", (_plain("wiring.ground_offset_v", "offset_v"),),
          (Quantity("offset_v", -2.0, 2.0, "potential of the motor's ground against the ECU's [V]"),)),
    *(fault for relay, what in RELAYS.items() for fault in _at_relay(relay, what)),
    FaultDefinition("park_stuck_open", "park switch", "park contact never closes",
          "contact 0; it is so in the circuit that it is part of", (_constant("sensors.park_stuck", 1.0),)),
    FaultDefinition("park_stuck_closed", "park switch", "park contact welded",
          "contact 1; it is so in the circuit that it is part of", (_constant("sensors.park_stuck", 2.0),)),
    FaultDefinition("park_bounces", "park switch", "park contact bounces at each edge",
          "the contact changes in every tick for the time", (_ticks("park_switch.bounce_ticks"),), (_TIME,)),
    FaultDefinition("park_shifted", "park switch", "cam turned on its shaft",
          "the window lies at its angle plus the shift",
          (Change("park_switch.angle_rad", "add", lambda values, step_s: math.radians(values["angle_deg"])),),
          (Quantity("angle_deg", -90.0, 90.0, "shift of the window in the wiping direction [deg]"),)),
    FaultDefinition("current_sensor_gain", "sensor", "gain of the current sensor off",
          "measured = factor i", (_scaled("sensors.current_gain", None),), (_FACTOR,)),
    FaultDefinition("current_sensor_offset", "sensor", "offset of the current sensor",
          "measured = i + offset", (_plain("sensors.current_offset_a", "offset_a"),),
          (Quantity("offset_a", -100.0, 100.0, "added to the measured current [A]"),)),
    FaultDefinition("current_sensor_noise", "sensor", "noise of the current sensor",
          "measured = i + n, n normal and white", (_plain("sensors.current_noise_a", "deviation_a"),),
          (Quantity("deviation_a", 0.0, 100.0, "standard deviation [A]"),)),
    FaultDefinition("current_sensor_saturates", "sensor", "current sensor ends at a limit",
          "measured = i between -limit and limit", (_plain("sensors.current_limit_a", "limit_a", "set"),),
          (Quantity("limit_a", 0.01, 1000.0, "where it ends [A]"),)),
    FaultDefinition("worn_brushes", "motor", "brushes worn down",
          "R + R(worn) at both brushes",
          tuple(_plain(f"{brush}.resistance_ohm", "resistance_ohm") for brush in _BRUSHES), (_SERIES,)),
    FaultDefinition("winding_short", "motor", "part of the armature's turns shorted",
          "R and k times 1 - share, L times (1 - share)^2, at both brushes (assumed: the shorted turns only lack)",
          tuple(_scaled(f"{brush}.{element}", 0.0, power) for brush in _BRUSHES for element, power in _BY_TURNS),
          (_SHARE,)),
    FaultDefinition("weak_magnets", "motor", "magnets weak, from heat or age",
          "k times the factor at both brushes", tuple(_scaled(f"{brush}.constant_v_s", None) for brush in _BRUSHES),
          (Quantity("factor", 0.1, 1.0, "what is left of the magnets' field"),)),
    FaultDefinition("stiff_bearing", "motor", "dry or seized bearing of the motor",
          "Coulomb torque plus the torque", (_plain("motor.coulomb_torque_n_m", "torque_n_m"),),
          (Quantity("torque_n_m", 0.0, 10.0, "dry friction added at the motor shaft [N m]"),)),
    *MECHANICAL_FAULTS,
)  # fmt: skip

#: All faults: those of the plant, and those of the bus.
BY_NAME = {fault.name: fault for fault in (*FAULTS, *BUS_FAULTS)}

#: The number of each, from 1: what the bus tells instead of the name.
NUMBERS = {name: number for number, name in enumerate(BY_NAME, 1)}


def fault_named(name: str) -> FaultDefinition:
    """Return a fault of the catalogue.

    Raises
    ------
    Failure
        With the nearest name, where there is none of that name.

    """
    if name not in BY_NAME:
        near = suggestion(name, BY_NAME)
        raise Failure(f"there is no fault '{name}'{near if near.endswith('?') else '; hilplant faults lists all'}")
    return BY_NAME[name]
