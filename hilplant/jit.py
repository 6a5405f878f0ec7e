"""The one place that decides how the models are compiled."""

import atexit
import hashlib
import inspect
import os
import shutil
import signal
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numba.extending
from platformdirs import user_cache_path

from hilplant.inlined import Inlined

Function = TypeVar("Function", bound=Callable[..., Any])


def _sources_hash(*rooms: str) -> str:
    """Name the compiled code after every source of these rooms that it could be built from.

    numba watches only the file of the compiled function itself, so an edit in a function that it calls would
    otherwise go on running as it was before.
    """
    digest = hashlib.sha256(numba.__version__.encode())
    package = Path(__file__).parent
    for room in rooms:
        for source in sorted((package / room).glob("*.py")):
            digest.update(source.read_bytes())
    for name in ("declaration.py", "inlined.py", "jit.py", "signals.py", "units.py"):
        digest.update((package / name).read_bytes())
    return digest.hexdigest()[:16]


def _usable(folder: Path) -> bool:
    """Whether compiled code may be kept in a folder, and run from it: nobody else may have put any there.

    The folder must belong to this user or to the owner of the sources, with no right to write for others; and
    nobody else may replace it, as far up as the root.
    """
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        real = folder.resolve()
        return os.access(real, os.W_OK) and _trusted(real, 0o022) and all(_trusted(up, 0o002) for up in real.parents)
    except OSError:
        return False


def _trusted(folder: Path, others: int) -> bool:
    found = folder.stat()
    if not hasattr(os, "geteuid"):  # rights are another matter outside Unix
        return True
    owners = {os.geteuid(), 0, Path(__file__).stat().st_uid}
    return found.st_uid in owners and (not found.st_mode & others or bool(found.st_mode & stat.S_ISVTX))


#: Changes when any model's source or the compiler changes; recordings carry it.
MODELS_HASH = _sources_hash("models")


#: Where compiled functions are written and called. All of these decide whether what is in the cache still holds.
ROOMS = ("models", "control", "train")


def _cache_folder() -> Path:
    root = Path(os.environ.get("NUMBA_CACHE_DIR") or user_cache_path("hilplant"))
    folder = root / f"compiled-{_sources_hash(*ROOMS)}"
    if _usable(folder):
        return folder
    passing = tempfile.mkdtemp(prefix="hilplant-compiled-")
    atexit.register(shutil.rmtree, passing, ignore_errors=True)
    return Path(passing)


vars(numba.config)["CACHE_DIR"] = str(_cache_folder())


#: All that a step calls becomes one piece of code: calls between pieces cost a quarter of the step. Without numba's
#: run time nobody counts references to the caller's arrays, atomically, at every call: another quarter.
_OPTIONS: Any = {"error_model": "numpy", "forceinline": True, "_nrt": False, "no_cfunc_wrapper": True}


def compiled(function: Function) -> Function:
    """Compile a model function. No fastmath: results must not depend on how the compiler reorders a sum.

    It may read and write arrays of its caller. It cannot make one, which is an error when it is compiled, and must not
    return one to Python.
    """
    return _taken_in(function, _OPTIONS)


def compiled_apart(function: Function) -> Function:
    """Compile a model function that few benches call: the code of what calls it calls it, and does not contain it."""
    return _taken_in(function, {name: value for name, value in _OPTIONS.items() if name != "forceinline"})


def _taken_in(function: Function, options: Any) -> Function:
    if vars(numba.config)["DISABLE_JIT"]:
        return function
    dispatcher = Inlined(function, targetoptions={"nopython": True, **options})
    dispatcher.enable_caching()
    return cast(Function, dispatcher)


#: The lines of a function's body, and what the names in it mean.
Written = tuple[list[str], dict[str, Any]]

#: Who writes the body of a function that :func:`written_out` has registered.
WRITTEN_OUT: dict[Callable[..., Any], Callable[..., Written]] = {}


def written_out(function: Callable[..., Any]) -> Callable[[Callable[..., Written]], Callable[..., Written]]:
    """Let compiled code call `function`, with a body that is written for the records among its arguments.

    The decorated writer is given, for each argument, the class of the record that it is or that it names, or else
    None; it returns the body, in which the arguments have their names.
    """
    arguments = ", ".join(inspect.signature(function).parameters)

    def register(writer: Callable[..., Written]) -> Callable[..., Written]:
        def implementation(*kinds: Any) -> Callable[..., Any]:
            lines, names = writer(*(getattr(kind, "instance_class", None) for kind in kinds))
            exec("\n    ".join([f"def body({arguments}):", *lines]), names)
            return cast(Callable[..., Any], names["body"])

        WRITTEN_OUT[function] = writer
        # options that are left out would come from the first caller
        numba.extending.overload(function, jit_options=_OPTIONS, strict=False)(implementation)
        return writer

    return register


def compiled_for_threads(function: Function) -> Function:
    """Compile a model function that runs long and lets other threads of Python run meanwhile.

    Several threads may call it at once, each on arrays of its own; it makes none, as with :func:`compiled`.
    """
    options: dict[str, Any] = {"cache": True, "error_model": "numpy", "nogil": True, "_nrt": False}
    return cast(Function, numba.njit(**options)(function))


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Keep Ctrl-C waiting while compiled code returns a record: an interrupt while Python makes it would crash."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
