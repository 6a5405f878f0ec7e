"""The daemon on real SocketCAN with a recording of what it did; each test ends it by a signal."""

import signal
import subprocess
from pathlib import Path
from typing import Any

from support.can_utils import FAST, HILPLANT, OFF, PATIENCE_S, SLOW, Commander, last, wait_until


def test_a_command_changes_the_status_within_two_ticks_and_sigterm_ends_cleanly(
    candump: Any, server: Any, commander: Commander, tmp_path: Path
) -> None:
    for frame, terminal in ((SLOW, 13.5), (OFF, 0.0), (FAST, 13.5), (OFF, 0.0), (SLOW, 13.5)):
        commander.hold(frame)
        assert wait_until(lambda wanted=terminal: last(candump, "MotorStatus")["TerminalVoltage"] == wanted)
    assert_ends_cleanly(candump, server, signal.SIGTERM)
    delays = delays_in_ticks(tmp_path / "run.hilrec")
    print(f"ticks from a relay command to its MotorStatus: {delays}")
    assert len(delays) >= 5
    assert max(delays) <= 2


def delays_in_ticks(recording: Path) -> list[int]:
    """Return, for each commanded change of the terminal voltage, the ticks until a MotorStatus shows it."""
    import pyarrow as pa

    voltages = {"0100": 6750, "0300": 6750, "0000": 0}  # 0.002 V a bit
    shown, wanted = 0, 0
    since: int | None = None
    delays: list[int] = []
    for row in pa.ipc.open_stream(str(recording)).read_all().to_pylist():
        for frame in row["frames"]:
            if frame["identifier"] == 0x120 and not frame["sent"]:
                wanted = voltages[frame["data"].hex()]
                since = int(row["tick"]) if since is None and wanted != shown else since
            if frame["identifier"] == 0x200 and frame["sent"]:
                shown = int.from_bytes(frame["data"][6:8], "little")
                if since is not None and shown == wanted:
                    delays.append(int(row["tick"]) - since)
                    since = None
    return delays


def assert_ends_cleanly(candump: Any, server: Any, number: int) -> None:
    assert server.end(number, PATIENCE_S) == 0
    assert str(last(candump, "PlantStatus")["Mode"]) == "Stopped"
    assert "recorded to" in server.output


def test_a_run_with_random_frames_ends_by_sigint_and_replays_bit_for_bit(
    candump: Any, server: Any, vcan: str, tmp_path: Path
) -> None:
    subprocess.run(["cangen", vcan, "-I", "120", "-L", "2", "-D", "r", "-n", "300", "-g", "5"], check=True)
    subprocess.run(["cangen", vcan, "-I", "121", "-L", "2", "-D", "r", "-n", "100", "-g", "5"], check=True)
    assert_ends_cleanly(candump, server, signal.SIGINT)
    words = [*HILPLANT, "replay", str(tmp_path / "run.hilrec")]
    replay = subprocess.run(words, capture_output=True, text=True, check=False)
    assert replay.returncode == 0, replay.stdout + replay.stderr
    assert "bit for bit" in replay.stdout
