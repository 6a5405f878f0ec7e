"""The service's lock file pins and hashes every library that the service needs, none below its lower bound."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LOCK = (ROOT / "docker" / "requirements.txt").read_text(encoding="utf-8")
EXTRAS = ("recording", "mdf")


def entries() -> list[tuple[Requirement, list[str]]]:
    """Return each pinned library with its hashes."""
    text = re.sub(r"^#.*\n", "", LOCK, flags=re.MULTILINE).replace("\\\n", " ")
    split = [line.split("--hash=") for line in text.splitlines() if line.strip()]
    return [(Requirement(head.strip()), [entry.strip() for entry in hashes]) for head, *hashes in split]


def test_every_library_is_pinned_to_one_version_with_hashes() -> None:
    for requirement, hashes in entries():
        assert re.fullmatch(r"==[^,*]+", str(requirement.specifier)), requirement
        assert hashes and all(re.fullmatch(r"sha256:[0-9a-f]{64}", entry) for entry in hashes), requirement


def test_what_the_service_needs_is_in_it_and_within_the_bounds() -> None:
    locked: dict[str, list[str]] = {}
    for requirement, _ in entries():
        version = str(requirement.specifier).removeprefix("==")
        locked.setdefault(canonicalize_name(requirement.name), []).append(version)
    wanted = [*PROJECT["dependencies"], *(line for extra in EXTRAS for line in PROJECT["optional-dependencies"][extra])]
    for need in map(Requirement, wanted):
        assert locked[canonicalize_name(need.name)], need
        assert all(need.specifier.contains(version) for version in locked[canonicalize_name(need.name)]), need
    assert "matplotlib" not in locked


def test_the_installer_and_the_image_use_it() -> None:
    installer = (ROOT / "docker" / "install.sh").read_text(encoding="utf-8")
    assert "--require-hashes" in installer and "requirements.txt" in installer and "--no-deps" in installer
    assert "docker/requirements.txt" in (ROOT / "docker" / "Dockerfile").read_text(encoding="utf-8")
