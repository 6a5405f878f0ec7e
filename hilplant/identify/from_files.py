"""Identification from files of measurements to files of a bench; a run that was killed can go on."""

import hashlib
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench, load_bench
from hilplant.failure import Failure
from hilplant.identify.executor import Executor, here, on_cluster
from hilplant.identify.experiment import Run
from hilplant.identify.genetic import SearchSettings
from hilplant.identify.journal import Journal
from hilplant.identify.optimisers import optimiser
from hilplant.identify.parameters import BY_NAME, Choice, chosen, of_the_wiper
from hilplant.identify.result_files import ResultOrigin, write_bench, write_partly
from hilplant.identify.run_of_data import make_run
from hilplant.identify.stages import ALL, LEAST_SQUARES, TRANSFER_FUNCTION, StagedValues
from hilplant.identify.starting_point import StartingPoint, starting_point
from hilplant.identify.three_stages import Identified, Task, has_wiper, identify, identify_partly
from hilplant.measurements.named_data import Named, read_named
from hilplant.models.load import LOADS
from hilplant.progress import OnProgress, unseen


@dataclass(frozen=True, slots=True)
class Request:
    """What the command line asks for."""

    data: tuple[str, ...]
    bench: str
    out: Path
    held_out: tuple[str, ...] = ()
    hold: tuple[str, ...] = ()
    also: tuple[str, ...] = ()
    columns: str = ""
    frames: str | None = None
    search: str = "genetic"
    generations: int = 200
    population: int = 40
    ordered: bool = True
    seed: int = 0
    resume: bool = False
    dask: str | None = None
    date: str = ""
    stages: tuple[int, ...] = ALL


class IdentifiedFiles(NamedTuple):
    """What was found, from what, and the files that were written.

    `notes` are what there is to say of the data; `journal` is to be removed when all that is wanted has been written.
    """

    found: Identified | StagedValues
    task: Task
    known: StartingPoint
    origin: ResultOrigin
    notes: list[str]
    written: list[Path]
    journal: Journal


def identify_files(request: Request, on_progress: OnProgress = unseen) -> IdentifiedFiles:
    """Identify what a request names, and write the bench and its parameter files."""
    bench = load_bench(request.bench)
    optimiser(request.search)
    settings = _settings(request)
    _refuse_other_load(bench, request.bench)
    base, held = _held(bench, request.hold)
    choice = chosen(base, request.also, [*held, *(of_the_wiper() if not has_wiper(bench) else ())])
    reading = request.columns, request.frames
    fitted, held_out = (read_named(names, *reading) for names in (request.data, request.held_out))
    known = _starting_point(request, fitted, choice, bench.parameters.motor.gear_ratio)
    journal = Journal(_journal_path(request.out), _identity(request, bench, [*fitted, *held_out]), request.resume)
    with ExitStack() as open_things:
        executor: Executor = here
        if request.dask is not None:
            executor = open_things.enter_context(on_cluster(request.dask))
        task = Task(
            bench, _runs(fitted, bench), choice, known.values, _runs(held_out, bench), settings, request.seed,
            request.search, request.ordered, executor, journal.answering, on_progress, request.stages,
        )  # fmt: skip
        found = identify(task) if LEAST_SQUARES in request.stages else identify_partly(task)
    fitted_files, held_files = (tuple((each.text, each.data) for each in named) for named in (fitted, held_out))
    origin = ResultOrigin(fitted_files, held_files, request.date, request.seed, request.search)
    if isinstance(found, Identified):
        written = write_bench(request.out, found, origin)
    else:
        written = write_partly(request.out, task, found, origin)
    notes = [note for named in fitted for note in named.notes] + list(known.notes)
    return IdentifiedFiles(found, task, known, origin, notes, written, journal)


def _starting_point(request: Request, fitted: list[Named], choice: Choice, gear_ratio: float) -> StartingPoint:
    """Ask stage 1 where it is wanted; else everything begins at what the bench says."""
    if TRANSFER_FUNCTION not in request.stages:
        return StartingPoint(choice.values, {}, ("stage 1 was left out: the search begins about the bench's values",))
    return starting_point([named.data for named in fitted], choice, gear_ratio)


def _settings(request: Request) -> SearchSettings:
    if request.population < 8 or request.generations < 1:
        raise Failure("the search needs a population of 8 at least, and one generation")
    return SearchSettings(population=request.population, generations=request.generations)


def _held(bench: Bench, texts: tuple[str, ...]) -> tuple[Floats, list[str]]:
    """Return the bench's row with held parameters at the values given (NAME=VALUE, or NAME for the bench's)."""
    row, names = bench.parameter_row.copy(), []
    for text in texts:
        name, _, value = text.partition("=")
        if name not in BY_NAME:
            raise Failure(f"--hold {text}: there is no parameter '{name}'; known: {', '.join(BY_NAME)}")
        if value:
            try:
                number = float(value)
            except ValueError:
                raise Failure(f"--hold {text}: '{value}' is no number") from None
            row = Choice([BY_NAME[name]], row).rows(np.array([[number]]))[0]
        names.append(name)
    return row, names


def _refuse_other_load(bench: Bench, name: str) -> None:
    if not has_wiper(bench) and LOADS[int(bench.parameters.load.model)] != "none":
        raise Failure(
            f"{name}: identification finds the friction of blades, or a motor alone; plant: load: must be "
            "{model: reduced} or {model: none}"
        )


def _runs(named: list[Named], bench: Bench) -> list[Run]:
    return [make_run(each.data, bench, each.screen) for each in named]


def _journal_path(out: Path) -> Path:
    return out.with_name(f"{out.name}.journal")


def _identity(request: Request, bench: Bench, named: list[Named]) -> str:
    """Return a digest of everything that decides which sets are asked for."""
    digest = hashlib.sha256(bench.parameter_row.tobytes() + bench.tables.tobytes() + bench.input_row.tobytes())
    for each in named[: len(request.data)]:
        digest.update(f"{each.screen} {each.data.sha256}".encode())
        for values in (each.data.voltage_v, each.data.current_a, each.data.park, each.data.fast):
            digest.update(values.tobytes())
    choices = (request.hold, request.also, request.search, request.generations, request.population, request.ordered)
    digest.update(repr((choices, request.seed, request.stages)).encode())
    return digest.hexdigest()


def partial_figures(task: Task, found: StagedValues) -> dict[str, Any]:
    """Return the numbers of some stages for a JSON file."""
    flat: dict[str, Any] = {"cost": found.cost, "seconds": found.seconds, "stages": list(task.stages)}
    flat |= dict(zip(task.choice.names, found.values.tolist(), strict=True))
    for role, compared in (("fitted", found.fitted), ("held_out", found.held_out)):
        for index, comparison in enumerate(compared, 1):
            flat[f"{role}_{index}_rms_current_a"] = comparison.error.rms_current_a
    return flat


def figures(found: Identified) -> dict[str, Any]:
    """Return the numbers for a JSON file."""
    times = found.times
    flat: dict[str, Any] = {
        "search_cost": found.outcome.cost,
        "cost": found.final_cost,
        "rms_current_a": found.solution.noise.current_a,
        "rms_park_edge_s": found.solution.noise.edge_s,
        "search_s": times.global_s,
        "search_evaluations": times.global_evaluations,
        "search_evaluations_from_journal": times.global_evaluations - times.global_computed,
        "evaluations_per_s": times.evaluations_per_s,
        "refinement_s": times.local_s,
        "intervals_s": times.intervals_s,
        "current_explained": not found.unexplained,
        "not_told": [verdict.name for verdict in found.verdicts if not verdict.identifiable],
    }
    flat |= {verdict.name: verdict.value for verdict in found.verdicts}
    for name, (low, high) in found.told_intervals.items():
        flat[f"{name}_low"], flat[f"{name}_high"] = low, high
    for index, comparison in enumerate(found.held_out, 1):
        flat[f"held_out_{index}_rms_current_a"] = comparison.error.rms_current_a
    return flat
