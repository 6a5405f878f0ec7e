"""Linkages as descriptions."""

from typing import Any

import yaml

from hilplant.mechanics.assembly import Description

WATT = """
points: {O: [0, 0], A: [0.0445, 0.0055], B: [-0.2240, -0.0218], C: [-0.2720, 0.0270],
         D: [-0.2345, -0.0111], E: [0.2325, -0.0175], F: [0.2030, 0.0270]}
bodies: {crank: [O, A], coupler: [A, B], left_rocker: [B, C, D], link: [D, E], right_rocker: [E, F]}
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, left_rocker]}
  - {revolute: C, bodies: [left_rocker, ground]}
  - {revolute: D, bodies: [left_rocker, link]}
  - {revolute: E, bodies: [link, right_rocker]}
  - {revolute: F, bodies: [right_rocker, ground]}
"""
#: The link hangs on the coupler instead, between its ends.
ON_THE_COUPLER = """
points: {O: [0, 0], A: [0.02, 0.0025], B: [-0.2240, -0.0218], C: [-0.2720, 0.0270],
         D: [-0.2000, -0.0300], E: [0.2325, -0.0300], F: [0.2030, 0.0600]}
bodies: {crank: [O, A], coupler: [A, B, D], left_rocker: [B, C], link: [D, E], right_rocker: [E, F]}
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, left_rocker]}
  - {revolute: C, bodies: [left_rocker, ground]}
  - {revolute: D, bodies: [coupler, link]}
  - {revolute: E, bodies: [link, right_rocker]}
  - {revolute: F, bodies: [right_rocker, ground]}
"""


def described(text: str = WATT, **changes: Any) -> Description:
    return Description(**{**yaml.safe_load(text), **changes})


#: A triangle carried by three links (no pair of bodies settles itself), the first of them swung by the crank.
TRIANGLE = """
points: {O: [0, 0], A: [0.03, 0.0], B: [0.3, 0.0], C: [0.3, 0.2], G: [0.3, 0.3], P: [0.55, 0.1], Q: [0.6, -0.2]}
bodies: {crank: [O, A], coupler: [A, B], plate: [B, C, P], left_rocker: [C, G], right_rocker: [P, Q]}
joints:
  - {revolute: O, bodies: [ground, crank]}
  - {revolute: A, bodies: [crank, coupler]}
  - {revolute: B, bodies: [coupler, plate]}
  - {revolute: C, bodies: [plate, left_rocker]}
  - {revolute: G, bodies: [left_rocker, ground]}
  - {revolute: P, bodies: [plate, right_rocker]}
  - {revolute: Q, bodies: [right_rocker, ground]}
"""
