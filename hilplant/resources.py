"""Where the shipped files are: inside the package once installed, beside it in a checkout."""

from contextlib import suppress
from functools import cache
from pathlib import Path

from hilplant.failure import Failure


@cache
def shipped_root() -> Path:
    """Return the folder that holds `config` and `dbc`."""
    package = Path(__file__).resolve().parent
    return package if (package / "config").is_dir() else package.parent


def shipped(*parts: str) -> Path:
    """Return the path of a shipped file or folder, as in ``shipped("config", "motors")``."""
    return shipped_root().joinpath(*parts)


def shared_folders() -> tuple[Path, ...]:
    """Return where files are found that are not beside the one that names them."""
    return shipped("config"), shipped("config", "benches"), shipped_root()


def find(reference: str, beside: Path) -> Path | None:
    """Return the file that a configuration file in the folder `beside` refers to, None when there is none.

    The folder `beside` comes first, then the shared ones.
    """
    with suppress(OSError, RuntimeError):  # a name that is too long for the system; the home of nobody
        for folder in (beside, *shared_folders()):
            path = folder / Path(reference).expanduser()
            if path.is_file():
                return path
    return None


def named(kind: str, name: str | Path) -> Path:
    """Return the file that a user names: a path, or a shipped one of its `kind` by its name.

    A path that exists comes first, then ``config/<kind>/<name>`` with or without its ending. A path that does not
    exist is returned as it is, for the reader to say so.

    Raises
    ------
    Failure
        For a mere name that is none of the shipped ones.

    """
    given = Path(name)
    if given.is_file():
        return given
    for candidate in (shipped("config", kind, f"{name}.yaml"), shipped("config", kind, str(name))):
        if candidate.is_file():
            return candidate
    if given.suffix or len(given.parts) != 1:
        return given
    known = ", ".join(sorted(path.stem for path in shipped("config", kind).glob("*.yaml")))
    raise Failure(f"{name}: no such file, nor one of the shipped {kind}, which are {known}")
