"""What one page works on: the model with its history, recordings, and the long work that was started."""

import threading
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from hilplant.atomic_write import make_folder
from hilplant.failure import Failure
from hilplant.modelling.jobs import Jobs
from hilplant.modelling.linkage_panel import body_table, readings, rules_of
from hilplant.modelling.model_files import ModelFiles
from hilplant.modelling.motor_panel import ratios
from hilplant.modelling.opening import open_model
from hilplant.modelling.view import ModelCheck, checked

#: Changes that can be taken back.
MOST_KEPT = 200


class ModellingSession:
    """The model that the page shows; every change is a new state, and the ones before can be had back."""

    def __init__(self, model: ModelFiles, work: Path) -> None:
        """Begin with a model; `work` is a folder for what the page is given and makes."""
        self.work = work
        self.recordings = make_folder(work / "recordings")
        self.jobs = Jobs()
        self._states, self._at, self._version = [model], 0, 0
        self._lock = threading.RLock()
        self._checked: tuple[ModelFiles, ModelCheck] | None = None

    @property
    def model(self) -> ModelFiles:
        """The model as it is now."""
        return self._states[self._at]

    def check(self) -> ModelCheck:
        """Return the check of the model as it is now."""
        with self._lock:
            if self._checked is None or self._checked[0] is not self.model:
                self._checked = self.model, checked(self.model)
            return self._checked[1]

    def change(self, version: int, how: Callable[[ModelFiles], ModelFiles]) -> None:
        """Change the model.

        Raises
        ------
        Failure
            When the page that asks shows an older version: another one has changed it meanwhile.

        """
        with self._lock:
            if version != self._version:
                raise Failure("the model was changed in another window; load this page again")
            made = how(self.model)
            self._states = [*self._states[: self._at + 1], made][-MOST_KEPT:]
            self._at, self._version = len(self._states) - 1, self._version + 1

    def step(self, by: int) -> None:
        """Take changes back, -1, or make them again, 1."""
        with self._lock:
            self._at = min(max(self._at + by, 0), len(self._states) - 1)
            self._version += 1

    def open(self, version: int, bench: str) -> None:
        """Open another bench."""
        self.change(version, lambda _: open_model(bench))

    def save(self, folder: Path, overwrite: bool) -> None:
        """Save the model in a folder."""
        with self._lock:
            self._states[self._at] = self.model.saved(folder, overwrite)

    def laid_out(self, name: str = "model") -> Path:
        """Write the model for a command to read, and return the path of the bench."""
        return self.model.written_to(make_folder(self.work / name))

    def accept(self, version: int, parts: dict[str, Any]) -> None:
        """Take what identification found into the model, value by value: comments and all else stay."""
        self.change(version, lambda model: with_parts(model, parts))

    def with_network(self, version: int, load: str | None, motor: str | None) -> None:
        """Let trained files, whole paths of them, stand in for load and motor: hybrid and network benches."""

        def taken(model: ModelFiles) -> ModelFiles:
            for key, kind, name, path in (
                ("load", "network", "torque_network.yaml", load),
                ("motor_model", "narx", "motor_network.yaml", motor),
            ):
                if path is not None:
                    model = replace(model, others={**model.others, name: Path(path).read_bytes()})
                    more = {"points": 1} if key == "load" else {}
                    model = model.with_value(("plant", key), {"model": kind, "file": name} | more)
            return model

        self.change(version, taken)

    def shown(self) -> dict[str, Any]:
        """Return all that the page shows of the model."""
        with self._lock:
            found, model = self.check(), self.model
            return {
                "version": self._version,
                "files": dict(model.texts),
                "others": sorted(model.others),
                "bench": model.bench,
                "folder": str(model.folder) if model.folder is not None else None,
                "saved": model.is_saved,
                "undo": self._at,
                "redo": len(self._states) - 1 - self._at,
                "values": found.values,
                "inherited": {".".join(map(str, key)): file for key, file in found.inherited.items()},
                "problems": [{**asdict(each), "location": list(each.location)} for each in found.problems],
                "sound": found.bench is not None,
                **_about(found),
            }


def _about(found: ModelCheck) -> dict[str, Any]:
    try:
        rules = [{**rule._asdict(), "margin_m": rule.margin_m} for rule in rules_of(found.values)]
    except (Failure, TypeError, ValueError):  # the points are no points, which the problems say
        rules = []
    if found.bench is None:
        return {"rules": rules}
    bench = found.bench
    return {
        "rules": rules,
        "lines": found.lines,
        "readings": readings(bench),
        "bodies": body_table(bench),
        "ratios": ratios(bench.plant.motor),
    }


def with_parts(model: ModelFiles, parts: dict[str, Any]) -> ModelFiles:
    """Return a model with the values of an identification: of motor, screen and blades; what they leave out stays."""
    plant = checked(model).values["plant"]
    for part in ("motor", "screen", "blades"):
        found = {key: value for key, value in parts.get(part, {}).items() if key not in ("name", "source", "comment")}
        if found:
            model = model.with_value(("plant", part), _over(plant[part], found))
    return model


def _over(before: Any, found: Any) -> Any:
    """Return a group with what was found in it, group by group."""
    if not (isinstance(before, dict) and isinstance(found, dict)):
        return found
    return {**before, **{key: _over(before.get(key), value) for key, value in found.items()}}
