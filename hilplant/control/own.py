"""A user's own controller in Python: how it is called, and what happens when it takes too long or goes wrong.

A maker, `maker(motor, period_s)`, returns what decides: `decide(reference_rad_s, measured)`, which returns a voltage
[V] and whether the fast brush is asked for. It is called once in each period with the reference as it is then. Its time
is watched. One that takes too long, raises, or answers with no number is stopped for good, and says why.
"""

import math
import signal
import threading
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

from hilplant.arrays import Floats
from hilplant.control.closed_loop import Commanded, measure
from hilplant.control.records import Command, Measured
from hilplant.control.reference import OWN, Reference, wanted_speed
from hilplant.control.seat import ASIDE_NS
from hilplant.failure import Failure
from hilplant.jit import compiled
from hilplant.models.records import Motor, Parameters, State
from hilplant.models.row import pack, unpack
from hilplant.signals import INPUT_INDEX, WANTED
from hilplant.units import MICROSECOND_NS, SECOND_NS

#: Decides: wanted crank speed [rad/s] and what is measured -> supply voltage [V], and whether by the fast brush.
Decide = Callable[[float, Measured], tuple[float, bool]]
#: Makes one anew for a motor and a period [s].
Maker = Callable[[Motor, float], Decide]

#: Voltages that a controller may ask for [V]; others are limited to these.
LOWEST_V, HIGHEST_V = 0.0, 20.0
OFF = Command(0.0, 0.0)
#: Time [s] after which a call that is not back is looked at: one that sleeps, or is over its budget, is broken off.
#: One that only has no processor goes on.
LONGEST_CALL_S = 0.05
_REHEARSALS = 20


class Watch(NamedTuple):
    """The budget [ns] of a call in processor time, its clock and that clock's step [ns]; a count of waits (sleeps)."""

    budget_ns: int
    cpu_ns: Callable[[], int]
    waits: Callable[[], int]
    step_ns: int = 0

    def over(self, spent_ns: int) -> bool:
        """Say whether a call that showed this time was over the budget for certain: it may have taken a step less."""
        return spent_ns - self.step_ns > self.budget_ns


class _NeverCameBackError(Exception):
    """The alarm: a call hangs."""


class OwnSeat:
    """A user's controller, watched. `stopped` says why it was stopped, and is empty while it is sound."""

    def __init__(self, maker: Maker, motor: Motor, period_s: float, reference: Reference, watch: Watch) -> None:
        """Make it once to rehearse, so that no tick meets cold code, and once more to begin."""
        self.reference = reference
        self.stopped = ""
        self._make: Callable[[], Decide] = partial(maker, motor, period_s)
        self._watch, self._fresh = watch, True
        self._began = 0, 0
        self._rehearse()
        self._decide = self._make()
        self._alarmed = threading.current_thread() is threading.main_thread() and hasattr(signal, "setitimer")
        if self._alarmed:
            signal.signal(signal.SIGALRM, self._look)

    def _rehearse(self) -> None:
        rehearsed = self._make()
        for _ in range(_REHEARSALS):
            try:
                self._checked(rehearsed(1.0, Measured(0.0, 0.0, 0.0)))
            except Exception as error:  # whatever a user's code may raise
                self._stop(f"{type(error).__name__}: {error}")
            if self.stopped:
                raise Failure(f"{self.stopped}, at the first rehearsal with reference 1 rad/s and all measured 0")

    def decide(self, now_s: float, measured: Measured, heard_rad_s: float = OWN) -> Command:
        """Take one tick: no voltage without a reference, nor once it is stopped.

        A wanted speed that was heard goes before the reference.
        """
        wanted = wanted_speed(self.reference, now_s, heard_rad_s)
        if self.stopped or not wanted > 0.0:
            self.forget()
            return OFF
        self._fresh = False
        answer = self._called(self._decide, wanted, measured)
        return OFF if answer is None else self._checked(answer)

    def forget(self) -> None:
        """Begin anew at the next tick, as after power-on."""
        if not self._fresh and not self.stopped:
            self._fresh = True
            made = self._called(self._make)
            self._decide = made or self._decide

    def _called(self, function: Callable[..., Any], *arguments: Any) -> Any:
        """Call, with an eye on the time; None, and a reason in `stopped`, when that went wrong."""
        self._began = began_ns, _ = self._watch.cpu_ns(), self._watch.waits()
        try:
            if self._alarmed:
                signal.setitimer(signal.ITIMER_REAL, LONGEST_CALL_S, LONGEST_CALL_S)
            try:
                answer = function(*arguments)
            finally:
                if self._alarmed:
                    signal.setitimer(signal.ITIMER_REAL, 0.0)
        except _NeverCameBackError:
            return self._stop(f"it did not come back within {LONGEST_CALL_S * 1e3:g} ms")
        except Exception as error:  # whatever a user's code may raise
            return self._stop(f"{type(error).__name__}: {error}")
        spent_ns = self._watch.cpu_ns() - began_ns
        if self._watch.over(spent_ns):
            spent_us, budget_us = spent_ns / MICROSECOND_NS, self._watch.budget_ns / MICROSECOND_NS
            return self._stop(f"it took {spent_us:.0f} us of processor time, more than its budget of {budget_us:g} us")
        return answer

    def _look(self, _signal: int, _frame: Any) -> None:
        """Break a call off that has been gone for long, unless others have taken its processor all the time."""
        began_ns, waits = self._began
        if self._watch.over(self._watch.cpu_ns() - began_ns) or self._watch.waits() > waits:
            raise _NeverCameBackError

    def _checked(self, answer: Any) -> Command:
        try:
            voltage, fast = answer
            voltage = float(voltage)
        except (TypeError, ValueError):
            voltage, fast = math.nan, False
        if not math.isfinite(voltage):
            self._stop(f"its answer must be a voltage and whether by the fast brush, not {answer!r:.60}")
            return OFF
        return Command(min(max(voltage, LOWEST_V), HIGHEST_V), float(bool(fast)))

    def _stop(self, reason: str) -> None:
        self.stopped = f"the controller was stopped: {reason}"


class OwnLoopSeat(OwnSeat):
    """The same inside the plant's loop: it sees the state of each tick, and writes relays and supply for it."""

    def __init__(  # noqa: PLR0913, PLR0917
        self, maker: Maker, motor: Motor, period_s: float, reference: Reference, watch: Watch, parameter_row: Floats
    ) -> None:
        """Sit down beside a plant with these packed parameters."""
        super().__init__(maker, motor, period_s, reference, watch)
        self._asked_ns = 0
        _seen(pack(State()), parameter_row)

    def drive(self, now_ns: int, state_row: Floats, input_row: Floats, parameter_row: Floats) -> bool:
        """Take one tick on the loop's own rows; say whether the controller is still sound."""
        if now_ns - self._asked_ns > ASIDE_NS:
            self.forget()
        self._asked_ns = now_ns
        heard_rad_s = float(input_row[WANTED])
        command = self.decide(now_ns / SECOND_NS, _seen(state_row, parameter_row), heard_rad_s)
        written = Commanded(float(command.voltage_v > 0.0), command.fast, command.voltage_v)
        for name, value in zip(Commanded._fields, written, strict=True):
            input_row[INPUT_INDEX[name]] = value
        return not self.stopped


@compiled
def _seen(state_row: Any, parameter_row: Any) -> Measured:
    return measure(unpack(State, state_row), unpack(Parameters, parameter_row))
