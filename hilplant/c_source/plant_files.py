"""The step as one C file and its header, the same for every bench."""

import re
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numba

from hilplant import jit
from hilplant.c_source.c_types import Array, Type
from hilplant.c_source.functions import translate
from hilplant.c_source.program import Program
from hilplant.declaration import Signal, declared
from hilplant.models import plant
from hilplant.models.records import Parameters, State
from hilplant.signals import Inputs, Outputs

ROW, WRITABLE_ROW = Array((None,)), Array((None,), writable=True)
ROWS, WRITABLE_ROWS = Array((None, None)), Array((None, None), writable=True)
TABLES = Array((None, None, 2))

#: Functions that are called from outside, and the arrays that they take.
TICK: dict[Any, tuple[Type, ...]] = {
    plant.tick: (WRITABLE_ROW, ROW, ROW, TABLES, WRITABLE_ROW),
    plant.simulate_rows: (WRITABLE_ROW, ROWS, ROW, TABLES, WRITABLE_ROWS),
}

_HERE = Path(__file__).parent
_WIDTH = 120

#: Calls between pieces cost half of the step, so a compiler that can be told makes one piece of it.
_INLINE = """#ifndef INLINE
#if defined(__GNUC__)
#define INLINE static inline __attribute__((always_inline))
#else
#define INLINE static inline
#endif
#endif"""

_HEADER = """/* {what}
 *
 * Translated from the compiled step of hilplant {version}, models {hash}, which hilplant/models explains.
 * The results are the same bit for bit when it is compiled without -ffast-math and with -ffp-contract=off.
 */"""


def plant_h() -> str:
    """Return the header: the functions, and the places in the rows of state, inputs, parameters and outputs."""
    rows = {"STATE": State, "INPUT": Inputs, "PARAMETER": Parameters, "OUTPUT": Outputs}
    guard = "#ifndef HILPLANT_PLANT_H\n#define HILPLANT_PLANT_H\n#include <stdint.h>"
    parts = [f"{_head('The step of the plant.')}\n{guard}"]
    parts += [_places(prefix, declared(record)) for prefix, record in rows.items()]
    names = ",".join(signal.name for signal in declared(Outputs))
    parts.append(f'#define HILPLANT_OUTPUT_NAMES \\\n    "{names}"')
    parts.append((_HERE / "plant_functions.h").read_text(encoding="utf-8").rstrip())
    return "\n\n".join(parts) + "\n#endif\n"


def plant_c(more: Mapping[Any, tuple[Type, ...]] | None = None, entries: str = "") -> str:
    """Return the C file; `more` are compiled functions beside the step, and `entries` C text that calls them."""
    head = _head("The step of the plant.") + '\n#include "plant.h"'
    calls = [(_HERE / "entries.c").read_text(encoding="utf-8").rstrip(), *([entries.rstrip()] if entries else [])]
    return "\n\n".join([head, translated({**TICK, **(more or {})}), *calls]) + "\n"


def translated(functions: Mapping[Any, tuple[Type, ...]]) -> str:
    """Return compiled functions in C for these arguments, with all that they call, for one file of their own."""
    program = Program(translate)
    for function, arguments in functions.items():
        program.function(function, arguments)
    parts = [
        "#include <math.h>\n#include <stdbool.h>\n#include <stdint.h>\n#include <stdlib.h>",
        _INLINE,
        (_HERE / "arithmetic.c").read_text(encoding="utf-8").rstrip(),
        "\n\n".join(program.structs.values()),
        "\n".join(program.constants.values()),
        *(function.text.replace("static inline", "INLINE", 1) for function in program.functions.values()),
    ]
    return "\n".join(short for line in "\n\n".join(parts).split("\n") for short in _shortened(line))


def _head(what: str) -> str:
    from hilplant import __version__

    return _HEADER.format(what=what, version=__version__, hash=f"{jit.MODELS_HASH}, numba {numba.__version__}")


def _places(prefix: str, signals: tuple[Signal, ...]) -> str:
    lines = []
    for signal in signals:
        unit = f" [{signal.unit}]" if signal.unit else ""
        lines.append(f"    {prefix}_{re.sub('[^A-Z0-9]', '_', signal.name.upper())}, /* {signal.meaning}{unit} */")
    return "\n".join(["enum {", *lines, f"    HILPLANT_{prefix}S", "};"])


def _shortened(line: str) -> list[str]:
    """Break a line of code that is too long where a term ends."""
    if len(line) <= _WIDTH or line.lstrip().startswith(("/*", "*", "#")):
        return [line]
    indent = " " * (len(line) - len(line.lstrip()) + 8)
    return textwrap.wrap(
        line, _WIDTH, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False, drop_whitespace=True
    )
