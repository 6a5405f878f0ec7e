"""Rigid-body mechanics, worked out before the first tick."""
