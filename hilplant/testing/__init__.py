"""Tests of an ECU on the plant: scenarios run and judged, in virtual time or from a recording; a plugin for pytest."""
