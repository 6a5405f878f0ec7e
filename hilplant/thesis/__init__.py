"""Reproduction of the thesis' tables and figures; nothing but the command line and tests imports it."""
