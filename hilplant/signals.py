"""Every signal that crosses a border of the plant.

The CAN mapping, the columns of a recording, the checks of a scenario and the tables in the documentation all come
from this list. Values are floats inside the plant: a flag is 0 or 1, a choice is the index of its name.
"""

from dataclasses import dataclass
from typing import Literal

from hilplant.units import TURN_RAD

Kind = Literal["real", "flag", "choice", "count"]


@dataclass(frozen=True, slots=True)
class Signal:
    """One signal: its name, unit, permitted range (inclusive), meaning, and value until something else is said.

    A count never falls; where it outgrows its frame it stays at the highest value, and that is no fault. A real
    signal may have names for some of its values.
    """

    name: str
    unit: str
    minimum: float
    maximum: float
    meaning: str
    kind: Kind = "real"
    default: float = 0.0
    choices: tuple[str, ...] = ()
    names: tuple[tuple[str, float], ...] = ()


def _flag(name: str, meaning: str) -> Signal:
    return Signal(name, "", 0.0, 1.0, meaning, "flag")


def _count(name: str, meaning: str) -> Signal:
    return Signal(name, "", 0.0, 2.0**53, meaning, "count")


def _factor(name: str, meaning: str) -> Signal:
    return Signal(name, "", 0.0, 100.0, meaning, default=1.0)


def _in_charge(name: str, meaning: str) -> Signal:
    return Signal(name, "", 0.0, len(IN_CHARGE) - 1.0, meaning, "choice", choices=IN_CHARGE)


SIDES = ("left", "right")

#: Wetness of the screen, from 0 to 1: friction changes from the dry curve to the tacky one and from there to the wet.
SCREENS = (("dry", 0.0), ("tacky", 0.5), ("wet", 1.0))
#: Which model gives the load's torque or moves the motor: physical (there is no network, or it has not been asked),
#: network; or the physical one because the motor stands, or because the network was not trained for what is asked.
IN_CHARGE = ("physical", "network", "standstill", "outside")
MODES = ("waiting", "running", "safe", "degraded", "stopped")
STALK_POSITIONS = ("off", "intermittent", "slow", "fast")
ECU_STATES = (
    "off", "flick", "single_wipe", "pause_1", "pause_2", "pause_3", "pause_4", "pause_5", "pause_6",
    "slow", "fast", "wait", "int_wait", "slow_wait", "fast_wait", "washing", "wash_wipes",
    "blind", "brown_out", "retry", "lockout",
)  # fmt: skip
ECU_FAULTS = (
    "none", "stall", "park_never_closes", "park_never_opens", "park_bounces", "off_park", "park_unknown",
    "brown_out", "stalk_lost",
)  # fmt: skip

#: What drives the plant, sampled once at the start of each tick.
INPUTS = (
    _flag("relay_on", "ON/OFF relay: 1 connects the brush to the supply, 0 grounds it (braking)"),
    _flag("relay_fast", "FAST/SLOW relay: 1 selects the fast brush, 0 the slow brush"),
    Signal("supply_v", "V", 0.0, 40.0, "supply voltage at the ON/OFF relay", default=13.5),
    Signal("screen", "", 0.0, 1.0, "wetness of the windscreen: 0 dry, 0.5 tacky, 1 wet", names=SCREENS),
    Signal("vehicle_speed_m_s", "m/s", 0.0, 100.0, "speed of the vehicle through still air"),
    Signal("brake_torque_n_m", "N m", 0.0, 1000.0, "dry friction torque added at the crank; a large one blocks it"),
    *(
        Signal(
            f"{side}_screen",
            "",
            -1.0,
            1.0,
            f"wetness under the {side} blade; below 0 it is that of `screen`",
            default=-1.0,
            names=(("same", -1.0), *SCREENS),
        )
        for side in SIDES
    ),
    *(_factor(f"{side}_wear", f"wear of the {side} blade: a factor on its friction coefficient") for side in SIDES),
    *(_factor(f"{side}_force", f"factor on the force of the {side} arm on its blade") for side in SIDES),
)

#: What the plant shows at each tick, after the inputs of that tick and before the motor moves on.
OUTPUTS = (
    Signal("supply_v", "V", 0.0, 40.0, "supply voltage in this tick"),
    Signal("terminal_v", "V", -40.0, 40.0, "voltage from the connected brush to the common one; 0 if shorted or open"),
    Signal("current_a", "A", -500.0, 500.0, "armature current, positive from the brush to ground"),
    Signal("motor_speed_rad_s", "rad/s", -2000.0, 2000.0, "speed of the motor shaft"),
    Signal("crank_speed_rad_s", "rad/s", -200.0, 200.0, "speed of the crank"),
    Signal("crank_angle_rad", "rad", 0.0, TURN_RAD, "crank angle from park, anticlockwise, below one turn"),
    Signal("load_torque_n_m", "N m", -1000.0, 1000.0, "load at the crank, positive when it opposes motion"),
    _flag("park_contact", "park switch: 1 while its contact is closed"),
    Signal("left_arm_rad", "rad", -TURN_RAD, TURN_RAD, "angle of the left arm from +X, anticlockwise"),
    Signal("right_arm_rad", "rad", -TURN_RAD, TURN_RAD, "angle of the right arm from +X, anticlockwise"),
    Signal("left_rocker_rad", "rad", -TURN_RAD, TURN_RAD, "angle of the left rocker from +X, anticlockwise"),
    Signal("right_rocker_rad", "rad", -TURN_RAD, TURN_RAD, "angle of the right rocker from +X, anticlockwise"),
    Signal("left_blade_m_s", "m/s", -50.0, 50.0, "speed of the left blade where the arm holds it, + anticlockwise"),
    Signal("right_blade_m_s", "m/s", -50.0, 50.0, "speed of the right blade where the arm holds it, + anticlockwise"),
    _flag("relay_on", "ON/OFF relay as the plant saw it, after any safe state"),
    _flag("relay_fast", "FAST/SLOW relay as the plant saw it, after any safe state"),
    _flag("guard", "1 once a number that is not finite was caught; the motor is held still until a restart"),
    Signal("terminal_53_v", "V", -500.0, 500.0, "terminal 53, slow brush, against ground"),
    Signal("terminal_53b_v", "V", -500.0, 500.0, "terminal 53b, fast brush, against ground"),
    Signal("terminal_53e_v", "V", -40.0, 40.0, "terminal 53e, from the park contact, against ground"),
    Signal("terminal_31_v", "V", -40.0, 40.0, "terminal 31, common brush, against ground"),
    Signal("left_force_n", "N", 0.0, 1e6, "force of the left blade on the screen, less lift"),
    Signal("right_force_n", "N", 0.0, 1e6, "force of the right blade on the screen, less lift"),
    _in_charge("load_mode", "which model gives the torque of the load, and why"),
    _in_charge("motor_mode", "which model moves the motor, and why"),
)

#: How the server itself fares. Counts saturate in the frames that carry them, not here.
STATUS = (
    _count("tick", "steps taken by the plant"),
    Signal("mode", "", 0.0, len(MODES) - 1.0, "what the server is doing", "choice", choices=MODES),
    _count("overruns", "periods lost because a tick came late"),
    Signal("worst_latency_us", "us", 0.0, 1e12, "longest delay from a deadline to the start of its tick", "count"),
    _count("unknown_frame", "frames with an identifier that is not mapped"),
    _count("wrong_length", "mapped frames with another length than the database's"),
    _count("remote_frame", "remote frames"),
    _count("fd_frame", "FD frames where a classic one is mapped, the reverse, or one the interface cannot carry"),
    _count("error_frame", "error frames from the controller"),
    _count("non_finite", "frames that carry a number which is not finite"),
    _count("out_of_range", "frames that carry a number outside its signal's range"),
    _count("wrong_crc", "protected frames whose checksum is wrong"),
    _count("wrong_counter", "protected frames whose alive counter is out of sequence"),
    _count("timeout", "times a supervised message stayed away"),
    _count("queue_full", "frames dropped because the interface took no more"),
    _count("missed_frame", "frames that the system dropped because the loop did not read them in time"),
    _count("link_down", "times the interface was lost"),
    _count("saturated", "sent values that were limited to what their frame can carry"),
    _count("ring_lost", "ticks or frames the recorder was too slow to take"),
)

#: What the stand-in ECU hears from the stalk, by the names of section 8.4 of Dooner (2016).
STALK = (
    Signal("master_input", "", 0.0, 3.0, "position of the stalk", "choice", choices=STALK_POSITIONS),
    Signal("intermittent_switch", "", 1.0, 6.0, "which of the six pauses", default=1.0),
    _flag("flick_wipe", "button for one fast wipe"),
    _flag("wash", "button for washer and wipes"),
)

#: What the stand-in ECU tells of itself.
ECU_STATUS = (
    Signal("ecu_state", "", 0.0, len(ECU_STATES) - 1.0, "what the ECU is doing", "choice", choices=ECU_STATES),
    Signal("ecu_fault", "", 0.0, len(ECU_FAULTS) - 1.0, "what the ECU found wrong", "choice", choices=ECU_FAULTS),
    _count("ecu_tries", "tries that went wrong since the wiper last went well"),
)

INPUT_INDEX = {signal.name: index for index, signal in enumerate(INPUTS)}
OUTPUT_INDEX = {signal.name: index for index, signal in enumerate(OUTPUTS)}
STATUS_INDEX = {signal.name: index for index, signal in enumerate(STATUS)}

#: Signals that a sent frame may carry, in the order of the list that the codec reads.
PUBLISHED = OUTPUTS + STATUS
PUBLISHED_INDEX = {signal.name: index for index, signal in enumerate(PUBLISHED)}

#: What the stand-in ECU hears and says: the plant's lists with its own behind them.
ECU_HEARD = PUBLISHED + STALK
ECU_SAID = INPUTS + ECU_STATUS
ECU_HEARD_INDEX = {signal.name: index for index, signal in enumerate(ECU_HEARD)}
ECU_SAID_INDEX = {signal.name: index for index, signal in enumerate(ECU_SAID)}
