"""YAML -> checked description -> assembled bench: the only place that picks a class by its name."""

from typing import TYPE_CHECKING, Any

from hilplant.checked_yaml.problems import BenchError, Problem

if TYPE_CHECKING:
    from hilplant.bench.assembly import Bench, check_bench, load_bench

__all__ = ["Bench", "BenchError", "Problem", "check_bench", "load_bench"]


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from hilplant.bench import assembly  # only now: it loads the compiler, which a problem does not need

    return getattr(assembly, name)
