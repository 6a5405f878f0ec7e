"""What a trained file was trained for, as a hash of the numbers that stand in a bench's files.

It is made of what is written there, not of what is computed from it: so it is the same on every machine. A value that
is the default counts as not written.
"""

import hashlib
import json
from collections.abc import Iterable
from typing import Any

from hilplant.bench.parts import LinkageFile, MotorFile
from hilplant.bench.plant_description import BladeEntry
from hilplant.bench.screen_parts import ScreenFile
from hilplant.checked_yaml.checked import Checked

#: Keys that say something about the numbers, or limit them, and change nothing in the physics.
_NOT_PHYSICS = frozenset(
    ("name", "source", "status", "comment", "assumed", "least_transmission_deg", "least_clearance_m")
)


def load_hash(linkage: LinkageFile, screen: ScreenFile, blades: Iterable[BladeEntry], points: int) -> str:
    """Return the hash of what the torque at the crank in still air depends on."""
    pressed = [[blade.force_n, blade.wear] for blade in blades]
    return _hash({"linkage": _numbers(linkage), "screen": _numbers(screen), "blades": pressed, "points": points})


def linkage_hash(linkage: LinkageFile) -> str:
    """Return the hash of what the torque of a linkage without arms and blades depends on."""
    numbers = _numbers(linkage)
    return _hash({key: value for key, value in numbers.items() if not key.startswith(("left_", "right_"))})


def motor_hash(motor: MotorFile) -> str:
    """Return the hash of a motor's parameters."""
    return _hash(_numbers(motor))


def _numbers(part: Checked) -> dict[str, Any]:
    kept: dict[str, Any] = _without_words(part.model_dump(exclude_defaults=True))
    return kept


def _without_words(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_words(inner) for key, inner in value.items() if key not in _NOT_PHYSICS}
    return value


def _hash(content: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()
