"""The velocity controllers by name: the thesis', PID by another tuning, gains found by search, and the cascade."""

from collections.abc import Callable
from functools import partial

import numpy as np

from hilplant.control.controller import Tables
from hilplant.control.design import ObserverNoise, armature, internal_model_pid, model
from hilplant.control.fuzzy_sets import gain_table
from hilplant.control.records import LAWS, RULES, SOURCES, Cascade, Controller, Neuron, Pid, Stages
from hilplant.failure import Failure
from hilplant.models.records import Motor

#: Table 7-1.
THESIS_PID = Pid(0.00177, 35.452, 0.0)

#: Initial weights (integral, proportional, derivative). The thesis does not print them: of a grid of weights these
#: bring Tables 7-5 and 7-6 nearest. The Hebb rule hardly depends on them; the fixed-K quadratic one does.
INITIAL_WEIGHTS = {"hebb": (200.0, 200.0, 0.0), "error_hebb": (400.0, 0.0, 0.0), "quadratic": (1.0, 3.0, 0.5)}

#: Gains of the fuzzy controllers, 7.4.1.
FUZZY_GAINS = {"hebb": 0.5, "error_hebb": 1.5, "quadratic": 0.5}

#: K of each rule without overshoot, Table 7-5.
CALM_GAINS = {"hebb": 0.08, "error_hebb": 0.2, "quadratic": 0.05}

#: Gains found by the search of :mod:`hilplant.thesis.control_search` (seed 1): K or the fuzzy gain, learning
#: rates (integral, proportional, derivative), initial weights; "calm" has no overshoot, "quick" at most 0.6 rad/s.
SEARCHED: dict[tuple[str, str], tuple[float, ...]] = {
    ("hebb", "calm"): (6.259, 0.04469, 0.02958, 0.9878, 2.291, 562.8, 9.204),
    ("hebb", "quick"): (0.7697, 1.165, 0.01209, 0.0565, 363.8, 10.42, 1.447),
    ("error_hebb", "calm"): (5.667, 0.7439, 10.41, 0.3808, 0.6326, 41.15, 2.287),
    ("error_hebb", "quick"): (6.231, 15.52, 41.15, 0.1634, 35.4, 0.1156, 0.1705),
    ("quadratic", "calm"): (0.1406, 0.03994, 3.339, 0.1286, 1.388, 0.6326, 0.3263),
    ("quadratic", "quick"): (5.671, 0.3537, 1.659, 0.3655, 1.206, 0.2172, 0.8438),
}

#: The cascade's bandwidths [1/s]. The quickest that overshoots by less than 0.3 rad/s from every crank angle.
CASCADE = Cascade(speed_rate=250.0, current_rate=710.0)

#: Up to this period [s] the cascade has these bandwidths; beyond it the speed has this part of the period's rate.
FINE_PERIOD_S, BUS_PACE = 0.001, 0.15

#: What a name ends with for a controller without a speed sensor; and the part of each turn's error by which its
#: observer corrects the resistance.
SENSORLESS, ADAPTING = "_sensorless", 0.5

#: Section 7.6: up to the fast brush at 18 V on the slow one for 0.2 s; back where the slow brush would need less than
#: 16 V without load, and less than that with one: the lower threshold is this by the ratio of the brushes' constants.
UP_V, UP_HOLD_S, BACK_V = 18.0, 0.2, 16.0

#: What an observer assumes where only the current is measured: the load torque changes faster than sensors tell.
BLIND_NOISE = ObserverNoise(current_a=0.05, voltage_v=0.02, torque_rate=3.0)


def pid(motor: Motor, period_s: float, gains: Pid) -> Controller:
    """Return a PID controller."""
    return _known(motor, period_s)._replace(law=float(LAWS.index("pid")), pid=gains)


def neuron(motor: Motor, period_s: float, rule: str, gain: float, fuzzy: bool = False) -> Controller:
    """Return a single-neuron PID with a rule, a fixed K or the fuzzy system's gain, and the weights above."""
    settings = Neuron(
        float(RULES.index(rule)),
        gain,
        float(fuzzy),
        start_integral=INITIAL_WEIGHTS[rule][0],
        start_proportional=INITIAL_WEIGHTS[rule][1],
        start_derivative=INITIAL_WEIGHTS[rule][2],
    )
    return _known(motor, period_s)._replace(law=float(LAWS.index("neuron")), neuron=settings)


def searched_neuron(motor: Motor, period_s: float, goal: tuple[str, str], found: tuple[float, ...]) -> Controller:
    """Return a single-neuron PID with gains as the search writes them for a rule and an aim; "quick" has a fuzzy K."""
    rule, aim = goal
    settings = Neuron(float(RULES.index(rule)), found[0], float(aim == "quick"), *found[1:])
    return _known(motor, period_s)._replace(law=float(LAWS.index("neuron")), neuron=settings)


def cascade(motor: Motor, period_s: float) -> Controller:
    """Return the cascade: speed, current, and an observer that tells the load torque.

    At periods above 1 ms, as on a bus, a command is old by two periods when it acts. The speed is then asked to follow
    seven periods or so behind, and the current is left to the armature, which is quicker than a period.
    """
    rates = CASCADE
    if period_s > FINE_PERIOD_S:
        slow = motor.slow
        rates = Cascade(BUS_PACE / period_s, slow.resistance_ohm / slow.inductance_henry)
    return _known(motor, period_s)._replace(law=float(LAWS.index("cascade")), cascade=rates)


def sensorless(controller: Controller, motor: Motor, source: str, adapting: float = 0.0) -> Controller:
    """Return the same controller without a speed sensor: `source` is network or observer.

    The cascade's observer has to do without the speed as well. `adapting` is the part of each turn's error that
    corrects the resistance.

    Raises
    ------
    Failure
        For the cascade at more than 1 ms: with a current that is a bus period old it oscillates.

    """
    period_s = controller.period_s
    if controller.law == LAWS.index("cascade") and period_s > FINE_PERIOD_S:
        raise Failure(
            f"the cascade without a speed sensor needs a tick of {1e3 * FINE_PERIOD_S:g} ms, "
            f"not {1e3 * period_s:g} ms; without the sensor take pid or a single neuron here"
        )
    slow, fast = (model(armature(motor, brush), period_s, BLIND_NOISE, False) for brush in (False, True))
    place = float(SOURCES.index(source))
    return controller._replace(source=place, slow=slow, fast=fast, adapting=adapting)


def with_stages(controller: Controller, motor: Motor) -> Controller:
    """Return the same controller with both brushes, by the chart of section 7.6."""
    ratio = motor.fast.constant_v_s / motor.slow.constant_v_s
    return controller._replace(stages=Stages(UP_V, BACK_V * ratio, UP_HOLD_S, ratio))


def without_network() -> Tables:
    """Return the arrays for controllers that need no speed network."""
    return Tables(gain_table(), np.ones((4, 4)), np.ones((4, 4)))


def catalogue(motor: Motor, period_s: float) -> dict[str, Callable[[], Controller]]:
    """Return the makers of all controllers that have a name."""
    made: dict[str, Callable[[], Controller]] = {
        "pid": partial(pid, motor, period_s, THESIS_PID),
        "pid_imc": lambda: pid(motor, period_s, internal_model_pid(armature(motor, False), period_s)),
    }
    for rule in RULES:
        made[rule] = partial(neuron, motor, period_s, rule, CALM_GAINS[rule])
        made[f"{rule}_fuzzy"] = partial(neuron, motor, period_s, rule, FUZZY_GAINS[rule], True)
        for aim in ("calm", "quick"):
            goal = (rule, aim)
            if goal in SEARCHED:
                made[f"{rule}_{aim}"] = partial(searched_neuron, motor, period_s, goal, SEARCHED[goal])
    made["cascade"] = partial(cascade, motor, period_s)
    return made


def controller_named(name: str, motor: Motor, period_s: float) -> Controller:
    """Return one controller by its name; with `_sensorless` behind it, by the adapting observer instead of a sensor.

    Raises
    ------
    Failure
        When there is none of this name.

    """
    makers = catalogue(motor, period_s)
    plain = name.removesuffix(SENSORLESS)
    if plain not in makers:
        raise Failure(f"there is no controller {name!r}; there are {', '.join(makers)}, each also with {SENSORLESS}")
    made = makers[plain]()
    return made if plain == name else sensorless(made, motor, "observer", ADAPTING)


def _known(motor: Motor, period_s: float) -> Controller:
    """Return a controller that knows the motor, without a law yet."""
    slow, fast = (model(armature(motor, brush), period_s, ObserverNoise(), True) for brush in (False, True))
    return Controller(0.0, period_s, slow=slow, fast=fast)
