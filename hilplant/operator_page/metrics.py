"""The run's health and outputs as Prometheus' text: no secret in it, nothing that can be changed by it."""

import math
from collections.abc import Mapping

from hilplant.arrays import Floats
from hilplant.channel.run_files import columns
from hilplant.declaration import Signal
from hilplant.signals import MODES, OUTPUTS, STATUS

CONTENT_TYPE = "text/plain; version=0.0.4; charset=utf-8"
_PLACES = {name: index for index, (name, _) in enumerate(columns())}


def metrics(row: Floats, refused: Mapping[str, int], pages: int) -> str:
    """Return the text of the newest row."""
    mode = int(row[_PLACES["status.mode"]])
    lines = ["# HELP hilplant_mode what the server is doing: 1 for the mode that is", "# TYPE hilplant_mode gauge"]
    lines += [f'hilplant_mode{{mode="{name}"}} {int(index == mode)}' for index, name in enumerate(MODES)]
    for prefix, group in (("status", STATUS), ("out", OUTPUTS)):
        for signal in group:
            if signal.name != "mode":
                lines += _lines(prefix, signal, float(row[_PLACES[f"{prefix}.{signal.name}"]]))
    lines += ["# HELP hilplant_page_refused_total requests that the page has refused"]
    lines += ["# TYPE hilplant_page_refused_total counter"]
    lines += [f'hilplant_page_refused_total{{reason="{reason}"}} {count}' for reason, count in sorted(refused.items())]
    lines += ["# HELP hilplant_pages pages that are open", "# TYPE hilplant_pages gauge", f"hilplant_pages {pages}"]
    return "\n".join(lines) + "\n"


def _lines(prefix: str, signal: Signal, value: float) -> list[str]:
    grows = signal.kind == "count" and signal.name != "worst_latency_us"
    name = f"hilplant_{prefix}_{signal.name}" + ("_total" if grows else "")
    meaning = f"{signal.meaning} [{signal.unit}]" if signal.unit else signal.meaning
    shown = "NaN" if math.isnan(value) else f"{value:.17g}"
    return [f"# HELP {name} {meaning}", f"# TYPE {name} {'counter' if grows else 'gauge'}", f"{name} {shown}"]
