"""The group `hilplant plot`: pictures."""

from hilplant.cli.groups import group_app

app = group_app(
    __name__,
    short_help="Draw a recording, or what a bench is made of.",
    help="Draw a recording, or what a bench is made of, as a picture: PNG, SVG or PDF.",
    epilog="Example: hilplant plot positions default wiper.png",
)
