"""Conversion constants, used only where numbers enter or leave; inside, everything is SI."""

import math

RAD_PER_DEG = math.pi / 180.0
SECOND_NS = 1_000_000_000
MILLISECOND_NS = 1_000_000
MICROSECOND_NS = 1_000
TURN_RAD = 2.0 * math.pi
RAD_PER_S_PER_RPM = TURN_RAD / 60.0
