"""Every signal that crosses a border of the plant.

Each is declared once, in the record of floats that compiled code takes or gives. The CAN mapping, the columns of a
recording, the checks of a scenario and the tables in the documentation all come from these records. Values are floats
inside the plant: a flag is 0 or 1, a choice is the index of its name.
"""

from typing import Annotated, NamedTuple

from hilplant.declaration import choice, count, declared, flag, index_of, real
from hilplant.units import TURN_RAD

SIDES = ("left", "right")

#: Wetness of the screen, from 0 to 1: friction changes from the dry curve to the tacky one and from there to the wet.
SCREENS = (("dry", 0.0), ("tacky", 0.5), ("wet", 1.0))
#: The same for one side, where a number below 0 stands for what the whole screen has.
SIDE_SCREENS = (("same", -1.0), *SCREENS)
#: A wanted speed below 0 stands for what the controller was started with.
REFERENCES = (("own", -1.0),)
#: Which model gives the load's torque or moves the motor: physical (there is no network, or it has not been asked),
#: network; or the physical one because the motor stands, or because the network was not trained for what is asked.
ACTIVE_MODELS = ("physical", "network", "standstill", "outside")
MODES = ("waiting", "running", "safe", "degraded", "stopped", "behind")
#: Nobody records, everything is recorded, or something of the recording was lost.
RECORDING = ("off", "complete", "lossy")
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


class Inputs(NamedTuple):
    """What drives the plant, sampled once at the start of each tick."""

    relay_on: Annotated[
        float, flag("ON/OFF relay: 1 connects the brush to the supply, 0 grounds it (braking)", guarded=0.0)
    ] = 0.0
    relay_fast: Annotated[float, flag("FAST/SLOW relay: 1 selects the fast brush, 0 the slow brush", guarded=0.0)] = 0.0
    supply_v: Annotated[float, real("V", -16.0, 100.0, "supply voltage, of an ideal battery")] = 13.5
    screen: Annotated[
        float, real("", 0.0, 1.0, "wetness of the windscreen: 0 dry, 0.5 tacky, 1 wet", names=SCREENS)
    ] = 0.0
    vehicle_speed_m_s: Annotated[float, real("m/s", 0.0, 100.0, "speed of the vehicle through still air")] = 0.0
    brake_torque_n_m: Annotated[
        float, real("N m", 0.0, 1000.0, "dry friction torque added at the crank; a large one blocks it", guarded=0.0)
    ] = 0.0
    left_screen: Annotated[
        float, real("", -1.0, 1.0, "wetness under the left blade; below 0 it is that of `screen`", names=SIDE_SCREENS)
    ] = -1.0
    right_screen: Annotated[
        float, real("", -1.0, 1.0, "wetness under the right blade; below 0 it is that of `screen`", names=SIDE_SCREENS)
    ] = -1.0
    left_wear: Annotated[
        float, real("", 0.0, 100.0, "wear of the left blade: a factor on its friction coefficient")
    ] = 1.0
    right_wear: Annotated[
        float, real("", 0.0, 100.0, "wear of the right blade: a factor on its friction coefficient")
    ] = 1.0
    left_force: Annotated[float, real("", 0.0, 100.0, "factor on the force of the left arm on its blade")] = 1.0
    right_force: Annotated[float, real("", 0.0, 100.0, "factor on the force of the right arm on its blade")] = 1.0
    ambient_temperature_c: Annotated[float, real("degC", -60.0, 150.0, "temperature of the air around the motor")] = (
        20.0
    )
    rain_mm_h: Annotated[
        float, real("mm/h", 0.0, 500.0, "rain on the ground; wets the screen where water is modelled")
    ] = 0.0
    washer_pump: Annotated[float, flag("washer pump: 1 sprays the screen, where water is modelled", guarded=0.0)] = 0.0
    reference_rad_s: Annotated[
        float,
        real(
            "rad/s",
            -1.0,
            20.0,
            "wanted crank speed of a controller; below 0 it is the controller's own",
            names=REFERENCES,
        ),
    ] = -1.0


class Outputs(NamedTuple):
    """What the plant shows at each tick, after the inputs of that tick and before the motor moves on."""

    supply_v: Annotated[float, real("V", -40.0, 110.0, "potential of terminal 30, behind the supply's resistance")]
    terminal_v: Annotated[
        float, real("V", -110.0, 110.0, "voltage from the connected brush to the common one; 0 if shorted or open")
    ]
    current_a: Annotated[float, real("A", -500.0, 500.0, "armature current, positive from the brush to ground")]
    motor_speed_rad_s: Annotated[float, real("rad/s", -2000.0, 2000.0, "speed of the motor shaft")]
    crank_speed_rad_s: Annotated[float, real("rad/s", -200.0, 200.0, "speed of the crank")]
    crank_angle_rad: Annotated[
        float, real("rad", 0.0, TURN_RAD, "crank angle from park, anticlockwise, below one turn")
    ]
    load_torque_n_m: Annotated[
        float, real("N m", -1000.0, 1000.0, "load at the crank, positive when it opposes motion")
    ]
    park_contact: Annotated[float, flag("park switch: 1 while its contact is closed")]
    left_arm_rad: Annotated[float, real("rad", -TURN_RAD, TURN_RAD, "angle of the left arm from +X, anticlockwise")]
    right_arm_rad: Annotated[float, real("rad", -TURN_RAD, TURN_RAD, "angle of the right arm from +X, anticlockwise")]
    left_rocker_rad: Annotated[
        float, real("rad", -TURN_RAD, TURN_RAD, "angle of the left rocker from +X, anticlockwise")
    ]
    right_rocker_rad: Annotated[
        float, real("rad", -TURN_RAD, TURN_RAD, "angle of the right rocker from +X, anticlockwise")
    ]
    left_blade_m_s: Annotated[
        float, real("m/s", -50.0, 50.0, "speed of the left blade where the arm holds it, + anticlockwise")
    ]
    right_blade_m_s: Annotated[
        float, real("m/s", -50.0, 50.0, "speed of the right blade where the arm holds it, + anticlockwise")
    ]
    relay_on: Annotated[float, flag("ON/OFF relay as the plant saw it, after any safe state")]
    relay_fast: Annotated[float, flag("FAST/SLOW relay as the plant saw it, after any safe state")]
    guard: Annotated[
        float, flag("1 once a number that is not finite was caught; the motor is held still until a restart")
    ]
    terminal_53_v: Annotated[float, real("V", -500.0, 500.0, "terminal 53, slow brush, against ground")]
    terminal_53b_v: Annotated[float, real("V", -500.0, 500.0, "terminal 53b, fast brush, against ground")]
    terminal_53e_v: Annotated[float, real("V", -110.0, 110.0, "terminal 53e, from the park contact, against ground")]
    terminal_31_v: Annotated[float, real("V", -110.0, 110.0, "terminal 31, common brush, against ground")]
    left_force_n: Annotated[float, real("N", 0.0, 1e6, "force of the left blade on the screen, less lift")]
    right_force_n: Annotated[float, real("N", 0.0, 1e6, "force of the right blade on the screen, less lift")]
    load_mode: Annotated[float, choice(ACTIVE_MODELS, "which model gives the torque of the load, and why")]
    motor_mode: Annotated[float, choice(ACTIVE_MODELS, "which model moves the motor, and why")]
    supply_current_a: Annotated[float, real("A", -2000.0, 2000.0, "current that leaves the supply")]
    measured_current_a: Annotated[float, real("A", -2000.0, 2000.0, "armature current as its sensor shows it")]
    winding_temperature_c: Annotated[
        float, real("degC", -100.0, 2000.0, "temperature of the winding; as at the start where heat is not modelled")
    ]
    thermal_switch: Annotated[float, flag("1 while the motor's thermal switch is open")]
    wetness: Annotated[float, real("", 0.0, 1.0, "wetness of the screen: that of `screen`, or more by its water film")]
    water_film_mm: Annotated[
        float, real("mm", 0.0, 1e4, "mean thickness of the water on the screen; 0 where it is not modelled")
    ]
    rain_sensor: Annotated[float, real("", 0.0, 1.0, "signal of the rain sensor: 0 dry, towards 1 with the film")]


class Status(NamedTuple):
    """How the server itself fares. Counts saturate in the frames that carry them, not here."""

    tick: Annotated[float, count("steps taken by the plant", wraps=True)]
    mode: Annotated[float, choice(MODES, "what the server is doing")]
    overruns: Annotated[float, count("periods lost because a tick came late")]
    worst_latency_us: Annotated[float, count("longest delay from a deadline to the start of its tick", "us", 1e12)]
    unknown_frame: Annotated[float, count("frames with an identifier that is not mapped")]
    wrong_length: Annotated[float, count("mapped frames with another length than the database's")]
    remote_frame: Annotated[float, count("remote frames")]
    fd_frame: Annotated[
        float, count("FD frames where a classic one is mapped, the reverse, or one the interface cannot carry")
    ]
    error_frame: Annotated[float, count("error frames from the controller")]
    non_finite: Annotated[float, count("frames that carry a number which is not finite")]
    out_of_range: Annotated[float, count("frames that carry a number outside its signal's range")]
    wrong_crc: Annotated[float, count("protected frames whose checksum is wrong")]
    wrong_counter: Annotated[float, count("protected frames whose alive counter is out of sequence")]
    timeout: Annotated[float, count("times a supervised message stayed away")]
    queue_full: Annotated[float, count("frames dropped because the interface took no more")]
    missed_frame: Annotated[float, count("frames that the system dropped because the loop did not read them in time")]
    link_down: Annotated[float, count("times the interface was lost")]
    saturated: Annotated[float, count("sent values that were limited to what their frame can carry")]
    ring_lost: Annotated[float, count("ticks or frames the recorder was too slow to take")]
    recording: Annotated[float, choice(RECORDING, "whether ticks and frames are recorded, all of them")]
    own_identifier: Annotated[float, count("frames of others under an identifier that this node alone sends")]
    alternating: Annotated[
        float, count("commands that took back at once what the one before had changed, as of two senders")
    ]
    stale_frame: Annotated[
        float, count("commands that had waited in the system for longer than their timeout, as after a stall")
    ]
    e2e_not_valid: Annotated[
        float, count("protected frames that were good while AUTOSAR's state machine was not valid, or not yet")
    ]
    faults_active: Annotated[float, real("", 0.0, 255.0, "how many inserted faults are there now")]
    fault_shown: Annotated[
        float, real("", 0.0, 255.0, "number of a fault that is there, each in turn for 100 ms; 0 while there is none")
    ]


class StalkInputs(NamedTuple):
    """What the stand-in ECU hears from the stalk, by the names of section 8.4 of Dooner (2016)."""

    master_input: Annotated[float, choice(STALK_POSITIONS, "position of the stalk")] = 0.0
    intermittent_switch: Annotated[float, real("", 1.0, 6.0, "which of the six pauses")] = 1.0
    flick_wipe: Annotated[float, flag("button for one fast wipe")] = 0.0
    wash: Annotated[float, flag("button for washer and wipes")] = 0.0
    automatic: Annotated[float, flag("the rain sensor decides, in the place of the position")] = 0.0


class EcuStatus(NamedTuple):
    """What the stand-in ECU tells of itself."""

    ecu_state: Annotated[float, choice(ECU_STATES, "what the ECU is doing")]
    ecu_fault: Annotated[float, choice(ECU_FAULTS, "what the ECU found wrong")]
    ecu_tries: Annotated[float, count("tries that went wrong since the wiper last went well")]


INPUTS, OUTPUTS, STATUS = declared(Inputs), declared(Outputs), declared(Status)
STALK, ECU_STATUS = declared(StalkInputs), declared(EcuStatus)
INPUT_INDEX, OUTPUT_INDEX, STATUS_INDEX = index_of(INPUTS), index_of(OUTPUTS), index_of(STATUS)

#: Which input carries a controller's wanted speed.
WANTED = INPUT_INDEX["reference_rad_s"]

#: Signals that a sent frame may carry, in the order of the list that the codec reads.
PUBLISHED = OUTPUTS + STATUS
PUBLISHED_INDEX = index_of(PUBLISHED)

#: What an ECU hears and says: the plant's lists, a wanted speed that somebody sends, and its own behind them.
ECU_RX = (*PUBLISHED, INPUTS[WANTED], *STALK)
ECU_TX = INPUTS + ECU_STATUS
ECU_RX_INDEX, ECU_TX_INDEX = index_of(ECU_RX), index_of(ECU_TX)
