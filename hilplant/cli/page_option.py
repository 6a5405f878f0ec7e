"""Where a page is served: `--page [HOST:PORT]` beside a run, where the address may be left out; else `--address`."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand

if TYPE_CHECKING:
    from hilplant.operator_page.beside_run import PageOptions

_OPTION = "--page"
_ADDRESS = re.compile(r"\d+|\S*:\d+")

PageAddress = Annotated[
    str | None,
    typer.Option(_OPTION, metavar="[HOST:PORT]", help="serve a page for the operator  [127.0.0.1:8765]"),
]
PageServedAt = Annotated[
    str, typer.Option("--address", metavar="HOST:PORT", help="where the page is served  [127.0.0.1:8765]")
]
PageLogs = Annotated[Path, typer.Option("--logs", help="with --page: folder of what is logged on the page")]
Stream = Annotated[
    str, typer.Option("--stream", metavar="udp:HOST:PORT", help="with --page: send rows as JSON, as for PlotJuggler")
]
Browser = Annotated[bool, typer.Option("--browser", help="with --page: open it in your browser")]
LOGS = Path("hilplant-logs")


class WithPage(TyperCommand):
    """A command whose `--page` may stand without an address."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Give a bare `--page` an empty address."""
        given = list(args)
        for index, word in enumerate(given):
            if word == _OPTION and not _ADDRESS.fullmatch((given[index + 1 :] or [""])[0]):
                given[index] = f"{_OPTION}="
        return super().parse_args(ctx, given)


def page_options(address: str | None, logs: Path, browser: bool, stream: str = "") -> "PageOptions | None":
    """Return what is asked for; None without `--page`."""
    if address is None:
        return None
    from hilplant.operator_page.beside_run import PageOptions

    return PageOptions(address, logs, browser, stream)
