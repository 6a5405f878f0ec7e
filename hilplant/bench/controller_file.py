"""A velocity controller as a file: its law, gains, learning rates, limits and brushes; and the controller it makes."""

from typing import Annotated, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from hilplant.bench.parts import Referred, Sourced
from hilplant.bench.speed_network_file import SpeedNetworkFile, motor_record_hash
from hilplant.checked_yaml.checked import Checked, NotNegative, Positive, wrong
from hilplant.control import catalogue
from hilplant.control.controller import Tables
from hilplant.control.records import RULES, Cascade, Controller, Neuron, Pid, Stages
from hilplant.failure import Failure
from hilplant.models.records import Motor

Voltage = Annotated[float, Field(ge=0.0, le=20.0)]


class PidSection(Checked):
    """Gains of (7.1) for an error in rad/s of the crank."""

    proportional: NotNegative = Field(description="of the error [V s/rad]")
    integral: NotNegative = Field(description="of its integral [V/rad]")
    derivative: NotNegative = Field(default=0.0, description="of its derivative [V s2/rad]")
    weight: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        default=1.0, description="part of the reference that the proportional term sees"
    )


class NeuronSection(Checked):
    """A single-neuron PID, (7.4)-(7.10): learning rates and first weights of its three inputs."""

    rule: Literal["hebb", "error_hebb", "quadratic"] = Field(description="learning rule")
    gain: Positive = Field(description="K of (7.6); with fuzzy the factor on what the fuzzy system gives")
    fuzzy: bool = Field(default=False, description="whether the fuzzy system of 7.4 moves K")
    rate_integral: NotNegative = Field(default=1.0, description="learning rate, integral input")
    rate_proportional: NotNegative = Field(default=1.5, description="learning rate, proportional input")
    rate_derivative: NotNegative = Field(default=1.0, description="learning rate, derivative input")
    start_integral: NotNegative | None = Field(default=None, description="first weight; the rule's own if left out")
    start_proportional: NotNegative | None = Field(default=None, description="first weight; the rule's if left out")
    start_derivative: NotNegative | None = Field(default=None, description="first weight; the rule's own if left out")
    error_weight: NotNegative = Field(default=2.0, description="P of (7.10)")
    output_weight: NotNegative = Field(default=1.0, description="Q of (7.10)")
    first_output: NotNegative = Field(default=1.0, description="b0 of (7.10)")

    def record(self) -> Neuron:
        """Return the settings as the controllers take them; a first weight that is left out is the catalogue's."""
        given = self.model_dump(exclude_none=True) | {"rule": RULES.index(self.rule)}
        names = ("start_integral", "start_proportional", "start_derivative")
        first = dict(zip(names, catalogue.INITIAL_WEIGHTS[self.rule], strict=True))
        return Neuron(**{name: float(value) for name, value in (first | given).items()})


class CascadeSection(Checked):
    """Bandwidths [1/s] of the cascade."""

    speed_rate: Positive = Field(description="of the speed towards its reference [1/s]")
    current_rate: Positive = Field(description="of the current towards what the speed asks for [1/s]")


class StagesSection(Checked):
    """The chart of section 7.6."""

    up_v: Positive = Field(default=catalogue.UP_V, description="voltage above which the fast brush is taken")
    up_hold_s: Positive = Field(default=catalogue.UP_HOLD_S, description="how long the voltage must be above it")
    back_v: NotNegative = Field(
        default=catalogue.BACK_V,
        description="voltage of the slow brush without load below which it is taken again, for a turn of the crank",
    )

    @model_validator(mode="after")
    def _hysteresis(self) -> Self:
        if self.back_v >= self.up_v:
            raise wrong("back_v", text=f"back_v must be below up_v, which is {self.up_v:g}, or the brush never rests")
        return self


class ControllerFile(Sourced):
    """One velocity controller; exactly one of `pid`, `neuron` and `cascade` says by which law."""

    model_config = ConfigDict(title="hilplant controller")

    pid: PidSection | None = Field(default=None, description="PID control")
    neuron: NeuronSection | None = Field(default=None, description="single-neuron PID")
    cascade: CascadeSection | None = Field(default=None, description="cascade with load observer")
    speed: Literal["sensor", "observer", "network"] = Field(
        default="sensor", description="where the speed comes from; network: section 7.5"
    )
    network: Annotated[SpeedNetworkFile, Referred(trained=True)] | None = Field(
        default=None, description="file of the speed network, as `train estimator` writes it"
    )
    adapting: Annotated[float, Field(ge=0.0, le=1.0)] = Field(
        default=0.0, description="part of each turn's error by which an observer corrects the resistance"
    )
    lowest_v: Voltage = Field(default=0.0, description="lowest voltage that is commanded")
    highest_v: Voltage = Field(default=20.0, description="highest voltage that is commanded")
    stages: StagesSection | None = Field(default=StagesSection(), description="both brushes; null: the slow one alone")

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        laws = [name for name in ("pid", "neuron", "cascade") if getattr(self, name) is not None]
        if len(laws) != 1:
            text = f"give one of pid, neuron and cascade, not {' and '.join(laws) or 'none'}"
            raise wrong(*laws[1:2], text=text)
        if (self.speed == "network") != (self.network is not None):
            raise wrong("speed", text="speed: network and network: FILE, which `train estimator` writes, go together")
        if self.speed == "network" and self.cascade is not None:
            raise wrong("speed", text="a cascade has its own observer; speed: network is for pid and neuron")
        if self.lowest_v >= self.highest_v:
            raise wrong("lowest_v", text=f"lowest_v must be below highest_v, which is {self.highest_v:g}")
        return self

    def controller(self, motor: Motor, period_s: float) -> Controller:
        """Return the controller for a motor, ticked with a period.

        Raises
        ------
        Failure
            For a cascade without a speed sensor at a period at which it oscillates, and for a speed network of
            another motor.

        """
        made = self._law(motor, period_s)._replace(lowest_v=self.lowest_v, highest_v=self.highest_v)
        if self.network is not None and self.network.parameter_hash != motor_record_hash(motor):
            text = f"its speed network was trained for the motor {self.network.motor}, not for this one; train it again"
            raise Failure(f"controller {self.name}: {text}: hilplant train estimator BENCH")
        if self.speed != "sensor":
            made = catalogue.sensorless(made, motor, self.speed, self.adapting)
        if self.stages is None:
            return made
        ratio = motor.fast.constant_v_s / motor.slow.constant_v_s
        return made._replace(stages=Stages(self.stages.up_v, self.stages.back_v * ratio, self.stages.up_hold_s, ratio))

    def tables(self) -> Tables:
        """Return the arrays that the controller reads."""
        plain = catalogue.without_network()
        return plain if self.network is None else Tables(plain.gain, *self.network.paths())

    def _law(self, motor: Motor, period_s: float) -> Controller:
        if self.pid is not None:
            return catalogue.pid(motor, period_s, Pid(**self.pid.model_dump()))
        if self.neuron is not None:
            plain = catalogue.neuron(motor, period_s, self.neuron.rule, self.neuron.gain)
            return plain._replace(neuron=self.neuron.record())
        assert self.cascade is not None
        return catalogue.cascade(motor, period_s)._replace(cascade=Cascade(**self.cascade.model_dump()))
