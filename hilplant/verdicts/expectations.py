"""What can be expected of a run, as plain records; times are in ticks, values in the signal's unit."""

import math
from dataclasses import dataclass, field
from typing import Literal


@dataclass(frozen=True, slots=True)
class Level:
    """A signal lies between two limits, both included; its margin is how far inside it lies, negative outside."""

    signal: str
    lowest: float = -math.inf
    highest: float = math.inf


@dataclass(frozen=True, slots=True)
class Edge:
    """A signal crosses a level: it was not above and now is (`rising`), or was and now is not. Margin 0.5 or -0.5."""

    signal: str
    rising: bool
    level: float = 0.5


#: Parts that must hold together.
Condition = tuple[Level | Edge, ...]
#: Steps to an instant: a number of ticks counts on, a condition waits for the next tick at which it holds.
Steps = tuple[int | Condition, ...]


def is_over(until: Steps, tick: int) -> bool:
    """Whether a window that begins at `tick` is over by then: its end is a time that has passed."""
    return len(until) == 1 and isinstance(until[0], int) and until[0] <= tick


@dataclass(frozen=True, slots=True)
class Window:
    """The ticks that count: from `after` on, before `until`, while `during` holds.

    Where `during` holds with gaps, each stretch is judged by itself.
    """

    after: Steps = ()
    until: Steps = ()
    during: Condition = ()

    @property
    def is_sought(self) -> bool:
        """Whether its begin depends on what is seen, so that a tick that was lost may hide it."""
        return any(not isinstance(step, int) for step in self.after)


@dataclass(frozen=True, slots=True)
class Holds:
    """The condition holds at every tick of the window; with `never` it holds at none."""

    condition: Condition
    never: bool = False


@dataclass(frozen=True, slots=True)
class Comes:
    """The condition holds at some tick, `ticks` after the window's first one at the latest."""

    condition: Condition
    ticks: int


@dataclass(frozen=True, slots=True)
class Settles:
    """Within `by` ticks a stretch begins in which the level holds for `hold` ticks; None: to the window's end."""

    level: Level
    by: int
    hold: int | None = None


@dataclass(frozen=True, slots=True)
class Stays:
    """For `ticks`, or to the window's end, the signal stays within `tolerance` of what it was at its first tick."""

    signal: str
    tolerance: float
    ticks: int | None = None


@dataclass(frozen=True, slots=True)
class Response:
    """Each time that the trigger begins to hold in the window, `then` holds within `ticks` of it."""

    trigger: Condition
    then: Condition
    ticks: int


@dataclass(frozen=True, slots=True)
class Count:
    """How often the condition begins to hold in the window lies between two limits, both included."""

    condition: Condition
    lowest: float = 0.0
    highest: float = math.inf


FrameRule = Literal["period", "jitter", "missing", "counter", "crc"]


@dataclass(frozen=True, slots=True)
class Frames:
    """A rule for the frames of one message.

    `period`: every gap [ms] between `lowest` and `highest`; `jitter`: no gap further than `highest` [ms] from the
    cycle; `missing`: at most `highest` cycles without a frame; `counter`, `crc`: at most `highest` frames are wrong.
    """

    message: str
    rule: FrameRule
    lowest: float = 0.0
    highest: float = 0.0


Rule = Holds | Comes | Settles | Stays | Response | Count | Frames


@dataclass(frozen=True, slots=True)
class Expectation:
    """A rule in a window; `text` is what was written, `place` its file and line, `unit` that of its robustness."""

    rule: Rule
    window: Window = field(default_factory=Window)
    text: str = ""
    place: str = ""
    unit: str = ""

    @property
    def condition(self) -> Condition:
        """What is asked of signals at a tick; for a response what triggers it."""
        rule = self.rule
        if isinstance(rule, Settles):
            return (rule.level,)
        if isinstance(rule, Stays):
            return (Level(rule.signal),)
        if isinstance(rule, Frames):
            return ()
        return rule.trigger if isinstance(rule, Response) else rule.condition

    @property
    def searches(self) -> bool:
        """Whether a tick that was lost may hide a trigger, or where a stretch of the window begins."""
        return isinstance(self.rule, Response) or bool(self.window.during)

    @property
    def signals(self) -> tuple[str, ...]:
        """Every signal that is looked at, the one that is judged first."""
        answer = self.rule.then if isinstance(self.rule, Response) else ()
        steps = [step for step in (*self.window.after, *self.window.until) if not isinstance(step, int)]
        parts = [*self.condition, *answer, *self.window.during, *(part for step in steps for part in step)]
        return tuple(dict.fromkeys(part.signal for part in parts))
