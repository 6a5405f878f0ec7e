"""Scenarios, and the step of the server as fast as it goes, without a bus."""
