"""`hilplant list`."""

from typing import Annotated

import typer

from hilplant.cli.groups import command_app
from hilplant.cli.options import JsonFile, write_json

app = command_app()


@app.command("list", epilog="Example: hilplant list motors")
def list_parts(
    kind: Annotated[
        str, typer.Argument(help="motors, linkages, screens, benches, scenarios, controllers, faults, profiles, ...")
    ] = "",
    json_file: JsonFile = None,
) -> None:
    """List what is shipped of a kind, with source and status.

    Without a kind: how many there are of each.
    """
    from hilplant.cli.report import print_report
    from hilplant.inventory.shipped_parts import cited, kinds, listed
    from hilplant.thesis.text_table import TextTable

    if not kind:
        counts = {each: len(listed(each)) for each in kinds()}
        print_report([TextTable("", ("kind", "shipped"), [(name, str(n)) for name, n in counts.items()], True)])
        write_json(json_file, counts)
        return
    parts = listed(kind)
    rows = [(part.name, part.status, part.about, cited(part.source)) for part in parts]
    print_report([TextTable("", ("name", "status", "what", "source"), rows)])
    write_json(json_file, {part.name: part._asdict() for part in parts})
