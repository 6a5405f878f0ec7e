"""The group `hilplant study`: the thesis' experiments."""

from hilplant.cli.groups import group_app

app = group_app(
    __name__,
    short_help="Run the thesis' experiments again, beside its tables.",
    help="Run the thesis' experiments again and print them beside its tables.",
    epilog="Example: hilplant study control --out study",
)
