"""A run, its door and its clients as the processes that they are: on the real clock, killed and fed with nonsense."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from support.channel_process import going_on, wait_until

import hilplant
from hilplant.channel.run_files import run_folder, run_named
from hilplant.failure import Failure
from hilplant.recording.reader import read_recording
from hilplant.recording.replay import replay
from hilplant.runtime.follower import Follower

CHANNEL = f"channel-test-{os.getpid()}"
CLIENT = f"""
import sys, hilplant
channel = hilplant.connect("{CHANNEL}")
print(channel.override("supply_v", 9.0), flush=True)
sys.stdin.read()
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Iterator[subprocess.Popen[bytes]]:
    """Start a run, recorded, and end it."""
    path = tmp_path_factory.mktemp("run") / "run.hilrec"
    with going_on(CHANNEL, "--record", str(path)) as process:
        process.recording = path  # type: ignore[attr-defined]
        yield process


def supply_of(channel: "hilplant.RunChannel") -> tuple[float, float]:
    row = channel.latest()
    return row["in.supply_v"], row["owner.supply_v"]


def test_a_command_is_there_from_the_tick_on_that_its_answer_tells(run: object) -> None:
    with hilplant.connect(CHANNEL) as channel:
        threading.Event().wait(0.05)
        tick = channel.set("supply_v", 10.5)
        rows, lost = channel.rows(["tick", "in.supply_v"])
        assert lost == 0
        assert rows[rows[:, 0] == tick, 1].tolist() == [10.5]
        assert rows[rows[:, 0] == tick - 1, 1].tolist() == [13.5]


def test_a_killed_client_changes_nothing_but_lets_go_of_what_it_held(run: object) -> None:
    with hilplant.connect(CHANNEL) as earlier:
        earlier.set("supply_v", 10.5)
    client = subprocess.Popen([sys.executable, "-c", CLIENT], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert client.stdout is not None
    tick = int(client.stdout.readline())
    pause = threading.Event()
    pause.wait(2.0)  # longer than the lease: its signs of life hold it
    with hilplant.connect(CHANNEL) as onlooker:
        assert supply_of(onlooker) == (9.0, 2.0)
        killed = onlooker.latest()["tick"]
        os.kill(client.pid, signal.SIGKILL)
        client.communicate()
        wait_until(lambda: supply_of(onlooker)[0] != 9.0)
        assert supply_of(onlooker)[0] == 10.5  # as it was set before
        assert tick < killed < onlooker.latest()["tick"] <= killed + 2500


FAULTS_CLIENT = CLIENT.replace('override("supply_v", 9.0)', 'fault("resistance_53", resistance_ohm=0.5)')


def test_faults_of_a_killed_client_go_and_all_are_seen_while_they_are_there(run: object) -> None:
    client = subprocess.Popen([sys.executable, "-c", FAULTS_CLIENT], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    assert client.stdout is not None
    tick = int(client.stdout.readline())
    threading.Event().wait(2.0)  # longer than the lease: its signs of life hold it
    with hilplant.connect(CHANNEL) as onlooker:
        (there,) = onlooker.status()["faults"]
        assert (there["name"], there["owner"], there["tick"]) == ("resistance_53", "hand", tick)
        with pytest.raises(Failure, match="resistance_53: held by another client"):
            onlooker.clear("resistance_53")
        os.kill(client.pid, signal.SIGKILL)
        client.communicate()
        wait_until(lambda: not onlooker.latest()["status.faults_active"])
        wait_until(lambda: onlooker.status()["faults"] == [])


def test_a_fault_is_inserted_replaced_and_cleared_each_in_the_tick_that_is_told(run: object) -> None:
    with hilplant.connect(CHANNEL) as channel:
        before, _ = channel.rows(["tick", "faults_active"])
        inserted = channel.fault("frames_lost", message="ParkSwitch", share=0.5)
        again = channel.fault("frames_lost", message="ParkSwitch", share=1.0)
        cleared = channel.clear("frames_lost")
        wait_until(lambda: channel.latest()["tick"] > cleared)
        rows, lost = channel.rows(["tick", "faults_active"])
        assert lost == 0
        active = {int(tick): int(count) for tick, count in [*before, *rows]}
        assert [active[tick] for tick in (inserted - 1, inserted, again, cleared - 1, cleared)] == [0, 1, 1, 1, 0]
        with pytest.raises(Failure, match="neither hears nor sends a message 'ParkSwich', did you mean 'ParkSwitch'"):
            channel.fault("frames_lost", message="ParkSwich")


def test_a_fault_from_a_shell_lasts_as_long_as_it_says(run: object) -> None:
    command = [sys.executable, "-m", "hilplant", "fault", "--run", CHANNEL]
    with hilplant.connect(CHANNEL) as channel:
        channel.rows(["tick"])
        done = subprocess.run(
            [*command, "resistance_53", "resistance_ohm=0.5", "--for", "0.3"],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        rows, lost = channel.rows(["tick", "faults_active", "fault_shown"])
    assert lost == 0
    ticks = rows[rows[:, 1] > 0.0]
    assert done.stdout == f"resistance_53: tick {ticks[0, 0]:.0f}\n"
    assert len(ticks) <= 300  # of 300 ms, less what came late
    wrong = subprocess.run([*command, "open_54"], capture_output=True, text=True, check=False)
    assert (wrong.returncode, wrong.stderr) == (2, "there is no fault 'open_54', did you mean 'open_53'?\n")


def test_nonsense_is_counted_and_harms_nobody(run: object) -> None:
    described = run_named(CHANNEL)
    with hilplant.connect(CHANNEL) as channel:
        before = channel.status()
        nonsense = [b"\xff\xfe\n", b"{}\n", b"[1]\n", b'{"do": 3}\n', b"[" * 5000 + b"\n", b'{"do": "fly"}\n']
        nonsense += [
            b'{"do": "set", "values": {"supply_v": "much"}}\n',
            b'{"do": "set", "values": {"supply_v": NaN}}\n',
        ]
        with socket.socket(socket.AF_UNIX) as raw:
            raw.connect(described.socket)
            lines = raw.makefile("rb")
            for line in nonsense:
                raw.sendall(line)
                assert json.loads(lines.readline())["ok"] is False
            raw.sendall(b"x" * 200_000)
            assert json.loads(lines.readline())["error"] == "a line has at most 65536 bytes"
        after = channel.status()
        assert after["malformed"] - before["malformed"] == 6
        assert after["refused"] - before["refused"] == 3
        assert after["tick"] > before["tick"]


def test_socket_and_folder_are_their_users_alone(run: object) -> None:
    assert os.stat(run_named(CHANNEL).socket).st_mode & 0o777 == 0o600
    assert run_folder().stat().st_mode & 0o777 == 0o700


def test_rows_can_be_subscribed_to_thinned(run: object) -> None:
    with socket.socket(socket.AF_UNIX) as raw:
        raw.connect(run_named(CHANNEL).socket)
        lines = raw.makefile("rb")
        raw.sendall(b'{"id": "a", "do": "subscribe", "signals": ["supply_v", "owner.supply_v"], "every": 10}\n')
        assert json.loads(lines.readline()) == {
            "id": "a",
            "ok": True,
            "columns": ["tick", "supply_v", "owner.supply_v"],
        }
        rows = [row for _ in range(3) for row in json.loads(lines.readline())["rows"]]
    assert {row[0] % 10 for row in rows} == {0.0}
    assert [later[0] - row[0] for row, later in pairwise(rows)] == [10.0] * (len(rows) - 1)


def test_from_a_shell_a_line_is_enough(run: object) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "hilplant", "set", "supply_v=11.5", "mark=from a shell", "--run", CHANNEL],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("mark: tick ")
    wrong = [sys.executable, "-m", "hilplant", "set", "suply_v=11.5", "--run", CHANNEL]
    refused = subprocess.run(wrong, capture_output=True, text=True, check=False)
    assert (refused.returncode, refused.stderr) == (2, "the plant has no input 'suply_v', did you mean 'supply_v'?\n")


def test_the_door_can_die_and_the_run_goes_on_and_its_recording_replays(run: subprocess.Popen[bytes]) -> None:
    described = run_named(CHANNEL)
    with hilplant.connect(CHANNEL) as channel:
        channel.parameter("motor.damping_n_m_s", 3e-5)
        channel.override("supply_v", 8.0)
        for door in doors(run.pid):
            os.kill(door, signal.SIGKILL)
        with pytest.raises(Failure):
            channel.set("supply_v", 9.0)
    follower = Follower(described.ring)
    wait_until(lambda: follower.latest()[4] == 11.5)  # relays, then the supply: released after its lease
    run.terminate()
    assert run.wait(60) == 0
    assert follower.ended
    follower.close()
    assert not described.path.exists()
    path: Path = run.recording  # type: ignore[attr-defined]
    found = replay(path)
    assert found.equal, str(found)
    kinds = {e["kind"] for row in read_recording(path).table(["events"]).to_pylist() for e in row["events"]}
    assert {"set", "override", "release", "parameter", "mark", "fault", "comes", "goes", "clear"} <= kinds


def test_a_recording_begins_and_ends_while_the_run_goes_on(tmp_path: Path) -> None:
    name = f"{CHANNEL}-late"
    with going_on(name) as process, hilplant.connect(name) as channel:
        channel.parameter("motor.damping_n_m_s", 9e-5)
        begun = channel.record(tmp_path / "late.hilrec")
        with pytest.raises(Failure, match="the run is recorded already"):
            channel.record(tmp_path / "other.hilrec")
        changed = channel.parameter("motor.damping_n_m_s", 3e-5)
        channel.stop_recording()
        after = channel.set("supply_v", 9.0)
        again = channel.record(tmp_path / "again.hilrec")
        process.terminate()  # whoever is recorded when the run ends is recorded to its end
        assert process.wait(60) == 0
    for path, ticks in ((tmp_path / "late.hilrec", (begun, changed)), (tmp_path / "again.hilrec", (again,))):
        found = replay(path)
        assert found.equal, str(found)
        seen = read_recording(path).table(["tick"]).column("tick").to_pylist()
        assert set(ticks) <= set(seen)
        assert seen[0] > 0
    assert after < seen[0]


def test_without_a_channel_a_run_can_be_seen_but_not_entered() -> None:
    name = f"{CHANNEL}-closed"
    with going_on(name, "--no-channel"):
        with pytest.raises(Failure, match="was started with --no-channel"):
            hilplant.connect(name)
        assert run_named(name).socket == ""
    with pytest.raises(Failure, match=f"there is no run '{name}'"):
        hilplant.connect(name)


def doors(pid: int) -> list[int]:
    """Return the processes of this run that hold its door."""
    children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    return [int(each) for each in children if b"hilplant.channel.door" in Path(f"/proc/{each}/cmdline").read_bytes()]
