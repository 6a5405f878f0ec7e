"""The page beside a run: its process is started with the run and ends with it."""

import contextlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

from hilplant.bench import Bench
from hilplant.channel.run_files import RunFile
from hilplant.companion import Companion, companion
from hilplant.extras import need

#: Where the stalk's moves go: to the bus, or as lines to the program that started the page.
STALK_ON_BUS, STALK_AS_LINES, NO_STALK = "bus", "lines", ""


@dataclass(frozen=True, slots=True)
class PageOptions:
    """What a page is to be: its address as written, where its logs go, whether a browser opens, who has the stalk."""

    address: str = ""
    logs: Path = Path("hilplant-logs")
    browser: bool = False
    stream: str = ""
    stalk: str = STALK_ON_BUS


@contextmanager
def page_beside(bench: Bench, run: RunFile, options: PageOptions | None) -> Iterator[Companion | None]:
    """Serve a page of a run until the block ends; what it said when it was ready is its address.

    Raises
    ------
    Failure
        When it cannot be served.
    """
    if options is None:
        with contextlib.nullcontext():
            yield None
        return
    need("web")
    from hilplant.operator_page.description import describe  # takes a fifth of a second, which a run without has

    reachable = bench.interface.get("interface") != "virtual"
    order = {
        "run": asdict(run),
        "description": describe(bench),
        "bench_path": str(bench.path),
        "interface": bench.interface,
        "address": options.address,
        "logs": str(options.logs.absolute()),
        "browser": options.browser,
        "stream": options.stream,
        "stalk": options.stalk if reachable or options.stalk != STALK_ON_BUS else NO_STALK,
        "loop_cpu": bench.loop.cpu,
    }
    with companion("hilplant.operator_page.server", order, "the page's process did not start") as served:
        yield served
