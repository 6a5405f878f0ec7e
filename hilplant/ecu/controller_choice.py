"""Which controller a name means: a shipped one, one of a file, a package's, or a function of a user's module."""

import sys
from collections.abc import Callable
from functools import partial
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, NamedTuple

from hilplant.bench.controller_file import ControllerFile
from hilplant.bench.speed_network_file import FORMAT
from hilplant.checked_yaml.checksummed import flaw_of
from hilplant.checked_yaml.reading import Reading
from hilplant.checked_yaml.spot import NAMED
from hilplant.checked_yaml.yaml_reader import Document, Location
from hilplant.control.catalogue import SENSORLESS, catalogue, controller_named, with_stages, without_network
from hilplant.control.controller import Tables
from hilplant.control.own import Maker, OwnLoopSeat, OwnSeat, Watch
from hilplant.control.records import Controller
from hilplant.control.reference import Reference
from hilplant.control.seat import LoopSeat, Seat
from hilplant.failure import Failure
from hilplant.models.records import Motor
from hilplant.resources import shipped
from hilplant.runtime.clock import thread_cpu_ns, thread_cpu_step_ns, thread_waits
from hilplant.units import MICROSECOND_NS, SECOND_NS

#: Packages offer their controllers here: NAME = "module:function", a :data:`hilplant.control.own.Maker`.
ENTRY_POINTS = "hilplant.controllers"


class ControllerChoice(NamedTuple):
    """A controller by its name, the wanted speed [rad/s] by the time [s], its budget [us] (None: half a period)."""

    name: str
    reference: Reference
    budget_us: int | None = None


class Driven(NamedTuple):
    """Where it is to sit: beside a motor, ticked with a period [s]."""

    motor: Motor
    period_s: float


def seat_on_bus(choice: ControllerChoice, driven: Driven) -> Seat | OwnSeat:
    """Return the controller for a node on the bus."""
    maker = own_maker(choice.name)
    if maker is not None:
        return OwnSeat(maker, *driven, choice.reference, _watch(choice, driven))
    return Seat(*_shipped(choice.name, driven), choice.reference)


def seat_in_loop(choice: ControllerChoice, driven: Driven, parameter_row: Any) -> LoopSeat | OwnLoopSeat:
    """Return the controller for the inside of a plant's loop; its `drive` is what ``Loop.control`` calls."""
    maker = own_maker(choice.name)
    if maker is not None:
        return OwnLoopSeat(maker, *driven, choice.reference, _watch(choice, driven), parameter_row)
    return LoopSeat(*_shipped(choice.name, driven), choice.reference, parameter_row)


def own_maker(name: str) -> Maker | None:
    """Return what makes a user's controller, `module:function` or a package's; None for a file or a shipped one.

    Raises
    ------
    Failure
        When the module cannot be imported, or has no such function.

    """
    if ":" in name:
        return _imported(name)
    found = entry_points(group=ENTRY_POINTS, name=name)
    return partial(_made, name, next(iter(found)).load()) if found else None


def _shipped(name: str, driven: Driven) -> tuple[Controller, Tables]:
    """Return a controller of a file, or of the catalogue with both brushes, and the arrays that it reads."""
    file = shipped("config", "controllers", f"{name}.yaml")
    if name.endswith((".yaml", ".yml")) or file.is_file():
        written = controller_file(file if file.is_file() else Path(name))
        return written.controller(*driven), written.tables()
    if name.removesuffix(SENSORLESS) not in catalogue(*driven):
        offered = sorted({entry.name for entry in entry_points(group=ENTRY_POINTS)})
        packages = f"; of packages {', '.join(offered)}" if offered else ""
        files = ", ".join(sorted(path.stem for path in shipped("config", "controllers").glob("*.yaml")))
        raise Failure(
            f"there is no controller {name!r}; there are {', '.join(catalogue(*driven))}, each also with {SENSORLESS}"
            f"{packages}; as files {files}; a file of yours ending .yaml; or module:function"
        )
    return with_stages(controller_named(name, *driven), driven.motor), without_network()


def controller_file(path: Path) -> ControllerFile:
    """Read a controller's file.

    Raises
    ------
    BenchError
        With every problem, each with file and line.

    """
    reading = Reading()
    document = reading.named_file(path)
    _put_network(reading, document)
    found = reading.take(document, (), ControllerFile) if document.data is not None else None
    reading.raise_problems()
    if found is None:
        raise Failure(f"{path}: holds nothing; docs/control.md shows a controller's file")
    return found


def _put_network(reading: Reading, document: Document) -> None:
    """Put the speed network that a controller's file names where it is named."""
    at: Location = ("network",)
    if not isinstance(document.at(at), str):
        return
    path = reading.referred_path(document, at)
    trouble = flaw_of(path, FORMAT) if path is not None else ""
    read = reading.file(path) if path is not None and not trouble else trouble
    if isinstance(read, Document):
        document.put(at, read, NAMED)
    elif read:
        reading.note(document, at, f"'{document.at(at)}' {read}")
    reading.raise_problems()


def _imported(name: str) -> Maker:
    module, _, function = name.partition(":")
    sys.path.insert(0, str(Path.cwd()))
    try:
        found = getattr(import_module(module), function)
    except Exception as error:  # whatever an import of a user's module may raise
        raise Failure(f"controller {name}: {type(error).__name__}: {error}; write module:function") from error
    finally:
        sys.path.pop(0)
    return partial(_made, name, found)


def _made(name: str, function: Callable[..., Any], motor: Motor, period_s: float) -> Any:
    """Call a user's maker, before the first tick or when it begins anew."""
    try:
        decide = function(motor, period_s)
    except Exception as error:
        raise Failure(f"controller {name}: {type(error).__name__}: {error}") from error
    if not callable(decide):
        raise Failure(
            f"controller {name}: {function!r:.40} must return a function (reference, measured), not {decide!r:.40}"
        )
    return decide


def _watch(choice: ControllerChoice, driven: Driven) -> Watch:
    half = round(driven.period_s * SECOND_NS / 2)
    budget_ns = half if choice.budget_us is None else choice.budget_us * MICROSECOND_NS
    return Watch(budget_ns, thread_cpu_ns, thread_waits, thread_cpu_step_ns())
