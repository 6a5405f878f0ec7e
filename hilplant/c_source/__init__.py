"""The step in C: translated from the compiled Python, so that there is one step and not two."""
