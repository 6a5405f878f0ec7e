"""The group `hilplant train`: what is fitted to a bench's physical plant."""

from hilplant.cli.groups import group_app

app = group_app(
    __name__,
    short_help="Fit fast stand-ins to a bench's physical plant.",
    help="Fit fast stand-ins to a bench's physical plant, each with a report of its errors.",
    epilog="Example: hilplant train torque default --out trained",
)
