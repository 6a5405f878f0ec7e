"""The README holds: its table of frames is the database's, its example bench has no mistake, its commands exist."""

import re
import shutil
from pathlib import Path

import cantools
from typer.main import get_command

from hilplant.bench import check_bench, load_bench
from hilplant.cli.main import app

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def frames_table() -> str:
    """Write the table of frames from the shipped database."""
    lines = ["| frame | from | every | carries |", "|---|---|---|---|"]
    for message in sorted(cantools.database.load_file(ROOT / "dbc" / "wiper.dbc").messages, key=lambda m: m.frame_id):
        event = ", on change" if str(message.send_type) == "CyclicAndEvent" else ""
        signals = ", ".join(f"{s.name} [{s.unit}]" if s.unit else s.name for s in message.signals)
        name = f"`{message.frame_id:03X}` {message.name}"
        lines.append(f"| {name} | {message.senders[0]} | {message.cycle_time} ms{event} | {signals} |")
    return "\n".join(lines)


def test_the_table_of_frames_is_that_of_the_database() -> None:
    assert frames_table() in README, frames_table()


def test_the_example_of_an_own_database_is_a_sound_bench(tmp_path: Path) -> None:
    (example,) = re.findall(r"```yaml\n(.*?)```", README, re.DOTALL)
    bench = tmp_path / "my_car.yaml"
    bench.write_text(example)
    shutil.copy(ROOT / "tests" / "data" / "readme" / "my_car.dbc", tmp_path)
    assert check_bench(bench) == []
    (received,) = load_bench(bench).receive
    assert received.decode(bytes([0b0001_0000, 0b0001_0000, 0, 0])) == (1.0, 1.0)


def test_every_command_of_the_table_exists_and_shows_an_example() -> None:
    commands = get_command(app).commands  # type: ignore[attr-defined]
    table = re.findall(r"^\| `(\w+)", README.split("## Commands")[1].split("Each answers")[0], re.MULTILINE)
    assert set(table) == set(commands)
    assert all("Example: hilplant" in command.epilog for command in commands.values())
