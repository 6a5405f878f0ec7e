"""Makes `python -m hilplant` the same as `hilplant`."""

from hilplant.cli import main

main()
