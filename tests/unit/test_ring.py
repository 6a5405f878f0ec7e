"""The ring loses nothing that fits, counts what does not, and outlives whoever is killed."""

import errno
import os
import select
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from hilplant.bus.frame import Frame
from hilplant.failure import Failure
from hilplant.runtime.ring import Ring

WIDTH = 5

WRITER = f"""
import sys
import threading
from hilplant.bus.frame import Frame
from hilplant.failure import Failure
from hilplant.runtime.ring import Ring
ring = Ring.create({WIDTH}, rows=64, frames=64)
print(ring.name, flush=True)
sys.stdin.readline()
for tick in range(20_000):
    ring.write_frame(tick, tick, Frame(tick % 2048, bytes([tick % 256])), True)
    ring.next_row()[:] = tick
    ring.commit()
print(ring.lost, flush=True)
sys.stdin.readline()
"""


@pytest.fixture
def ring() -> Iterator[Ring]:
    ring = Ring.create(WIDTH, rows=8, frames=4)
    yield ring
    ring.close()


def write(ring: Ring, ticks: range) -> None:
    for tick in ticks:
        ring.next_row()[:] = tick + np.arange(WIDTH) / 10
        ring.commit()


def test_rows_come_out_as_they_went_in_however_often_the_ring_wraps(ring: Ring) -> None:
    reader = Ring.attach(ring.name)
    taken = [reader.read_rows()]
    for start in range(0, 49, 7):
        write(ring, range(start, start + 7))
        taken.append(reader.read_rows())
    reader.close()
    rows = np.concatenate(taken)
    assert np.array_equal(rows, np.arange(49)[:, np.newaxis] + np.arange(WIDTH) / 10)
    assert ring.lost == 0


def test_a_full_ring_loses_the_newest_rows_and_counts_them(ring: Ring) -> None:
    reader = Ring.attach(ring.name)
    reader.read_rows()
    write(ring, range(11))
    assert ring.lost == reader.lost == 3
    assert reader.read_rows()[:, 0].tolist() == list(range(8))
    write(ring, range(11, 13))
    assert reader.read_rows()[:, 0].tolist() == [11, 12]
    reader.close()


def test_a_row_begun_while_the_ring_was_full_is_lost_even_if_room_appears_before_its_commit(
    ring: Ring,
) -> None:
    reader = Ring.attach(ring.name)
    reader.read_rows()
    write(ring, range(8))
    ring.next_row()[:] = 8
    reader.read_rows()
    ring.commit()
    assert ring.lost == 1
    assert len(reader.read_rows()) == 0
    reader.close()


def test_without_a_reader_the_oldest_rows_make_room_and_none_counts_as_lost(ring: Ring) -> None:
    write(ring, range(100))
    assert ring.lost == 0
    reader = Ring.attach(ring.name)
    taken = reader.read_rows()[:, 0].tolist()
    assert taken == list(range(100 - len(taken), 100))
    assert len(taken) >= 6
    reader.close()


def test_a_reader_that_was_given_up_no_longer_holds_the_writer_back(ring: Ring) -> None:
    reader = Ring.attach(ring.name)
    reader.read_rows()
    ring.forget_reader()
    write(ring, range(30))
    assert ring.lost == 0
    assert ring.latest()[0] == 29
    reader.close()


def test_the_latest_row_can_be_seen_by_many_without_being_taken(ring: Ring) -> None:
    reader, onlooker = Ring.attach(ring.name), Ring.attach(ring.name)
    assert not onlooker.latest().any()
    write(ring, range(3))
    assert onlooker.latest()[0] == reader.latest()[0] == 2
    assert len(reader.read_rows()) == 3
    reader.close()
    onlooker.close()


def test_frames_keep_identifier_payload_and_flags_and_are_counted_when_lost(ring: Ring) -> None:
    reader = Ring.attach(ring.name)
    reader.read_frames()
    frames = [
        Frame(0x7FF, b""),
        Frame(0x1FFFFFFF, bytes(range(64)), extended=True, fd=True, bitrate_switch=True),
        Frame(0x10, b"", remote=True),
        Frame(0x20000004, bytes(8), error=True),
    ]
    for tick, frame in enumerate([*frames, *frames]):
        ring.write_frame(tick, tick * 1000, frame, sent=tick % 2 == 1)
    taken = reader.read_frames()
    assert ring.lost == 4
    assert taken["identifier"].tolist() == [frame.identifier for frame in frames]
    assert [row["data"][: row["length"]].tobytes() for row in taken] == [frame.data for frame in frames]
    assert taken["flags"].tolist() == [0, 0b001111, 0b010000, 0b100001]
    assert taken["time_ns"].tolist() == [0, 1000, 2000, 3000]
    reader.close()


def test_the_end_is_seen_by_the_reader(ring: Ring) -> None:
    reader = Ring.attach(ring.name)
    assert not reader.writer_closed
    ring.close_writer()
    assert reader.writer_closed
    reader.close()


def test_the_last_one_to_close_removes_the_memory() -> None:
    ring = Ring.create(WIDTH)
    reader = Ring.attach(ring.name)
    ring.close()
    again = Ring.attach(reader.name)
    reader.close()
    again.close()
    with pytest.raises(FileNotFoundError):
        Ring.attach(ring.name)


def start_writer() -> tuple[subprocess.Popen[str], str]:
    writer = subprocess.Popen([sys.executable, "-c", WRITER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert writer.stdout is not None
    return writer, writer.stdout.readline().strip()


def tell(writer: subprocess.Popen[str]) -> None:
    assert writer.stdin is not None
    writer.stdin.write("\n")
    writer.stdin.flush()


def test_between_two_processes_every_row_arrives_whole_or_is_counted() -> None:
    writer, name = start_writer()
    reader = Ring.attach(name)
    rows, frames = [reader.read_rows()], [reader.read_frames()]
    tell(writer)
    assert writer.stdout is not None
    while not select.select([writer.stdout], [], [], 0.0)[0]:
        rows.append(reader.read_rows())
        frames.append(reader.read_frames())
    lost = int(writer.stdout.readline())
    rows.append(reader.read_rows())
    frames.append(reader.read_frames())
    writer.communicate()
    taken, seen_frames = np.concatenate(rows), np.concatenate(frames)
    assert (taken == taken[:, :1]).all()
    assert (np.diff(taken[:, 0]) > 0).all()
    assert (seen_frames["data"][:, 0] == seen_frames["tick"] % 256).all()
    assert len(taken) + len(seen_frames) + lost == 40_000
    reader.close()


def test_what_a_killed_writer_left_can_be_drained_and_nothing_of_it_stays_behind() -> None:
    writer, name = start_writer()
    tell(writer)
    assert writer.stdout is not None
    writer.stdout.readline()
    reader = Ring.attach(name)
    os.kill(writer.pid, signal.SIGKILL)
    writer.communicate()
    left = reader.read_rows()[:, 0]
    assert left[-1] == 19_999
    Ring.create(WIDTH).close()
    Ring.attach(name).close()
    reader.close()
    with pytest.raises(FileNotFoundError):
        Ring.attach(name)


def test_the_memory_of_a_writer_that_was_killed_alone_is_removed_by_the_next() -> None:
    writer, name = start_writer()
    os.kill(writer.pid, signal.SIGKILL)
    writer.communicate()
    Ring.create(WIDTH).close()
    with pytest.raises(FileNotFoundError):
        Ring.attach(name)


def test_something_else_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.write_bytes(bytes(1000))
    with pytest.raises(ValueError, match="not a ring"):
        Ring.attach(str(other))


def test_a_loop_that_ticks_is_healthy_and_one_that_stands_is_not(ring: Ring) -> None:
    from hilplant.runtime.health import moves

    assert not moves(ring.name, 0.1)
    ticking = threading.Timer(0.05, lambda: write(ring, range(3)))
    ticking.start()
    assert moves(ring.name, 5.0)
    ticking.join()
    assert not moves("hilplant-ring-nothing", 0.1)


def test_shared_memory_without_room_says_where_and_how_much(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(file: int, offset: int, size: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "posix_fallocate", full)
    with pytest.raises(Failure, match=r"has no room for \d+ MB of shared memory \(No space left on device\)"):
        Ring.create(WIDTH)


def test_how_late_ticks_began_is_told_for_the_last_of_them() -> None:
    with closing(Ring.create(2, rows=8, frames=8)) as ring, closing(Ring.attach(ring.name)) as reader:
        assert reader.late_us(5).tolist() == []
        for tick in range(11):
            ring.note_late(100 * tick if tick < 10 else 2**40)
            ring.next_row()[:] = tick
            ring.commit()
        assert reader.late_us(3).tolist() == [800, 900, 2**31 - 1]
        assert len(reader.late_us(100)) == 8
