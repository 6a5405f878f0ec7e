"""`hilplant doctor`."""

import re

from hilplant.cli.groups import command_app
from hilplant.cli.options import (
    JsonFile,
    write_json,
)

app = command_app()


@app.command(epilog="Example: hilplant doctor")
def doctor(json_file: JsonFile = None) -> None:
    """Say what helps or hinders real time and CAN here.

    With the command that fixes it.
    """
    from hilplant.cli.actions.doctor import print_findings
    from hilplant.doctor import examine

    findings = examine()
    print_findings(findings)
    write_json(json_file, {re.sub(r"\W+", "_", finding.name).lower(): finding.state for finding in findings})
