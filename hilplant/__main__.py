"""Makes `python -m hilplant` the same as `hilplant`."""

from hilplant.cli.main import main

main()
