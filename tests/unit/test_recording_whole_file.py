"""A file is written whole or not at all, through links, and what is no file is not replaced by one."""

import os
from pathlib import Path

import pytest

from hilplant.atomic_write import whole_file, write_text
from hilplant.failure import Failure


def test_a_failure_leaves_what_was_there_and_nothing_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("before")
    with pytest.raises(KeyboardInterrupt), whole_file(path) as passing:
        passing.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "before"
    assert os.listdir(tmp_path) == ["a.csv"]


def test_a_link_goes_on_pointing_where_it_did(tmp_path: Path) -> None:
    real, link = tmp_path / "real.yaml", tmp_path / "link.yaml"
    real.write_text("before")
    link.symlink_to(real)
    write_text(link, "after")
    assert link.is_symlink()
    assert real.read_text() == "after"


def test_a_pipe_is_written_and_not_replaced(tmp_path: Path) -> None:
    path = tmp_path / "pipe"
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_text(path, "through")
        assert os.read(reader, 100) == b"through"
    finally:
        os.close(reader)
    assert path.is_fifo()


def test_a_folder_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(Failure, match=r"x\.yaml: cannot be written"):
        write_text(tmp_path / "no" / "x.yaml", "")


def test_files_of_the_name_that_is_likely_for_a_half_file_are_left_alone(tmp_path: Path) -> None:
    """A user's `o.part.csv`, or a link of that name, has nothing to do with the writing of `o.csv`."""
    target = tmp_path / "precious"
    target.write_text("precious")
    (tmp_path / "o.part.csv").symlink_to(target)
    (tmp_path / "p.part.csv").write_text("mine")
    for name in ("o.csv", "p.csv"):
        with whole_file(tmp_path / name) as passing:
            passing.write_text("written")
    assert target.read_text() == "precious"
    assert (tmp_path / "p.part.csv").read_text() == "mine"
    assert (tmp_path / "o.csv").read_text() == (tmp_path / "p.csv").read_text() == "written"
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "o.csv",
        "o.part.csv",
        "p.csv",
        "p.part.csv",
        "precious",
    ]


def test_the_rights_are_those_of_any_new_file_or_of_the_one_that_is_replaced(tmp_path: Path) -> None:
    plain, kept = tmp_path / "plain.txt", tmp_path / "kept.txt"
    plain.write_text("")
    kept.write_text("")
    kept.chmod(0o640)
    with whole_file(tmp_path / "new.txt") as passing:
        passing.write_text("x")
    with whole_file(kept) as passing:
        passing.write_text("x")
    assert (tmp_path / "new.txt").stat().st_mode == plain.stat().st_mode
    assert kept.stat().st_mode & 0o777 == 0o640
