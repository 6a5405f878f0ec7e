"""Measurements of a real wiper: read, checked, and brought onto one clock."""
