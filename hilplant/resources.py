"""Where the shipped files are: inside the package once installed, beside it in a checkout."""

from functools import cache
from pathlib import Path


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
    for folder in (beside, *shared_folders()):
        path = folder / Path(reference).expanduser()
        if path.is_file():
            return path
    return None


def named(kind: str, name: str | Path) -> Path:
    """Return the file that a user names: a path, or a shipped one of its `kind` by its name.

    A path that exists comes first, then ``config/<kind>/<name>`` with or without its ending. A name that
    is not found is returned as it is, for the reader to say so.
    """
    given = Path(name)
    if given.is_file():
        return given
    for candidate in (shipped("config", kind, f"{name}.yaml"), shipped("config", kind, str(name))):
        if candidate.is_file():
            return candidate
    return given
