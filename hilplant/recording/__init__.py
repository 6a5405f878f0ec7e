"""The half of a recording that has time: drain the ring, read, replay, export, draw."""
