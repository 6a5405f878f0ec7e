"""What goes wrong for a reason that the user can fix."""


class Failure(Exception):
    """An expected failure; its text is one line that says what is wrong, where, and what would be right."""


class Unfit(Failure):
    """What was asked about was read and judged, and will not do: a command ends with exit code 1, not 2."""
