"""A hardware-in-the-loop plant server: virtual windscreen wipers on a real CAN bus, at 1 kHz."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hilplant.bench.assembly import Bench, load_bench
    from hilplant.channel.client import RunChannel, connect
    from hilplant.checked_yaml.problems import BenchError
    from hilplant.simulation.run import Result, simulate

    __version__: str

#: Where each public name comes from; loaded on first use, because the compiler alone takes half a second.
_HOMES = {
    "Bench": "hilplant.bench.assembly",
    "BenchError": "hilplant.checked_yaml.problems",
    "RunChannel": "hilplant.channel.client",
    "Result": "hilplant.simulation.run",
    "connect": "hilplant.channel.client",
    "load_bench": "hilplant.bench.assembly",
    "simulate": "hilplant.simulation.run",
}

__all__ = ["Bench", "BenchError", "Result", "RunChannel", "__version__", "connect", "load_bench", "simulate"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        return _version()
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("hilplant")
    except PackageNotFoundError:  # a checkout that was never installed
        return "0+unknown"
