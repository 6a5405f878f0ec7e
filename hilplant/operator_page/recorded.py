"""A recording on the operator's screen: the same widgets at a cursor in time, the plots over any stretch."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.channel.run_files import columns
from hilplant.failure import Failure
from hilplant.operator_page.blocks import NEWEST, STRETCH, block
from hilplant.operator_page.envelope import of_points
from hilplant.operator_page.live import MOST_POINTS, MOST_SIGNALS
from hilplant.operator_page.recorded_events import events_of, faults_at
from hilplant.operator_page.recorded_frames import RecordedFrames
from hilplant.recording.format import SIGNAL_COLUMNS
from hilplant.recording.reader import read_recording
from hilplant.recording.span import Span
from hilplant.units import SECOND_NS
from hilplant.web.access import Access
from hilplant.web.visitor import Visitor

#: Rows that are held in memory: half an hour at a step of 1 ms.
MOST_ROWS = 1_800_000


class RecordedRows:
    """The signals of a recording, [ticks, signals], with the time of each tick [s]."""

    def __init__(self, path: Path, span: Span) -> None:
        """Read a stretch of a recording.

        Raises
        ------
        Failure
            When it cannot be read, holds nothing, or is too long.
        """
        recording = read_recording(path).within(span)
        names = ["tick", "deadline_ns", *SIGNAL_COLUMNS]
        pieces, frames, count = [], [], 0
        #: What became of each command, with its tick, as the recording has it.
        self.commands: list[dict[str, Any]] = []
        for batch in recording.batches():
            piece = np.column_stack([batch.column(name).to_numpy(zero_copy_only=False) for name in names])
            frames.append(batch.column("frames").flatten())
            self.commands += _commands(batch)
            pieces.append(piece[np.isfinite(piece[:, 1].astype(np.float64))].astype(np.float64))
            count += len(pieces[-1])
            if count > MOST_ROWS:
                raise Failure(f"{path}: more than {MOST_ROWS} ticks; give --from and --to")
        if not count:
            raise Failure(f"{path}: holds no tick to show")
        self.rows: Floats = np.vstack(pieces)
        self.frames = pa.concat_arrays(frames)
        self.times_s: Floats = self.rows[:, 1] / SECOND_NS
        self.run = recording.run
        self.notes = list(recording.notes)
        self._places = {name: index for index, name in enumerate(names)}

    def at(self, time_s: float) -> Floats:
        """Return the row of the last tick before a time, in the layout of a live row; what was not recorded is nan."""
        index = max(0, int(np.searchsorted(self.times_s, time_s, side="right")) - 1)
        found = [self.rows[index, self._places[name]] if name in self._places else np.nan for name, _ in columns()]
        return np.array(found)

    def stretch(self, names: list[str], span_s: tuple[float, float], points: int) -> tuple[Floats, Floats]:
        """Return times and values of these signals, thinned to about so many points."""
        if len(names) > MOST_SIGNALS:
            raise ValueError(f"at most {MOST_SIGNALS} signals, not {len(names)}")
        first, last = np.searchsorted(self.times_s, span_s)
        part = self.rows[first:last]
        values = part[:, [self.place(name) for name in names]]
        return of_points(part[:, 0], self.times_s[first:last], values, min(points, MOST_POINTS))

    def events(self) -> list[dict[str, Any]]:
        """Return what happened, in words."""
        names = [name for name in self._places if name.startswith("status.")]
        status = {name.removeprefix("status."): self.rows[:, self._places[name]] for name in names}
        return events_of(self.commands, self.times_s, status)

    def place(self, name: str) -> int:
        """Return the column of a signal."""
        for candidate in (name, f"out.{name}", f"status.{name}", f"in.{name}"):
            if candidate in self._places:
                return self._places[candidate]
        raise ValueError(f"'{name}' is not recorded")


class RecordedScreen:
    """All browsers that look at one recording; nobody drives anything."""

    def __init__(self, path: Path, rows: RecordedRows, bench: Bench, access: Access) -> None:
        """Show a recording; the bench's database names and decodes its frames."""
        self._path, self._rows, self._access = path, rows, access
        self._frames, self._events = RecordedFrames(bench, rows.frames), rows.events()

    async def serve(self, visitor: Visitor) -> None:
        """Serve a browser until it goes."""
        times = self._rows.times_s
        span = {"name": self._path.name, "from_s": float(times[0]), "to_s": float(times[-1])}
        await visitor.tell({"told": "state", "lead": None, "asking": [], "recorded": span, "stalk": False})
        await visitor.tell({"told": "hello", "page": 1, "events": self._events})
        async for message in visitor.messages():
            try:
                await self._answer(visitor, message)
            except (ValueError, TypeError, KeyError, OverflowError) as error:
                self._access.refuse("refused")
                await visitor.tell({"id": message.get("id"), "error": str(error) or type(error).__name__})

    async def _answer(self, visitor: Visitor, message: dict[str, Any]) -> None:
        wanted, number = message.get("do"), message.get("id")
        if wanted == "stretch":
            span = (float(message["from_s"]), float(message["to_s"]))
            points = self._rows.stretch(list(message["signals"]), span, int(message["points"]))
            await visitor.give(block(STRETCH, int(message["id"]), points))
        elif wanted == "at":
            empty = (np.empty(0), np.empty((0, 0)))
            await visitor.give(block(NEWEST, 0, empty, self._rows.at(float(message["time_s"]))))
            await self._tell_moment(visitor, float(message["time_s"]))
        elif wanted not in ("view", "alive"):
            raise ValueError("this is a recording: nothing can be changed")
        if number is not None:
            await visitor.tell({"id": number, "selection": 0})

    async def _tell_moment(self, visitor: Visitor, time_s: float) -> None:
        """Tell the frames, what the ECU had told, and the faults at a time."""
        self._frames.look(time_s)
        await visitor.tell({"told": "faults", "faults": faults_at(self._rows.commands, time_s)})
        await visitor.tell({"told": "frames", "rows": self._frames.rows(time_s), "ecu": self._frames.ecu()})


def _commands(batch: pa.RecordBatch) -> Iterator[dict[str, Any]]:
    ticks, events = batch.column("tick"), batch.column("events")
    for place in np.flatnonzero(pc.list_value_length(events).to_numpy() > 0):
        yield from ({**each, "tick": ticks[place].as_py()} for each in events[place].as_py())


def differs(rows: RecordedRows, bench: Bench) -> str:
    """Say where the bench is not that of the recording; "" where it is."""
    same = np.array_equal(rows.run.parameter_row, bench.parameter_row) and np.array_equal(rows.run.tables, bench.tables)
    return "" if same else f"the bench {bench.name} is not quite the recorded one: its picture may differ"
