"""The plant as a test sees it: send messages, let time pass, wait for signals, say what must hold all the while."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hilplant.bench import Bench
from hilplant.bench.values import input_index, signal_value
from hilplant.checked_yaml.problems import suggestion
from hilplant.failure import Failure
from hilplant.faults.timing import Course
from hilplant.faults.written import entry_named
from hilplant.signals import INPUTS
from hilplant.testing.evidence import column_of
from hilplant.testing.known_signals import database_signals, protections_of
from hilplant.testing.sending import CyclicMessage
from hilplant.testing.virtual_bench import VirtualBench
from hilplant.testing.words import line_of
from hilplant.units import SECOND_NS
from hilplant.verdicts.arrays import judge
from hilplant.verdicts.binding import Placed, bind
from hilplant.verdicts.conditions import level_of
from hilplant.verdicts.expectations import Expectation
from hilplant.verdicts.known import Known
from hilplant.verdicts.limits import Limits
from hilplant.verdicts.ticks import margin
from hilplant.verdicts.written import DEFAULT_WAIT_S, kind_of

if TYPE_CHECKING:
    from hilplant.testing.clocked_bench import ClockedBench
    from hilplant.testing.virtual_can import VirtualCanBus

_DEGREES = "_deg"


class WiperUnderTest:
    """A bench in front of a test that is the ECU: in virtual time, or on the clock where it is given so.

    Times are seconds of the plant, counted from its first tick. A signal is one of the plant or of the bench's
    database; an angle `..._rad` of the plant is also there as `..._deg`, from -180 to 180.
    """

    def __init__(self, bench: Bench, stand_in: bool = False, clocked: "ClockedBench | None" = None) -> None:
        """With `stand_in` the stand-in ECU joins; on the clock it has done so already."""
        self.virtual: VirtualBench | ClockedBench = clocked or VirtualBench(bench, stand_in=stand_in)
        self.database = database_signals(bench.sources, protections_of(bench))
        self._end = self.virtual.bus.end()
        self._bus: VirtualCanBus | None = None
        self._cyclic: dict[str, CyclicMessage] = {}
        self._latest: dict[tuple[int, bool], bytes] = {}
        self._read = 0
        self._known: Known = self.database.known(bench.step_ns / SECOND_NS, math.inf, {})
        self.expect = Expecting(self)

    @property
    def time_s(self) -> float:
        """Plant seconds since the first tick."""
        return self.virtual.now_ns / SECOND_NS

    @property
    def bus(self) -> "VirtualCanBus":
        """A python-can bus at the same wire; its waiting is the plant's time."""
        if self._bus is None:
            from hilplant.testing.virtual_can import VirtualCanBus

            self._bus = VirtualCanBus(self.virtual.bus.end(), self._one_tick, lambda: self.virtual.now_ns)
        return self._bus

    @property
    def has_bus(self) -> bool:
        """Whether the test has asked for the python-can bus."""
        return self._bus is not None

    def send(self, message: str, /, **signals: Any) -> None:
        """Send a message of the database now, and again at its cycle time; what is not named keeps its value."""
        if message not in self.database.messages:
            raise Failure(f"the database has no message '{message}'{suggestion(message, self.database.messages)}")
        cyclic = self._cyclic.get(message)
        if cyclic is None:
            protection = self.database.protections.get(message)
            cyclic = self._cyclic[message] = CyclicMessage(self.database.messages[message], protection)
        cyclic.change(signals)
        self._end.send(cyclic.frame())
        cyclic.due_ns = self.virtual.now_ns + cyclic.period_ns

    def stop(self, message: str) -> None:
        """Send a message no more."""
        self._cyclic.pop(message, None)

    def set(self, **inputs: Any) -> None:
        """Set inputs of the plant that no message carries, such as ``brake_torque_n_m=500.0`` or ``screen="wet"``."""
        for name, value in inputs.items():
            try:
                index = input_index(name)
                self.virtual.set(index, signal_value(INPUTS[index], value))
            except ValueError as error:
                raise Failure(str(error)) from error

    @contextmanager
    def fault(self, fault: str, /, **keys: Any) -> Iterator[None]:
        """Let a fault be there from the next tick on, inside a `with`; `hilplant faults` lists them.

        Quantities are named, ``fault("resistance_53", resistance_ohm=0.5)``; all other keys are those of a scenario's
        `faults`, with `for_` for how long. `at` counts from now.
        """
        course = self.insert_fault(fault, **keys)
        try:
            yield
        finally:
            self.virtual.end_fault(course)

    def insert_fault(self, fault: str, /, **keys: Any) -> Course:
        """Insert a fault that stays for as long as it says; keys as for `fault`."""
        return self.virtual.insert_fault(entry_named(fault, keys))

    def step(self, most: int = 1) -> int:
        """Let one tick pass, or several that are quiet, `most` at the most; returns how many."""
        now_ns, step_ns = self.virtual.now_ns, self.virtual.bench.step_ns
        for cyclic in self._cyclic.values():
            if cyclic.period_ns and now_ns >= cyclic.due_ns:
                self._end.send(cyclic.frame())
                cyclic.due_ns += cyclic.period_ns
        if self._bus is not None:
            self._bus.send_due(now_ns)
            most = 1
        due_ns = [each.due_ns for each in self._cyclic.values() if each.period_ns]
        most = min([most, *(max(1, -((now_ns - due) // step_ns)) for due in due_ns)])
        taken = self.virtual.step(most)
        self._end.coming.clear()
        return taken

    def _one_tick(self) -> None:
        self.step()

    def run(self, seconds: float) -> None:
        """Let plant seconds pass."""
        ticks = round(seconds * SECOND_NS / self.virtual.bench.step_ns)
        while ticks > 0:
            ticks -= self.step(ticks)

    def wait(self, signal: str, equals: Any = None, *, within: float = DEFAULT_WAIT_S, **limits: Any) -> float:
        """Let time pass until a signal has a value, or obeys `below`, `above`, `between`; return how long it took [s].

        Raises
        ------
        AssertionError
            When it has not come `within` that time.

        """
        given = {key: value for key, value in {"equals": equals, **limits}.items() if value is not None}
        level = level_of(self._name(signal), Limits.model_validate(given), self._known)
        begin_s = self.time_s
        while True:
            value = self[signal]
            if margin((level,), {level.signal: value}, None) >= 0.0:
                return self.time_s - begin_s
            if self.time_s - begin_s >= within - 1e-9:
                wanted = ", ".join(f"{key} {value}" for key, value in given.items())
                raise AssertionError(
                    f"{signal} {wanted}: not within {within:g} s; it is {value:g} at {self.time_s:.3f} s"
                )
            self.step()

    def __getitem__(self, name: str) -> float:
        """Return a signal as it is now; nan before its first frame or the first tick."""
        plant = self._name(name)
        column = column_of(plant)
        if column is None:
            return self._from_frames(plant)
        rows = self.virtual.tape.read_rows()
        value = float(rows[-1, column]) if len(rows) else math.nan
        return _degrees(value) if plant != name else value

    def judge(self) -> list[str]:
        """Return a line for each expectation that does not hold."""
        expectations = self.expect.bound
        if not expectations:
            return []
        trace = self.virtual.evidence().trace(expectations, self.database, self.virtual.ticks)
        from hilplant.testing.scenario_test import Judged

        found = [Judged(each, judge(each, trace)) for each in expectations]
        return [line_of(each, trace.step_s) for each in found if each.judgement.ruling != "pass"]

    def record(self, path: Path) -> None:
        """Write all ticks and frames so far as a recording."""
        self.virtual.record(path)

    def bind(self, written: dict[str, Any], place: tuple[str, int]) -> Expectation:
        """Return an expectation that is written as in a scenario; without `after` it counts from now on."""
        entry = {"after": self.time_s} | written
        placed = Placed(kind_of(written).model_validate(entry), *place)
        return bind([placed], self._known)[0]

    def _name(self, name: str) -> str:
        """Return the signal's own name; `..._deg` stands for `..._rad`."""
        radians = name.removesuffix(_DEGREES) + "_rad"
        found = radians if name.endswith(_DEGREES) and column_of(radians) is not None else name
        if found not in self._known.signals:
            raise Failure(f"no signal '{name}'{suggestion(name, self._known.signals)}")
        return found

    def _from_frames(self, name: str) -> float:
        frames = self.virtual.tape.frames
        for _, _, frame, _ in frames[self._read :]:
            self._latest[frame.identifier, frame.extended] = frame.data
        self._read = len(frames)
        message, signal = self.database.signals[name]
        data = self._latest.get((message.frame_id, message.is_extended_frame))
        if data is None:
            return math.nan
        value = message.decode(data, decode_choices=False).get(signal.name)
        return math.nan if value is None else float(value)


class Expecting:
    """What must hold while a test runs: the keys of a scenario's `expect`, as methods; judged when the test ends."""

    def __init__(self, wiper: WiperUnderTest) -> None:
        self._wiper = wiper
        self.bound: list[Expectation] = []

    def __getattr__(self, kind: str) -> Callable[..., None]:
        """Return the method of a kind: ``always("current_a", below=25)``, ``within(3.0, signal=..., equals=1)``."""
        if kind.startswith("_"):
            raise AttributeError(kind)
        kind_of({kind: None})

        def add(subject: Any, /, **keys: Any) -> None:
            written = {kind: subject} | {key.rstrip("_"): value for key, value in keys.items()}
            self.bound.append(self._wiper.bind(written, _caller()))

        return add


def _caller() -> tuple[str, int]:
    """Return file and line of the test that is two calls away."""
    import inspect

    frame = inspect.stack()[2]
    return frame.filename, frame.lineno


def _degrees(radians: float) -> float:
    """Return an angle in degrees from -180 to 180."""
    return math.degrees(math.remainder(radians, 2.0 * math.pi))
