"""Compiled functions that callers take in whole: machine code is made of what Python calls, and of nothing else.

Numba optimises every function that it compiles and makes machine code of it, with all that it calls, although nobody
but other compiled functions may ever call it: two thirds of the time in which a step compiles. Here a function stays as
it was lowered until one that Python calls takes in all that it needs. The parts of numba that this takes are not
documented; a test compiles with them.
"""

import sys
from functools import cache
from typing import Any

from numba.core import codegen, compiler, registry, sigutils, typing
from numba.core.compiler_lock import global_compiler_lock

# numba is typed in part only
_compiler: Any = compiler
_sigutils: Any = sigutils
_typing: Any = typing
_Library: Any = codegen.JITCodeLibrary
_Dispatcher: Any = registry.CPUDispatcher


@cache
def _load_arrays() -> None:
    """Load what numba knows of arrays, without scipy.linalg, which would be a tenth of a run's start.

    numba asks there whether it may multiply matrices by BLAS, and loads it again before it does so: the answer is yes.
    """
    if "scipy.linalg" in sys.modules:
        return
    sys.modules["scipy.linalg"] = None  # type: ignore[assignment]  # Python's word for a module that cannot be imported
    try:
        from numba.np import arraymath
    finally:
        del sys.modules["scipy.linalg"]
    vars(arraymath)["_HAVE_BLAS"] = True


class _Piece(_Library):  # type: ignore[misc]
    """The code of a function for its callers, which link what it calls."""

    def finalize(self) -> None:
        """Leave the code as it is."""
        self._finalized = True

    @property
    def whole(self) -> list[Any]:
        """This code and all that it calls."""
        return [self, *self._linking_libraries]


class Inlined(_Dispatcher):  # type: ignore[misc]
    """A compiled function that compiled callers take in; called from Python it is code of its own."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self._pieces: dict[tuple[Any, ...], Any] = {}

    def compile(self, sig: Any) -> Any:
        """Compile for a signature, or load what was compiled."""
        _load_arrays()
        return super().compile(sig)

    def get_call_template(self, args: Any, kws: Any) -> Any:
        """Return what types a call from compiled code."""
        pysig, args = self._compiler.fold_argument_types(args, kws)
        name = self.py_func.__name__
        template = _typing.make_concrete_template(f"Inlined({name})", name, [self._piece(tuple(args)).signature])
        return template, pysig, args, {}

    def get_overload(self, sig: Any) -> Any:
        """Return the key under which the code for a signature is registered."""
        args, _ = _sigutils.normalize_signature(sig)
        return self._pieces[tuple(args)].fndesc

    def _piece(self, args: tuple[Any, ...]) -> Any:
        found = self._pieces.get(args)
        if found is None:
            flags = _compiler.Flags()
            self.targetdescr.options.parse_as_flags(flags, self.targetoptions)
            flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
            context = self.targetctx
            with global_compiler_lock:
                code: Any = _Piece(context.codegen(), self.py_func.__qualname__)
                found = _compiler.compile_extra(
                    self.typingctx, context, self.py_func, args, None, flags, {}, library=code
                )
                context.insert_user_function(found.fndesc, found.fndesc, code.whole)
            self._pieces[args] = found
        return found
