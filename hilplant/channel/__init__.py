"""Beside the loop: what other programs see of a run, and how they take part in it."""
