"""A bench's text or description -> a bench that can run, or everything that is wrong with it.

Three phases: :mod:`hilplant.bench.source` reads the files, :mod:`hilplant.bench.description` says what they may hold,
and here the bench is built from the description alone.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench.bus import build_bus
from hilplant.bench.description import BenchDescription, LoopSettings
from hilplant.bench.doubts import note_doubts, offer_protection
from hilplant.bench.ecu_description import EcuSettings
from hilplant.bench.ecu_messages import EcuMessages, build_ecu_messages
from hilplant.bench.ecu_side import EcuSide, build_ecu_side, heard_references, note_one_way
from hilplant.bench.mapping import MappedMessage
from hilplant.bench.plant import Plant, build_plant
from hilplant.bench.source import Source, read_source
from hilplant.bench.values import signal_values
from hilplant.bus.codec import ReceivedMessage, SentMessage
from hilplant.checked_yaml.problems import BenchError, Problem
from hilplant.checked_yaml.spot import Spot
from hilplant.checked_yaml.yaml_reader import Document
from hilplant.models.park_phase import phase_at_rest
from hilplant.models.park_switch import cam_closed
from hilplant.models.records import Parameters, State
from hilplant.models.row import pack
from hilplant.models.slow_records import HeatState, WaterState, WearState
from hilplant.signals import INPUTS
from hilplant.units import MILLISECOND_NS, SECOND_NS

#: A path, the name of a shipped bench, YAML text, or a description that a program made.
BenchSource = str | Path | BenchDescription

#: What a bench is called in messages that was given as a description.
DESCRIBED = Path("(description)")


@dataclass(frozen=True, slots=True)
class Bench:
    """Everything that runs need, made before the first tick.

    `parameter_row`, `state_row` and `input_row` are flat rows for compiled code (see
    :mod:`hilplant.models.records`), the last two with the values at the start; `safe` are inputs by index
    with their values while commands are lost; `sources` is the text of every file that was read, by its name;
    `plant` is what the rows and tables were made from, `description` all that was written, `warnings` what is
    doubtful about it.
    """

    name: str
    path: Path
    step_ns: int
    plant: Plant
    parameters: Parameters
    parameter_row: Floats
    tables: Floats
    initial: dict[str, float]
    state_row: Floats
    input_row: Floats
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
    description: BenchDescription
    warnings: tuple[Problem, ...] = ()

    @property
    def others(self) -> frozenset[tuple[int, bool]]:
        """Identifiers of the messages between the ECU and its driver, with whether they are extended."""
        own = self.ecu_messages
        identifiers = [(message.identifier, message.extended) for message in own.stalk]
        return frozenset(identifiers + [(message.identifier, message.extended) for message in own.status])

    @property
    def pace(self) -> float:
        """Seconds of the plant in a second of the real clock."""
        return self.loop.pace

    def at(self, channel: str | None = None, pace: float | None = None) -> "Bench":
        """Return this bench on another channel of its interface, at another pace; None leaves what there is."""
        interface = self.interface if channel is None else {**self.interface, "channel": channel}
        loop = self.loop if pace is None else self.loop.model_copy(update={"pace": pace})
        return replace(self, interface=interface, loop=loop)

    def ecu_side(self) -> EcuSide:
        """Return the same messages as the stand-in ECU sees them: it sends what the plant receives."""
        periods_ns = {message.name: message.period_ns for message in self.send}
        sent = [mapped for mapped in self.reports if mapped.message.name in periods_ns]
        reports = [(mapped, periods_ns[mapped.message.name]) for mapped in sent]
        side = build_ecu_side(self.commands, reports, self.ecu.period_ms, self.ecu_messages)
        return replace(side, reference=heard_references(self.commands, self.receive))


def load_bench(source: BenchSource = "default") -> Bench:
    """Load a bench by its path or, for a shipped one, its name; from YAML text; or from a description.

    Raises
    ------
    BenchError
        With every problem in the bench's files, each with file and line.

    """
    bench, problems = _attempt(source)
    errors = [problem for problem in problems if problem.severity == "error"]
    if errors:
        raise BenchError(errors)
    if bench is None:
        raise AssertionError("a bench that was not built left no problem behind")
    return bench


def check_bench(source: BenchSource = "default") -> list[Problem]:
    """Return all that is wrong with a bench, sorted by file and line; what is doubtful is in `Bench.warnings`."""
    return [problem for problem in _attempt(source)[1] if problem.severity == "error"]


def initial_state(parameters: Parameters, initial: Mapping[str, Any]) -> Floats:
    """Return the row of the state in which a run begins; park switch and thermal switch are at rest there."""
    crank_angle_rad = initial["crank_angle_rad"]
    contact = cam_closed(crank_angle_rad, 0.0, parameters.park_switch)
    phase = phase_at_rest(crank_angle_rad, parameters.park_switch)
    heat = parameters.heat
    opened = heat.has_switch > 0.5 and heat.start_c >= heat.trip_c
    warm = HeatState(heat.start_c, heat.start_c, float(opened))
    worn, wet = WearState(parameters.wear.start_wipes), WaterState(parameters.water.start_mm)
    state = State(park_contact=contact, park_phase=phase, heat=warm, wear=worn, water=wet)
    return pack(state._replace(**initial))


def _attempt(source: BenchSource) -> tuple[Bench | None, tuple[Problem, ...]]:
    """Read, check and build a bench; return it, if nothing is wrong, and every problem."""
    if isinstance(source, BenchDescription):
        text = source.model_dump_json(exclude_unset=True)
        made = Source(DESCRIBED, Document(str(DESCRIBED)))
        made.reading.sources[str(DESCRIBED)] = text
        return _built(made, source)
    read = read_source(source)
    if not read.is_readable:
        return None, read.reading.sorted_problems()
    return _built(read, read.reading.draft(read.document, (), read.document.data, BenchDescription))


def _built(source: Source, description: BenchDescription | None) -> tuple[Bench | None, tuple[Problem, ...]]:
    bench, spot = None, Spot()
    if description is not None:
        bench = build_bench(spot, description, source.path)
        errors = any(finding.severity == "error" for finding in spot.findings)
        if bench is not None and not errors and not source.reading.problems:
            note_doubts(spot, description, bench.plant)
            offer_protection(spot.inner("bus"), bench.commands, bench.reports)
            note_one_way(spot.inner("bus"), bench.commands)
        source.reading.keep(source.document, spot.findings)
    problems = source.reading.sorted_problems()
    if bench is None or any(problem.severity == "error" for problem in problems):
        return None, problems
    return replace(bench, sources=source.reading.sources, warnings=problems), problems


def build_bench(spot: Spot, description: BenchDescription, path: Path) -> Bench | None:
    """Build a bench from its description, which may have holes; what is wrong is noted, and then there is none."""
    step_ns = _step_ns(spot, description.step_s)
    plant = build_plant(spot.inner("plant"), description.plant, step_ns) if description.plant is not None else None
    bus = build_bus(spot.inner("bus"), description.bus, step_ns) if description.bus is not None else None
    ecu, ecu_messages = description.ecu, EcuMessages()
    if bus is not None and ecu is not None:
        ecu_messages = build_ecu_messages(spot.inner("ecu"), ecu, bus)
    whole = all(part is not None for part in (description.initial, description.inputs, description.loop, ecu))
    if plant is None or bus is None or not whole:
        return None
    initial = description.initial.model_dump()
    return Bench(
        name=description.name,
        path=path,
        step_ns=step_ns,
        plant=plant,
        parameters=plant.parameters,
        parameter_row=pack(plant.parameters),
        tables=plant.tables,
        initial=initial,
        state_row=initial_state(plant.parameters, initial),
        input_row=_input_row(description.inputs),
        interface=bus.interface,
        receive=bus.receive,
        send=bus.send,
        safe=bus.safe,
        loop=description.loop,
        ecu=ecu,
        sources={},
        commands=bus.commands,
        reports=bus.reports,
        ecu_messages=ecu_messages,
        description=description,
    )


def _input_row(written: Mapping[str, Any]) -> Floats:
    row = np.array([signal.default for signal in INPUTS])
    for index, value in signal_values(written):
        row[index] = value
    return row


def _step_ns(spot: Spot, step_s: float | None) -> int:
    """Return the step; for a hole the usual one, so that the rest can be checked."""
    if step_s is None:
        return MILLISECOND_NS
    step_ns = round(step_s * SECOND_NS)
    if step_ns == 0 or abs(step_ns - step_s * SECOND_NS) > 1e-3:
        spot.note("step_s", text=f"step_s must be a whole number of nanoseconds, not {step_s!r}")
    return max(step_ns, 1)
