"""The ring between the real-time loop and the processes beside it: rows, frames, events out, commands in.

Nothing in it waits. The writer fills a slot in place, then moves the head; the recorder copies, then moves the
tail; neither writes what the other writes. A ring that is full for the recorder loses the new row or frame and counts
it. Without a recorder the oldest are overwritten instead: a run that nobody records counts nothing as lost. Any number
of followers (:mod:`hilplant.runtime.follower`) read beside it, each with a place of its own that the writer does not
know. Events are overwritten always; commands go the other way, see :mod:`hilplant.runtime.mailbox`.

What it relies on: an aligned 8-byte store is one store, and the stores of one thread become visible in order.
x86-64 guarantees both. ARM64 guarantees the first only; there, data and head lie hundreds of instructions of
the interpreter apart, more than a store buffer holds: sound in practice, not by the letter.
"""

import numpy as np
from numpy.typing import NDArray

from hilplant.arrays import Floats, Records
from hilplant.bus.frame import Frame
from hilplant.runtime.commands import COMMAND_DTYPE
from hilplant.runtime.frame_slot import FRAME, FRAME_BYTES, FRAME_DTYPE
from hilplant.runtime.lane import Lane
from hilplant.runtime.mailbox import Mailbox
from hilplant.runtime.shared_memory import SharedMemory

_MAGIC = 0x336E6972_6C6968  # "hilrin3"
_HEADER_BYTES = 512
_LATEST_US = 2**31 - 1
_EVENTS, _COMMANDS = 8192, 512
# Places in the header, in 8-byte words. What never changes, what the writer writes and what the reader writes
# lie on cache lines of their own.
_MAGIC_AT, _WIDTH, _ROWS, _FRAMES = range(4)
_ROW_HEAD, _FRAME_HEAD, _LOST, _CLOSED = range(8, 12)
_ROW_TAIL, _FRAME_TAIL, _READER, _FAILED = range(16, 20)
_EVENT_HEAD, _COMMAND_HEAD, _COMMAND_TAIL = 24, 32, 40


class Ring:
    """Rows of floats and CAN frames on their way from the loop to the recorder.

    The frames of a tick are written before its row is committed; a reader that takes the rows first and the
    frames then has all frames of these rows.
    """

    def __init__(self, shared: SharedMemory) -> None:
        """Find the ring in `shared`; use :meth:`create` or :meth:`attach`."""
        words = memoryview(shared.bytes)[:_HEADER_BYTES].cast("q")
        if words[_MAGIC_AT] != _MAGIC:
            shared.close()
            raise ValueError(f"{shared.name} is not a ring of this version of hilplant")
        self._shared, self._memory, self._words = shared, shared.bytes, words
        self._row_count, self._frame_count = words[_ROWS], words[_FRAMES]
        shape = (self._row_count, words[_WIDTH])
        self._rows: Floats = np.ndarray(shape, np.float64, shared.bytes, _HEADER_BYTES)
        self._frames_at = _HEADER_BYTES + self._rows.nbytes
        self._frames = np.ndarray((self._frame_count,), FRAME_DTYPE, shared.bytes, self._frames_at)
        events_at = self._frames_at + self._frames.nbytes
        events = np.ndarray((_EVENTS,), COMMAND_DTYPE, shared.bytes, events_at)
        commands = np.ndarray((_COMMANDS,), COMMAND_DTYPE, shared.bytes, events_at + events.nbytes)
        #: What became of commands; and all rows and frames, for followers.
        self.events, self.row_lane = Lane(words, _EVENT_HEAD, events), Lane(words, _ROW_HEAD, self._rows)
        self.frame_lane = Lane(words, _FRAME_HEAD, self._frames)
        #: Commands into the loop.
        self.mailbox = Mailbox(words, _COMMAND_TAIL, Lane(words, _COMMAND_HEAD, commands))
        late_at = events_at + events.nbytes + commands.nbytes
        self._late: NDArray[np.int32] = np.ndarray((self._row_count,), np.int32, shared.bytes, late_at)
        self._scratch: Floats = np.zeros(words[_WIDTH])
        self._full = False
        self._row_head, self._frame_head, self._lost = words[_ROW_HEAD], words[_FRAME_HEAD], words[_LOST]

    @classmethod
    def create(cls, row_width: int, rows: int = 65536, frames: int = 131072) -> "Ring":
        """Make a ring for rows of `row_width` floats, a minute of them; its maker is the writer.

        Raises
        ------
        Failure
            When the shared memory does not hold it.
        """
        beside = (_EVENTS + _COMMANDS) * COMMAND_DTYPE.itemsize + 4 * rows
        shared = SharedMemory.create(_HEADER_BYTES + rows * row_width * 8 + frames * FRAME_BYTES + beside)
        np.ndarray((len(shared.bytes),), np.uint8, shared.bytes)[:] = 0  # touch every page now
        words = memoryview(shared.bytes)[:_HEADER_BYTES].cast("q")
        for index, value in ((_WIDTH, row_width), (_ROWS, rows), (_FRAMES, frames), (_MAGIC_AT, _MAGIC)):
            words[index] = value
        return cls(shared)

    @classmethod
    def attach(cls, name: str) -> "Ring":
        """Open the ring `name` of another process, to read; FileNotFoundError when it is gone."""
        return cls(SharedMemory.attach(name))

    @property
    def name(self) -> str:
        """What :meth:`attach` asks for."""
        return self._shared.name

    @property
    def row_width(self) -> int:
        """Floats in a row."""
        return self._words[_WIDTH]

    @property
    def lost(self) -> int:
        """Rows and frames that found the ring full."""
        return self._words[_LOST]

    @property
    def rows_written(self) -> int:
        """How many rows there have been."""
        return self._words[_ROW_HEAD]

    @property
    def recording(self) -> int:
        """What becomes of the rows, as an index of ``signals.RECORDING``: none, all or not all of them are kept."""
        words = self._words
        if self._lost or words[_FAILED]:
            return 2
        return 1 if words[_READER] else 0

    @property
    def writer_closed(self) -> bool:
        """The writer has written its last row."""
        return self._words[_CLOSED] != 0

    # The writer's side

    def note_late(self, late_us: int) -> None:
        """Tell how late [us] the tick begins whose row is written next."""
        self._late[self._row_head % self._row_count] = min(late_us, _LATEST_US)

    def next_row(self) -> Floats:
        """Return the slot to fill in place; a scratch row that leads nowhere while the ring is full."""
        head, words = self._row_head, self._words
        self._full = head - words[_ROW_TAIL] >= self._row_count and words[_READER] != 0
        row: Floats = self._scratch if self._full else self._rows[head % self._row_count]
        return row

    def commit(self) -> None:
        """Publish the row that :meth:`next_row` gave, or count it as lost."""
        if self._full:
            self._count_lost()
            return
        self._row_head += 1
        self._words[_ROW_HEAD] = self._row_head

    def write_frame(self, tick: int, time_ns: int, frame: Frame, sent: bool) -> None:
        """Publish one frame that was received, or `sent`, in `tick` at `time_ns`; or count it as lost."""
        words, head = self._words, self._frame_head
        if head - words[_FRAME_TAIL] >= self._frame_count and words[_READER]:
            self._count_lost()
            return
        identifier, data, extended, fd, bitrate_switch, remote, error = frame
        flags = sent | extended << 1 | fd << 2 | bitrate_switch << 3 | remote << 4 | error << 5
        at = self._frames_at + head % self._frame_count * FRAME_BYTES
        FRAME.pack_into(self._memory, at, tick, time_ns, identifier, flags, len(data), 0, data)
        self._frame_head = head + 1
        words[_FRAME_HEAD] = head + 1

    def _count_lost(self) -> None:
        self._lost += 1
        self._words[_LOST] = self._lost

    def forget_reader(self) -> None:
        """Overwrite the oldest again instead of waiting for a reader that has died; `recording` tells it at once."""
        self._words[_FAILED] = 1
        self._words[_READER] = 0

    def close_writer(self) -> None:
        """Say that no more rows will come. The ring stays readable."""
        self._words[_CLOSED] = 1

    # The reader's side

    def read_rows(self) -> Floats:
        """Take the rows written since the last call; from the first on the ring keeps what is not read."""
        self._begin()
        head, tail = self._words[_ROW_HEAD], self._words[_ROW_TAIL]
        taken: Floats = self._rows[np.arange(tail, head) % self._row_count]
        self._words[_ROW_TAIL] = head
        return taken

    def read_frames(self) -> Records:
        """Take the frames written since the last call, as an array of ``FRAME_DTYPE``."""
        self._begin()
        head, tail = self._words[_FRAME_HEAD], self._words[_FRAME_TAIL]
        taken: Records = self._frames[np.arange(tail, head) % self._frame_count]
        self._words[_FRAME_TAIL] = head
        return taken

    def skip_history(self) -> None:
        """Begin to read, as the recorder, with what is written from now on."""
        words = self._words
        words[_ROW_TAIL], words[_FRAME_TAIL] = words[_ROW_HEAD], words[_FRAME_HEAD]
        words[_READER] = 1

    def next_unread(self) -> Floats:
        """Copy the row that :meth:`read_rows` will give first; it must be there."""
        row: Floats = self._rows[self._words[_ROW_TAIL] % self._row_count].copy()
        return row

    @property
    def unread(self) -> int:
        """How many rows the recorder has not taken."""
        return self._words[_ROW_HEAD] - self._words[_ROW_TAIL]

    def leave(self) -> None:
        """Record no longer: nothing waits for this reader any more."""
        self._words[_READER] = 0

    def fail(self) -> None:
        """Say, as the reader, that what it takes is no longer kept; `recording` tells it from now on."""
        self._words[_FAILED] = 1

    def _begin(self) -> None:
        """On the first call, skip what the writer has overwritten, or is just overwriting; hold the rest."""
        words = self._words
        if words[_READER]:
            return
        for head, tail, count in (
            (_ROW_HEAD, _ROW_TAIL, self._row_count),
            (_FRAME_HEAD, _FRAME_TAIL, self._frame_count),
        ):
            if words[head] - words[tail] >= count:
                words[tail] = words[head] - count + count // 8 + 1
        words[_READER] = 1

    def latest(self) -> Floats:
        """Copy the newest row without taking it, as any number of processes may; zeros before the first."""
        while True:
            head = self._words[_ROW_HEAD]
            row: Floats = self._rows[(head - 1) % self._row_count].copy()
            if self._words[_ROW_HEAD] - head < self._row_count - 1:
                return row

    def late_us(self, ticks: int) -> NDArray[np.int32]:
        """Copy how late [us] the last ticks began, up to so many, the newest last."""
        head = self._words[_ROW_HEAD]
        found: NDArray[np.int32] = self._late[
            np.arange(max(0, head - min(ticks, self._row_count)), head) % self._row_count
        ]
        return found

    def close(self) -> None:
        """Let go of the ring; the last one to do so removes it. Rows that were read stay valid."""
        self._shared.close()
