"""README and docs hold: examples run, commands exist, links lead somewhere, the vcan block waits for the plant."""

import re
import shutil
from pathlib import Path

import pytest
from typer.main import get_command

from hilplant.bench import check_bench, load_bench
from hilplant.cli.main import app, main

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


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
    table = re.findall(r"^\| `(\w+)", (ROOT / "docs" / "commands.md").read_text(encoding="utf-8"), re.MULTILINE)
    assert set(table) == set(commands)
    assert all("Example: hilplant" in command.epilog for command in commands.values())


def test_the_readme_is_short_and_the_example_in_python_runs(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert len(README.splitlines()) <= 120
    (example,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len(example.splitlines()) <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "README.md", "exec"), {})
    assert re.match(r"largest current \d+\.\d A\nmoving for \d", capsys.readouterr().out)
    assert (tmp_path / "wipe.csv").stat().st_size > 0


def test_every_option_that_the_readme_uses_is_one_of_its_command() -> None:
    commands = get_command(app).commands  # type: ignore[attr-defined]
    for name, rest in re.findall(r"^hilplant (\w+)([^|#&\n]*)", README, re.MULTILINE):
        options = {option for parameter in commands[name].params for option in parameter.opts}
        assert set(re.findall(r"--[a-z-]+", rest)) <= options, name


def test_the_vcan_block_waits_for_the_plant_before_it_sends() -> None:
    block = next(part for part in re.findall(r"```sh\n(.*?)```", README, re.DOTALL) if "modprobe vcan" in part)
    started, waiting, sending = (block.index(word) for word in ("hilplant run", "candump -n 1", "cangen"))
    assert started < waiting < sending
    identifiers = set(re.findall(r"vcan0,(\w{3}):7FF", block)) | set(re.findall(r"-I (\w{3})", block))
    assert identifiers == {"120", "200", "201", "210"}
    database = (ROOT / "dbc" / "wiper.dbc").read_text(encoding="latin-1")
    assert all(f"BO_ {int(identifier, 16)} " in database for identifier in identifiers)


@pytest.mark.parametrize("page", sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]), ids=lambda page: page.name)
def test_every_link_leads_to_a_file(page: Path) -> None:
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_the_index_names_every_page() -> None:
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    pages = {page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}
    assert pages <= set(re.findall(r"\]\(([\w-]+\.md)\)", index))


def test_every_path_that_contributing_names_exists() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    paths = re.findall(r"`((?:hilplant|tests|docs|docker|config|dbc)/[\w/.-]*)`", text)
    assert paths and [path for path in paths if not (ROOT / path).exists()] == []


def test_version_and_completion_are_offered(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for option, said in (("--version", r"hilplant \d+\.\d+\.\d+\n"), ("--help", r"(?s).*--install-completion.*")):
        monkeypatch.setattr("sys.argv", ["hilplant", option])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 0
        assert re.fullmatch(said, capsys.readouterr().out)
