"""Commands that came by the channel are in the recording, so that it replays."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from support.channel_rig import Run
from support.loop_rig import STEP_NS

from hilplant.models.records import PARAMETER_INDEX
from hilplant.recording.reader import read_recording
from hilplant.recording.recorder import description_now
from hilplant.recording.replay import replay
from hilplant.recording.rotation import Rotation
from hilplant.recording.writer import RecordingWriter, late_description
from hilplant.runtime import commands as c
from hilplant.runtime.row import ROW_WIDTH
from hilplant.signals import INPUT_INDEX, OUTPUTS

RELAY_ON, SUPPLY_V, SCREEN = (INPUT_INDEX[name] for name in ("relay_on", "supply_v", "screen"))


@pytest.fixture
def run() -> Iterator[Run]:
    run = Run()
    yield run
    run.close()


def record(run: Run, path: Path, metadata: dict[str, str], rotation: Rotation | None = None) -> RecordingWriter:
    return RecordingWriter(path, metadata, ROW_WIDTH, rotation)


def disturb(run: Run) -> None:
    """Change parameters and inputs in the midst of 90 ticks."""
    elements = [PARAMETER_INDEX[name] for name in ("motor.damping_n_m_s", "motor.coulomb_torque_n_m")]
    run.tick(30, command_every=20)
    run.post(c.PARAMETER, elements[0], 3e-5)
    run.post(c.OVERRIDE, SUPPLY_V, 9.0)
    run.tick(30, command_every=20)
    run.post(c.PARAMETER, elements[1], 0.01)
    run.post(c.MARK, text=b"in the midst")
    run.tick(30, command_every=20)


def record_disturbed(run: Run, folder: Path) -> Path:
    run.ring.read_rows()
    writer = record(run, path := folder / "run.hilrec", description_now(run.bench))
    disturb(run)
    writer.take(run.ring)
    writer.write(last=True)
    writer.close()
    return path


def test_a_recorded_run_with_commands_replays_bit_for_bit_and_keeps_them(run: Run, tmp_path: Path) -> None:
    path = record_disturbed(run, tmp_path)
    assert str(replay(path)) == f"equal: all {len(OUTPUTS)} outputs of 90 ticks, bit for bit"
    table = read_recording(path).table(["tick", "events"]).to_pylist()
    told = {row["tick"]: [(e["kind"], e["name"], e["value"], e["owner"]) for e in row["events"]] for row in table}
    assert told[30] == [("parameter", "motor.damping_n_m_s", 3e-5, "hand"), ("override", "supply_v", 9.0, "hand")]
    assert [event["text"] for event in table[60]["events"]] == ["", "in the midst"]
    assert sum(map(len, told.values())) == 4


def test_a_replay_that_ignores_the_commands_would_differ(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = record_disturbed(run, tmp_path)
    monkeypatch.setattr("hilplant.recording.replay.parameter_changes", lambda rows: [])
    assert not replay(path).equal


def test_a_recording_begun_late_knows_the_parameters_of_its_first_tick(run: Run, tmp_path: Path) -> None:
    metadata = description_now(run.bench)
    run.tick(5, command_every=20)
    run.post(c.PARAMETER, PARAMETER_INDEX["motor.damping_n_m_s"], 9e-5)
    run.tick(20, command_every=20)
    run.ring.skip_history()
    run.tick(1)
    writer = record(run, path := tmp_path / "late.hilrec", late_description(metadata, run.ring))
    disturb(run)
    writer.take(run.ring)
    writer.write(last=True)
    writer.close()
    assert str(replay(path)).startswith(f"equal: all {len(OUTPUTS)} outputs of 91 ticks")


def test_each_part_replays_alone(run: Run, tmp_path: Path) -> None:
    run.ring.read_rows()
    path = tmp_path / "parts.hilrec"
    writer = record(run, path, description_now(run.bench), Rotation(part_ns=25 * STEP_NS))
    disturb(run)
    writer.take(run.ring)
    writer.write(last=True)
    writer.close()
    parts = sorted(tmp_path.iterdir())
    assert len(parts) == 4
    assert all(replay(part).equal for part in parts)
    assert replay(path).ticks == 90
