"""Offline studies: what published measurements say, and fits to them. Nothing here runs with the plant."""
