"""Files that a command writes and nobody should edit: a first line says what it is, a last one proves it whole.

Such a file is YAML. Its first line is `format: hilplant KIND VERSION`, its last `content_hash:` with the SHA-256 of all
lines above. A file that was cut off, changed or meant for something else is refused for one reason, before its
content is looked at. Nothing in it is ever executed.
"""

import hashlib
from pathlib import Path

_LAST = "content_hash: "


def seal(text: str) -> str:
    """Return the text with the line behind it that proves it whole."""
    return f"{text}{_LAST}{_hash(text)}\n"


def flaw(text: str, wanted: str) -> str:
    """Return what is wrong with a sealed text that should begin with `format: wanted`, or nothing."""
    lines = text.splitlines()
    first = lines[0] if lines else ""
    if first != f"format: {wanted}":
        found = "its first line is another" if first else "it is empty"
        return f"is not a file of '{wanted}': {found}"
    if not lines[-1].startswith(_LAST):
        return "is cut off: its last line is not content_hash; train it again"
    body = text[: text.rindex(_LAST)]
    if lines[-1] != f"{_LAST}{_hash(body)}":
        return f"was edited or damaged: its content has the hash {_hash(body)[:16]}..., its last line says " + (
            f"{lines[-1].removeprefix(_LAST)[:16]}...; train it again"
        )
    return ""


def flaw_of(path: Path, wanted: str) -> str:
    """Return what is wrong with a sealed file that should begin with `format: wanted`, or nothing."""
    try:
        return flaw(path.read_text(encoding="utf-8"), wanted)
    except UnicodeDecodeError:
        return f"is not a file of '{wanted}': it is not text"
    except OSError as error:
        return f"cannot be read: {(error.strerror or str(error)).lower()}"


def _hash(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
