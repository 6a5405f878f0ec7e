"""Optional libraries: their table is that of pyproject.toml, base commands do without, others say what to install."""

import itertools
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from hilplant.cli.main import main
from hilplant.extras import EXTRAS

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
OPTIONAL = sorted({library for extra in EXTRAS.values() for library in extra.libraries})
#: What the extras bring along; nothing of it may creep into the base.
BROUGHT_ALONG = ["pandas", "PIL", "dask", "mpl_toolkits"]


def names(requirements: list[str]) -> set[str]:
    return {re.split(r"[>=<\[;]", requirement)[0] for requirement in requirements}


def bare(*arguments: object, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command where no optional library can be imported."""
    code = f"import sys; sys.modules.update(dict.fromkeys({OPTIONAL + BROUGHT_ALONG}))\n"
    code += "from hilplant.cli.main import main; main()"
    words = [sys.executable, "-c", code, *map(str, arguments)]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)


def test_the_table_of_extras_is_that_of_the_package() -> None:
    declared = PROJECT["optional-dependencies"]
    assert {extra: set(contents.libraries) for extra, contents in EXTRAS.items()} == {
        extra: names(requirements) for extra, requirements in declared.items() if extra not in ("all", "test")
    }
    (everything,) = declared["all"]
    assert set(re.findall(r"\w+", everything)) == {"hilplant", *EXTRAS}
    assert not set(OPTIONAL) & names(PROJECT["dependencies"])


def test_each_library_has_one_lower_bound() -> None:
    bounds: dict[str, set[str]] = {}
    for requirement in itertools.chain(PROJECT["dependencies"], *PROJECT["optional-dependencies"].values()):
        bounds.setdefault(requirement.partition(">=")[0], set()).add(requirement)
    assert {name: found for name, found in bounds.items() if len(found) > 1} == {}


@pytest.mark.parametrize(
    "arguments",
    [
        ("--help",),
        ("check",),
        ("simulate", "slow_fast_park", "--out", "wipe.csv"),
        ("run", "virtual", "--seconds", "0.1"),
        ("ecu", "virtual", "--seconds", "0.1", "--stalk", "0:slow"),
        ("control", "virtual", "--seconds", "0.1"),
        ("study", "wiping"),
    ],
    ids=lambda words: words[0],
)
def test_the_base_commands_do_without(arguments: tuple[str, ...], tmp_path: Path) -> None:
    ran = bare(*arguments, folder=tmp_path)
    assert ran.returncode == 0, ran.stderr


@pytest.mark.parametrize(
    ("arguments", "extra"),
    [
        (("demo",), "demo"),
        (("run", "virtual", "--record", "a.hilrec"), "recording"),
        (("replay", "a.hilrec"), "recording"),
        (("export", "a.hilrec", "a.csv"), "recording"),
        (("simulate", "slow_fast_park", "--out", "a.parquet"), "recording"),
        (("simulate", "slow_fast_park", "--out", "a.mf4"), "mdf"),
        (("plot", "positions", "default", "a.png"), "plot"),
        (("plot", "park", "a.png"), "plot"),
        (("inspect", "a.csv"), "identify"),
        (("identify", "a.csv@dry", "--out", "a.yaml"), "identify"),
        (("validate", "a.csv@dry"), "identify"),
        (("motor", "a.yaml", "--out", "b.yaml"), "identify"),
        (("train", "tables"), "train"),
        (("train", "motor"), "train"),
        (("study", "surrogates"), "train"),
        (("study", "identification"), "identify"),
        (("study", "twin"), "identify"),
        (("study", "control", "--out", "."), "plot"),
    ],
    ids=lambda words: "-".join(words[:2]) if isinstance(words, tuple) else None,
)
def test_a_command_says_in_one_line_which_extra_it_misses(
    arguments: tuple[str, ...],
    extra: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["hilplant", *arguments])
    for library in OPTIONAL:
        monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert re.fullmatch(rf"[^\n]+ need [\w, ]+: pip install 'hilplant\[{extra}\]'\n", said), said
    assert list(tmp_path.iterdir()) == []


def test_doctor_lists_the_extras(tmp_path: Path) -> None:
    shown = bare("doctor", folder=tmp_path).stdout
    assert all(f"extra {extra}" in shown and f"hilplant[{extra}]" in shown for extra in EXTRAS)
