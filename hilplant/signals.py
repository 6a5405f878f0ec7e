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

    A count never falls; where it outgrows its frame it stays at the highest value, and that is no fault.
    """

    name: str
    unit: str
    minimum: float
    maximum: float
    meaning: str
    kind: Kind = "real"
    default: float = 0.0
    choices: tuple[str, ...] = ()


def _flag(name: str, meaning: str) -> Signal:
    return Signal(name, "", 0.0, 1.0, meaning, "flag")


def _count(name: str, meaning: str) -> Signal:
    return Signal(name, "", 0.0, 2.0**53, meaning, "count")


SCREENS = ("dry", "wet")
MODES = ("waiting", "running", "safe", "degraded", "stopped")

#: What drives the plant, sampled once at the start of each tick.
INPUTS = (
    _flag("relay_on", "ON/OFF relay: 1 connects the brush to the supply, 0 grounds it (braking)"),
    _flag("relay_fast", "FAST/SLOW relay: 1 selects the fast brush, 0 the slow brush"),
    Signal("supply_v", "V", 0.0, 40.0, "supply voltage at the ON/OFF relay", default=13.5),
    Signal("screen", "", 0.0, len(SCREENS) - 1.0, "state of the windscreen", "choice", choices=SCREENS),
    Signal("vehicle_speed_m_s", "m/s", 0.0, 100.0, "speed of the vehicle through still air"),
    Signal("brake_torque_n_m", "N m", 0.0, 1000.0, "dry friction torque added at the crank; a large one blocks it"),
)

#: What the plant shows at each tick, after the inputs of that tick and before the motor moves on.
OUTPUTS = (
    Signal("supply_v", "V", 0.0, 40.0, "supply voltage in this tick"),
    Signal("terminal_v", "V", 0.0, 40.0, "voltage at the connected brush; 0 when it is grounded"),
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

INPUT_INDEX = {signal.name: index for index, signal in enumerate(INPUTS)}
OUTPUT_INDEX = {signal.name: index for index, signal in enumerate(OUTPUTS)}
STATUS_INDEX = {signal.name: index for index, signal in enumerate(STATUS)}

#: Signals that a sent frame may carry, in the order of the list that the codec reads.
PUBLISHED = OUTPUTS + STATUS
PUBLISHED_INDEX = {signal.name: index for index, signal in enumerate(PUBLISHED)}
