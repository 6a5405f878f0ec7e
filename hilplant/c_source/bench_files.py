"""A bench as data in C, and a program that steps it."""

from pathlib import Path

from hilplant.arrays import Floats
from hilplant.atomic_write import make_folder, write_text
from hilplant.bench import Bench
from hilplant.c_source.compiler import FLAGS
from hilplant.c_source.expression import literal
from hilplant.c_source.plant_files import plant_c, plant_h
from hilplant.declaration import declared
from hilplant.models.records import Parameters, State
from hilplant.signals import INPUTS

_BENCH_H = """/* The bench `{name}`: what its plant is made of, and how a run begins. */
#ifndef HILPLANT_BENCH_H
#define HILPLANT_BENCH_H
#include "plant.h"

#define BENCH_STEP_S {step_s}
extern const double bench_state[HILPLANT_STATES];
extern const double bench_inputs[HILPLANT_INPUTS];
extern const hilplant_plant bench;
#endif
"""

#: How the files are compiled, in their folder.
COMPILE = f"gcc {' '.join(FLAGS)} plant.c bench.c main.c -o plant -lm"


def write_sources(bench: Bench, folder: Path) -> list[Path]:
    """Write plant.h, plant.c, bench.h, bench.c and main.c into a folder; return their paths."""
    texts = {
        "plant.h": plant_h(),
        "plant.c": plant_c(),
        "bench.h": _BENCH_H.format(name=bench.name, step_s=literal(bench.parameters.step_s).c),
        "bench.c": bench_c(bench),
        "main.c": Path(__file__).with_name("main.c").read_text(encoding="utf-8"),
    }
    paths = [folder / name for name in texts]
    make_folder(folder)
    for path, text in zip(paths, texts.values(), strict=True):
        write_text(path, text)
    return paths


def bench_c(bench: Bench) -> str:
    """Return parameters, tables, state and inputs of a bench; every number is read back bit for bit."""
    knots, channels = bench.tables.shape[:2]
    parameters = [signal.name for signal in declared(Parameters)]
    return "\n".join(
        [
            f"/* The bench `{bench.name}`. */",
            '#include "bench.h"',
            "",
            _named("const double bench_state[HILPLANT_STATES]", [s.name for s in declared(State)], bench.state_row),
            _named("const double bench_inputs[HILPLANT_INPUTS]", [s.name for s in INPUTS], bench.input_row),
            _named("static const double parameters[]", parameters, bench.parameter_row),
            f"/* [{knots} knots, {channels} channels, value and derivative] */",
            "static const double tables[] = {",
            *(f"    {', '.join(_numbers(row))}," for row in bench.tables.reshape(knots * channels, 2)),
            "};",
            "",
            "const hilplant_plant bench = {",
            f"    parameters, {len(bench.parameter_row)}, tables, {knots}, {channels},",
            "};",
            "",
        ]
    )


def _named(head: str, names: list[str], row: Floats) -> str:
    numbers = _numbers(row)
    lines = [f"    {number}, /* {name} */" for number, name in zip(numbers, names, strict=False)]
    lines += [f"    {number}," for number in numbers[len(names) :]]
    return "\n".join([f"{head} = {{", *lines, "};", ""])


def _numbers(row: Floats) -> list[str]:
    return [literal(float(number)).c for number in row]
