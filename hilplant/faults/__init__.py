"""Faults by name: what each does to the plant's parameters, when it comes, and when it goes."""
