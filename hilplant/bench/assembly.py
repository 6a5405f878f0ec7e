"""A bench file and all that it names -> a bench that can run, or everything that is wrong with them."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hilplant import resources
from hilplant.bench.bus import assemble_bus
from hilplant.bench.description import BenchFile, InitialSection, LoopSettings
from hilplant.bench.ecu_description import EcuSettings
from hilplant.bench.ecu_messages import EcuMessages, assemble_ecu_messages
from hilplant.bench.ecu_side import EcuSide, build_ecu_side
from hilplant.bench.inheritance import read_bench_file
from hilplant.bench.mapping import MappedMessage
from hilplant.bench.plant import Plant, assemble_plant
from hilplant.bench.values import signal_values
from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.checked_yaml.place import Place
from hilplant.checked_yaml.problems import BenchError, Problem
from hilplant.checked_yaml.reading import Description, Reading
from hilplant.models.park_phase import phase_at_rest
from hilplant.models.park_switch import cam_closed
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack
from hilplant.signals import INPUTS
from hilplant.units import MILLISECOND_NS, SECOND_NS


@dataclass(frozen=True, slots=True)
class Bench:
    """Everything that runs need, made before the first tick.

    `parameter_row`, `state_row` and `input_row` are flat rows for compiled code (see
    :mod:`hilplant.models.records`), the last two with the values at the start; `safe` are inputs by index
    with their values while commands are lost; `sources` is the text of every file that was read, by its name;
    `plant` is what the rows and tables were made from.
    """

    name: str
    path: Path
    step_ns: int
    plant: Plant
    parameters: Parameters
    parameter_row: NDArray[np.float64]
    tables: NDArray[np.float64]
    initial: dict[str, float]
    state_row: NDArray[np.float64]
    input_row: NDArray[np.float64]
    interface: dict[str, Any]
    receive: tuple[ReceivedMessage, ...]
    send: tuple[SentMessage, ...]
    safe: tuple[tuple[int, float], ...]
    loop: LoopSettings
    ecu: EcuSettings
    sources: dict[str, str]
    commands: tuple[MappedMessage, ...]
    reports: tuple[MappedMessage, ...]
    ecu_messages: EcuMessages

    @property
    def others(self) -> frozenset[tuple[int, bool]]:
        """Identifiers of the messages between the ECU and its driver, with whether they are extended."""
        own = self.ecu_messages
        identifiers = [(message.identifier, message.extended) for message in own.stalk]
        return frozenset(identifiers + [(message.identifier, message.extended) for message in own.status])

    def ecu_side(self) -> EcuSide:
        """Return the same messages as the stand-in ECU sees them: it sends what the plant receives."""
        periods_ns = {message.name: message.period_ns for message in self.send}
        sent = [mapped for mapped in self.reports if mapped.message.name in periods_ns]
        reports = [(mapped, periods_ns[mapped.message.name]) for mapped in sent]
        return build_ecu_side(self.commands, reports, self.ecu.period_ms, self.ecu_messages)


def load_bench(name: str | Path = "default") -> Bench:
    """Load a bench by its path, or a shipped one by its name.

    Raises
    ------
    BenchError
        With every problem in the bench's files, each with file and line.

    """
    reading = Reading()
    bench = _assemble(reading, resources.named("benches", name))
    reading.raise_problems()
    if bench is None:
        raise AssertionError("a bench that was not built left no problem behind")
    return bench


def check_bench(name: str | Path = "default") -> list[Problem]:
    """Return all that is wrong with a bench, sorted by file and line."""
    try:
        load_bench(name)
    except BenchError as error:
        return list(error.problems)
    return []


def initial_state(parameters: Parameters, initial: Mapping[str, Any]) -> NDArray[np.float64]:
    """Return the row of the state in which a run begins; the park switch is at rest there."""
    crank_angle_rad = initial["crank_angle_rad"]
    contact = cam_closed(crank_angle_rad, 0.0, parameters.park_switch)
    phase = phase_at_rest(crank_angle_rad, parameters.park_switch)
    return pack(State(park_contact=contact, park_phase=phase)._replace(**initial))


def _assemble(reading: Reading, path: Path) -> Bench | None:
    document = read_bench_file(reading, path)
    if reading.problems and document.data is None:
        return None
    file = Place(reading, document, ())
    settings = _settings(file)
    step_ns = settings.step_ns if settings is not None else MILLISECOND_NS  # so that the rest can be checked
    plant = assemble_plant(file.inner("plant"), step_ns) if _is_group(file, "plant") else None
    bus = assemble_bus(file.inner("bus"), step_ns) if _is_group(file, "bus") else None
    ecu_messages = assemble_ecu_messages(file.inner("ecu"), bus) if bus is not None else EcuMessages()
    if settings is None or plant is None or bus is None or reading.problems:
        return None
    return Bench(
        name=settings.name,
        path=path,
        step_ns=step_ns,
        plant=plant,
        parameters=plant.parameters,
        parameter_row=pack(plant.parameters),
        tables=plant.tables,
        initial=settings.initial,
        state_row=initial_state(plant.parameters, settings.initial),
        input_row=settings.input_row,
        interface=bus.interface,
        receive=bus.receive,
        send=bus.send,
        safe=bus.safe,
        loop=settings.loop,
        ecu=settings.ecu,
        sources=reading.sources,
        commands=bus.commands,
        reports=bus.reports,
        ecu_messages=ecu_messages,
    )


@dataclass(frozen=True, slots=True)
class _Settings:
    name: str
    step_ns: int
    initial: dict[str, float]
    input_row: NDArray[np.float64]
    loop: LoopSettings
    ecu: EcuSettings


def _settings(file: Place) -> _Settings | None:
    """Check what is neither plant nor bus."""
    top = file.take(BenchFile)
    initial = _section(file.inner("initial"), InitialSection)
    loop, ecu = _section(file.inner("loop"), LoopSettings), _section(file.inner("ecu"), EcuSettings)
    input_row = np.array([signal.default for signal in INPUTS])
    for index, value in signal_values(file.inner("inputs"), {}):
        input_row[index] = value
    if top is None or initial is None or loop is None or ecu is None:
        return None
    return _Settings(top.name, _step_ns(file, top.step_s), initial.model_dump(), input_row, loop, ecu)


def _step_ns(file: Place, step_s: float) -> int:
    step_ns = round(step_s * SECOND_NS)
    if step_ns == 0 or abs(step_ns - step_s * SECOND_NS) > 1e-3:
        file.note("step_s", text=f"step_s must be a whole number of nanoseconds, not {step_s!r}")
    return max(step_ns, 1)


def _section(place: Place, model: type[Description]) -> Description | None:
    """Check a section that may be left out; one that is no group has been told so."""
    data = place.data()
    if not isinstance(data, dict | None):
        return None
    return place.reading.check(place.document, place.location, data or {}, model)


def _is_group(file: Place, key: str) -> bool:
    return isinstance(file.inner(key).data(), dict)
