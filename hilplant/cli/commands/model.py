"""`hilplant model`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.page_option import PageServedAt
from hilplant.extras import need

app = command_app()


@app.command(epilog="Example: hilplant model my_wiper/bench.yaml")
def model(
    bench: Annotated[
        str, typer.Argument(help="a bench file, or the name of a shipped bench", metavar="BENCH")
    ] = "figure_8_3",
    address: PageServedAt = "",
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="open the page in the browser")] = True,
) -> None:
    """Describe, check and identify a wiper on a page; make a bench.

    Without BENCH the printed defaults of the thesis' Figure 8-3. Ends on Ctrl-C; what was not saved is lost then.
    """
    need("web")
    from hilplant.modelling.page import serve_modelling
    from hilplant.web.serving import Address, open_browser

    def ready(url: str) -> None:
        typer.echo(f"the page is at {url}")
        if browser:
            open_browser(url)

    serve_modelling(bench, Address.parse(address), ready)
