"""On what the figures were measured."""

import os
import platform
from importlib.metadata import version
from pathlib import Path

_CPU_INFORMATION = Path("/proc/cpuinfo")


def cpu_model(information: str) -> str:
    """Return the processor's name from the text of /proc/cpuinfo, else what the platform says."""
    for line in information.splitlines():
        key, _, value = line.partition(":")
        if key.strip() in ("model name", "Model", "Hardware") and value.strip():
            return value.strip()
    return platform.processor() or platform.machine()


def machine() -> dict[str, float | str]:
    """Return what the figures depend on, by the names that the JSON file uses."""
    information = _CPU_INFORMATION.read_text() if _CPU_INFORMATION.exists() else ""
    return {
        "machine_cpu": cpu_model(information),
        "machine_cores": os.cpu_count() or 0,
        "machine_kernel": f"{platform.system()} {platform.release()}",
        "machine_python": platform.python_version(),
        "machine_numba": version("numba"),
        "machine_load_average": round(os.getloadavg()[0], 2),
    }


def is_user_mode_linux() -> bool:
    """Whether this kernel is itself a program on another one, where times are several times longer."""
    return _CPU_INFORMATION.exists() and "User Mode Linux" in _CPU_INFORMATION.read_text()
