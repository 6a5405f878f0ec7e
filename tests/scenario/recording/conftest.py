"""A small plant, and ways to get a run of it into a file with and without a recorder process."""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from hilplant.bus.frame import Frame
from hilplant.models import tables as channel
from hilplant.models.plant import tick
from hilplant.models.records import STATE_INDEX, Arm, Brush, Load, Motor, Parameters, ParkSwitch, State
from hilplant.models.row import pack
from hilplant.recording.metadata import describe
from hilplant.recording.rotation import Rotation
from hilplant.recording.writer import RecordingWriter
from hilplant.runtime.ring import Ring
from hilplant.signals import INPUTS, OUTPUTS, STATUS

STATE_AT = 2 + len(INPUTS) + len(OUTPUTS) + len(STATUS)
STEP_NS = 1_000_000
START = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC)
_OUTPUTS_AT = 2 + len(INPUTS)
_STATUS_AT = _OUTPUTS_AT + len(OUTPUTS)

ROW_WIDTH = STATE_AT + len(STATE_INDEX)
MOTOR = Motor(Brush(0.6, 2.0e-3, 0.035), Brush(0.5, 1.5e-3, 0.024), 5.0e-5, 1.0e-5, 0.02, gear_ratio=60.0)
ARM = Arm(0.3, 0.5)


def tables(knots: int = 360) -> NDArray[np.float64]:
    """Two rockers that swing as a cosine of the crank angle; the other channels are of no concern without a load."""
    crank = np.linspace(0.0, 2 * np.pi, knots + 1)
    swing = np.stack([0.8 - 0.7 * np.cos(crank), 0.7 * np.sin(crank)], axis=-1)
    channels = np.zeros((knots + 1, channel.channels(1), 2))
    channels[:, channel.LEFT_ROCKER], channels[:, channel.RIGHT_ROCKER] = swing, 1.1 * swing
    return channels


@dataclass(frozen=True)
class SmallBench:
    """A plant without files."""

    name: str = "small bench"
    step_ns: int = STEP_NS
    pace: float = 1.0
    parameter_row: NDArray[np.float64] = field(
        default_factory=lambda: pack(
            Parameters(1e-3, MOTOR, ParkSwitch(0.0, 0.2, 0.0, 0.0), Load(0.0, 0.0, 0.0), ARM, ARM)
        )
    )
    tables: NDArray[np.float64] = field(default_factory=tables)
    state_row: NDArray[np.float64] = field(default_factory=lambda: pack(State(0.0, 0.0, 0.0, 1.0, 0.0, 0.0)))
    sources: dict[str, str] = field(default_factory=lambda: {"small.yaml": "name: small\n"})


FRAMES = (
    Frame(0x123, b"\x01\x02\x03"),
    Frame(0x1ABCDEF0, bytes(range(8)), extended=True),
    Frame(0x321, bytes(range(48)), fd=True, bitrate_switch=True),
    Frame(0x322, b"", fd=True),
    Frame(0x7FF, b"", remote=True),
    Frame(0x004, bytes([0, 8, 0, 0, 0, 0, 0, 0]), error=True),
    Frame(0x000, b""),
)


@dataclass
class Run:
    """A run in virtual time: random relays and supply, each tick's frames before its row."""

    ring: Ring
    bench: SmallBench = field(default_factory=SmallBench)
    seed: int = 1
    next_tick: int = 0
    lose: frozenset[int] = frozenset()
    late_from: int | None = None  # from this tick on five periods late

    def __post_init__(self) -> None:
        self._random = np.random.default_rng(self.seed)
        self._state = self.bench.state_row.copy()
        self._line = np.zeros(ROW_WIDTH)

    def go(self, ticks: int) -> None:
        """Write `ticks` more rows into the ring, and a frame of every kind in turn."""
        for number in range(self.next_tick, self.next_tick + ticks):
            line = self._line
            late = self.late_from is not None and number >= self.late_from
            due_ns = (number + 5 * late) * STEP_NS
            line[:2] = number, due_ns
            if number % 250 == 0:
                on, fast = self._random.integers(0, 2, 2)
                line[2:5] = on, fast, self._random.uniform(9.0, 15.0)
            inputs, outputs = line[2:_OUTPUTS_AT], line[_OUTPUTS_AT:_STATUS_AT]
            line[STATE_AT:] = self._state
            tick(self._state, inputs, self.bench.parameter_row, self.bench.tables, outputs)
            line[_STATUS_AT] = number
            frame = FRAMES[number % len(FRAMES)]
            self.ring.write_frame(number, due_ns, frame, sent=number % 2 == 1)
            if number not in self.lose:
                self.ring.next_row()[:] = line
                self.ring.commit()
        self.next_tick += ticks


@pytest.fixture
def bench() -> SmallBench:
    return SmallBench()


@pytest.fixture
def row_width() -> int:
    return ROW_WIDTH


@pytest.fixture
def start_run() -> Callable[[Ring], Run]:
    return Run


@pytest.fixture
def frames() -> tuple[Frame, ...]:
    return FRAMES


@pytest.fixture
def record_run(tmp_path: Path) -> Callable[..., Path]:
    """Record a run into a file in this process, in blocks of `block` ticks."""

    def record(ticks: int = 1500, block: int = 400, rotation: Rotation | None = None, **settings: Any) -> Path:
        ring = Ring.create(ROW_WIDTH)
        run = Run(ring, **settings)
        path = tmp_path / f"run-{run.seed}.hilrec"
        path.unlink(missing_ok=True)
        writer = RecordingWriter(path, describe(run.bench, START), ring.row_width, rotation)
        for begin in range(0, ticks, block):
            run.go(min(block, ticks - begin))
            writer.take(ring)
            writer.write(last=begin + block >= ticks)
        writer.close()
        ring.close()
        return path

    return record
