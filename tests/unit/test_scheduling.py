"""What the loop asks of Linux is said to be granted only where it is."""

import os
from pathlib import Path

import pytest

from hilplant.runtime import scheduling


def test_sleep_states_are_held_off_while_the_device_is_open(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    device = tmp_path / "cpu_dma_latency"
    device.write_bytes(b"before")
    monkeypatch.setattr(scheduling, "_SLEEP_DEVICE", str(device))
    granted: list[scheduling.Privilege] = []
    with scheduling._shallow_sleep(granted):
        opened = {os.path.realpath(link) for link in Path("/proc/self/fd").iterdir()}
        assert str(device.resolve()) in opened
    assert [privilege.granted for privilege in granted] == [True]
    assert device.read_bytes() == bytes(4) + b"re"


def test_a_device_that_is_not_there_is_not_made(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    device = tmp_path / "cpu_dma_latency"
    monkeypatch.setattr(scheduling, "_SLEEP_DEVICE", str(device))
    granted: list[scheduling.Privilege] = []
    with scheduling._shallow_sleep(granted):
        pass
    assert [(privilege.granted, privilege.fix.split(";")[0]) for privilege in granted] == [
        (False, "No such file or directory")
    ]
    assert not device.exists()
