"""The C compiler, where there is one."""

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from hilplant.failure import Failure

#: No fused multiply-add, and no liberties with sums: the results are those of the compiled Python, bit for bit.
FLAGS = ("-std=c11", "-O3", "-ffp-contract=off")


def compiler() -> str:
    """Return the name and version of the C compiler."""
    if shutil.which("gcc") is None:
        raise Failure("gcc is not here; as root: apt-get install gcc")
    said = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=False)
    return f"gcc {said.stdout.strip()}"


def compile_program(sources: Sequence[Path], program: Path, *more_flags: str) -> None:
    """Compile C files to a program, or with ``-shared -fPIC`` to a library."""
    compiler()
    command = ["gcc", *FLAGS, *more_flags, *map(str, sources), "-o", str(program), "-lm"]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    if ended.returncode:
        raise Failure(f"gcc: {(ended.stderr.strip() or 'no message').splitlines()[0]}")


def compile_library(text: str, header: str, folder: Path, *more_flags: str) -> Path:
    """Compile the plant's C file with its header in `folder`; return the library."""
    source, library = folder / "plant.c", folder / f"plant{''.join(more_flags)}.so"
    source.write_text(text, encoding="utf-8")
    (folder / "plant.h").write_text(header, encoding="utf-8")
    compile_program([source], library, "-shared", "-fPIC", *more_flags)
    return library
