"""PID, single neurons, stages and the commands around them, against plain formulas written again here."""

import math

import numpy as np
import pytest

from hilplant.control.catalogue import catalogue, controller_named, with_stages
from hilplant.control.catalogue import without_network as tables
from hilplant.control.controller import control
from hilplant.control.design import armature, internal_model_pid
from hilplant.control.records import POWER_ON, Controller, Measured, Neuron, NeuronMemory, Pid, PidMemory, Stage, Stages
from hilplant.control.reference import parse_reference
from hilplant.control.single_neuron import single_neuron
from hilplant.control.stages import choose_stage
from hilplant.failure import Failure
from hilplant.models.records import Brush, Motor

MOTOR = Motor(Brush(1.237, 3.148e-3, 4.579e-2), Brush(1.026, 2.571e-3, 3.412e-2), 1.983e-5, 1.582e-4, 0.0, 63.0)
TABLES = tables()
SPEEDS = 3.0 + np.random.default_rng(1).normal(0.0, 0.3, 300)
REFERENCE = math.pi


def voltages(controller: Controller, speeds: np.ndarray, reference: float = REFERENCE) -> np.ndarray:
    memory, result = POWER_ON, []
    for speed in speeds:
        memory, command = control(memory, Measured(float(speed), 1.0, 0.0), reference, controller, TABLES)
        result.append(command.voltage_v)
    return np.array(result)


def test_pid_is_the_sum_of_its_three_terms_between_the_limits():
    controller = Controller(0.0, 0.001, pid=Pid(1.5, 40.0, 0.002), lowest_v=-1e9, highest_v=1e9)
    errors = REFERENCE - SPEEDS
    before = np.concatenate([[0.0], errors[:-1]])
    expected = 1.5 * errors + 40.0 * np.cumsum(errors) * 0.001 + 0.002 * (errors - before) / 0.001
    assert voltages(controller, SPEEDS) == pytest.approx(expected, rel=1e-12)


def test_pid_leaves_a_limit_in_the_tick_in_which_the_error_turns():
    controller = Controller(0.0, 0.001, pid=Pid(1.0, 40.0, 0.0))
    result = voltages(controller, np.concatenate([np.zeros(20_000), np.full(500, 3.3)]))
    assert result.max() == 20.0
    assert result[19_999] == 20.0
    assert result[20_000] < 20.0
    assert np.all(np.diff(result[20_001:]) < 0.0)


def weights_after(rule: str, errors: tuple[float, float, float], u: float, w: np.ndarray) -> np.ndarray:
    """Equations (7.8) to (7.10), written out once more, with x3 = e - 2 e1 + e2 and K = 0.3."""
    (e, e1, e2), gain = errors, 0.3
    x, rates = np.array([e, e - e1, e - 2.0 * e1 + e2]), np.array([1.0, 1.5, 1.0])
    if rule == "hebb":
        return w + rates * e * u * x
    if rule == "error_hebb":
        return w + rates * e * u * (e + (e - e1))
    return w + rates * gain * (2.0 * 1.0 * e * x - 1.0 * gain * np.dot(w, x) * x)


@pytest.mark.parametrize(("number", "rule"), list(enumerate(["hebb", "error_hebb", "quadratic"])))
def test_each_rule_learns_and_commands_as_its_equation_says(number, rule):
    start = np.array([0.3, 0.5, 0.2])
    neuron = Neuron(float(number), 0.3, 0.0, 1.0, 1.5, 1.0, *(float(value) for value in start))
    controller = Controller(1.0, 0.001, neuron=neuron)
    w, e1, e2, u = start, 0.0, 0.0, 0.0
    for e, voltage in zip(REFERENCE - SPEEDS, voltages(controller, SPEEDS), strict=True):
        increment = 0.3 * np.dot(w, [e, e - e1, e - 2.0 * e1 + e2]) / np.abs(w).sum()
        u = min(max(u + increment, 0.0), 20.0)
        assert voltage == pytest.approx(u, abs=1e-9)
        w, e1, e2 = weights_after(rule, (e, e1, e2), u, w), e, e1


def test_with_the_printed_sign_the_error_hebb_rule_never_moves_the_motor():
    """All weights rise alike in (7.9); with a constant error the printed inputs then sum up to a negative one."""
    e = math.pi
    printed = np.array([e, 0.0, e - 2.0 * e - e])
    corrected = np.array([e, 0.0, e - 2.0 * e + e])
    rates = np.array([1.0, 1.5, 1.0])
    assert np.dot(rates, printed) < 0.0 < np.dot(rates, corrected)
    assert voltages(controller_named("error_hebb", MOTOR, 0.001), np.zeros(100))[-1] > 5.0


@pytest.mark.parametrize("rule", ["hebb", "error_hebb", "quadratic"])
def test_weights_stay_finite_and_the_voltage_within_its_limits_whatever_is_measured(rule):
    speeds = np.random.default_rng(2).choice([-1e6, 0.0, 3.0, 1e6, 1e200, math.nan, math.inf], 2000)
    result = voltages(controller_named(rule, MOTOR, 0.001), speeds)
    assert np.all((result >= 0.0) & (result <= 20.0))


def test_a_neuron_s_integral_gain_does_not_depend_on_the_tick():
    """The same constant error for the same time gives the same rise of the voltage."""
    rises = []
    for period_s, ticks in ((0.001, 100), (0.01, 10)):
        neuron = Neuron(0.0, 0.01, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0)
        controller, memory, voltage = Controller(1.0, period_s, neuron=neuron), NeuronMemory(), 0.0
        for _ in range(ticks):
            memory, voltage = single_neuron(memory, voltage, 1.0, controller, TABLES.gain)
        rises.append(voltage)
    assert rises[0] == pytest.approx(rises[1])


def test_no_speed_is_asked_for_no_voltage_is_commanded_and_all_is_forgotten():
    controller = controller_named("pid", MOTOR, 0.001)
    memory = POWER_ON
    for reference in (3.0, 3.0, 0.0):
        memory, command = control(memory, Measured(0.0, 0.0, 0.0), reference, controller, TABLES)
    assert command == (0.0, 0.0)
    assert memory == POWER_ON


@pytest.mark.parametrize("name", ["pid", "hebb_fuzzy"])
def test_without_a_measurement_the_voltage_stays(name):
    result = voltages(controller_named(name, MOTOR, 0.001), np.array([1.0, 2.0, 2.5, math.nan, math.nan]))
    assert result[2] == result[3] == result[4] > 0.0


def test_the_chart_goes_up_above_18_v_for_long_enough_and_down_below_12_for_a_turn():
    """At 2 pi rad/s a turn takes a second: 999 ticks below the threshold and one above begin it anew."""
    controller = Controller(0.0, 0.001, stages=Stages(18.0, 12.0, 0.2, 0.75))
    stage, factors = Stage(), []
    for voltage in [19.0] * 150 + [17.0] + [19.0] * 250 + [13.0] * 500 + [11.0] * 990 + [13.0] + [11.0] * 1010:
        stage, factor = choose_stage(stage, voltage, 2.0 * math.pi, controller)
        factors.append(factor)
    changes = [(index, factor) for index, factor in enumerate(factors) if factor != 1.0]
    assert [index for index, _ in changes] == pytest.approx([350, 2891], abs=1)
    assert [factor for _, factor in changes] == pytest.approx([0.75, 1.0 / 0.75])
    assert stage.fast == 0.0


def test_the_integral_changes_with_the_brush_so_that_the_voltage_goes_on_from_there():
    controller = with_stages(Controller(0.0, 0.001, pid=Pid(0.0, 10.0)), MOTOR)
    result = voltages(controller, np.full(3000, 2.0))
    change = int(np.argmin(np.diff(result)))
    assert result[change] > 18.0
    assert result[change + 1] == pytest.approx(result[change] * 3.412 / 4.579, abs=0.02)
    assert np.all(np.diff(result[change + 1 : change + 100]) >= 0.0)
    assert PidMemory().integral_v == 0.0


def test_simc_gains_follow_its_published_rule():
    """Poles by numpy's eigenvalues of (3.30), (3.31); then Skogestad's rule by hand."""
    a = armature(MOTOR, False)
    inertia = a.inertia_kg_m2 + 2.5e-5
    matrix = [[-a.resistance_ohm / a.inductance_henry, -a.constant_v_s / a.inductance_henry],
              [a.constant_v_s / inertia, -a.damping_n_m_s / inertia]]  # fmt: skip
    short, long = sorted(-1.0 / np.linalg.eigvals(matrix).real)
    gain = a.constant_v_s / (a.resistance_ohm * a.damping_n_m_s + a.constant_v_s**2) / 63.0
    dead, lag = short / 2.0 + 0.001, long + short / 2.0
    gains = internal_model_pid(a, 0.001)
    assert gains.proportional == pytest.approx(lag / (2.0 * dead * gain), rel=1e-9)
    assert gains.integral == pytest.approx(gains.proportional / min(lag, 8.0 * dead), rel=1e-9)


def test_every_controller_of_the_catalogue_can_be_made_and_a_wrong_name_lists_them():
    names = list(catalogue(MOTOR, 0.001))
    assert len({controller_named(name, MOTOR, 0.001) for name in names}) == len(names) >= 9
    with pytest.raises(Failure, match="there is no controller 'pdi'; there are pid, pid_imc, hebb"):
        controller_named("pdi", MOTOR, 0.001)


def test_a_reference_is_one_speed_or_speeds_over_time():
    assert parse_reference("3.5")(99.0) == 3.5
    staged = parse_reference("0:3.14, 10:3.77,15:0")
    assert [staged(time) for time in (0.0, 9.99, 10.0, 20.0)] == [3.14, 3.14, 3.77, 0.0]
    for text, complaint in (
        ("quick", "'quick' is not a speed in rad/s from 0 to 20"),
        ("0:3,5", "entry '5': write SECONDS:RAD_S"),
        ("3:1,2:2", "entry '2:2': time must be later than 3 s"),
        ("-1:2", "'-1' is not a time in s"),
        ("0:nan", "'nan' is not a speed"),
    ):
        with pytest.raises(Failure, match=complaint):
            parse_reference(text)
