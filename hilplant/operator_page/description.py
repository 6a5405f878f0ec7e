"""What a page is told once: signals, wiper, chart, faults, profiles; all from the bench and the declarations."""

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from hilplant.arrays import Floats
from hilplant.bench import Bench
from hilplant.channel.run_files import columns
from hilplant.declaration import Signal
from hilplant.ecu.chart import CHART
from hilplant.faults.catalogue import BY_NAME
from hilplant.faults.fault import FaultDefinition
from hilplant.mechanics.motion import motion
from hilplant.mechanics.planar import Pin, Revolute
from hilplant.mechanics.wiper import Wiper, WiperSide
from hilplant.operator_page.scenario_play import known_scenarios
from hilplant.resources import shipped
from hilplant.runtime.commands import OWNERS
from hilplant.signals import ECU_RX_INDEX, ECU_STATUS, INPUTS, OUTPUTS, STATUS
from hilplant.simulation.supply_profiles import load_profile
from hilplant.units import SECOND_NS, TURN_RAD

#: Crank angles at which the wiper's picture is told; between them it turns by less than a pixel.
_PICTURES = 361
_MICROMETRE = 6  # decimals of a metre


def describe(bench: Bench) -> dict[str, Any]:
    """Return the description, ready for JSON: no infinities, no NaN."""
    return {
        "bench": bench.name,
        "interface": " ".join(str(value) for value in bench.interface.values()),
        "step_s": bench.step_ns / SECOND_NS,
        "columns": [{"name": name, "unit": unit} for name, unit in columns()],
        "inputs": [_signal(each) | {"start": float(bench.input_row[i])} for i, each in enumerate(INPUTS)],
        "outputs": [_signal(each) for each in OUTPUTS],
        "status": [_signal(each) for each in STATUS],
        "owners": list(OWNERS),
        "ecu": {
            "automatic": any(ECU_RX_INDEX["automatic"] in each.sources for each in bench.ecu_messages.driver),
            "states": list(ECU_STATUS[0].choices),
            "faults": list(ECU_STATUS[1].choices),
            "rows": [
                {
                    "from": [phase.value for phase in row.sources],
                    "to": row.target.value,
                    "when": row.condition.words,
                    "fault": row.fault.value if row.fault else "",
                }
                for row in CHART
            ],
        },
        "circuit": bench.plant.park_switch.circuit,
        "faults": [_fault(each) for each in BY_NAME.values()],
        "profiles": _profiles(),
        "scenarios": known_scenarios(),
        "wiper": _wiper(bench.plant.mechanics.wiper),
    }


def _signal(signal: Signal) -> dict[str, Any]:
    told = asdict(signal)
    told["minimum"], told["maximum"] = (
        value if math.isfinite(value) else None for value in (signal.minimum, signal.maximum)
    )
    return {key: told[key] for key in ("name", "unit", "minimum", "maximum", "meaning", "kind", "choices", "names")}


def _fault(fault: FaultDefinition) -> dict[str, Any]:
    return {
        "name": fault.name,
        "kind": fault.kind,
        "meaning": fault.meaning,
        "effect": fault.effect,
        "quantities": [asdict(quantity) for quantity in fault.quantities],
        "on_frames": fault.on_frames is not None,
        "about": list(fault.about),
    }


def _profiles() -> list[dict[str, Any]]:
    found = []
    for path in sorted(shipped("config", "profiles").glob("*.yaml")):
        profile = load_profile(path)
        found.append({"name": path.stem, "title": profile.title, "cannot_show": profile.cannot_show or ""})
    return found


def _wiper(wiper: Wiper) -> dict[str, Any]:
    """Return lines and fixed points [m]; each moving line has its points at even crank angles of one turn."""
    turn = motion(wiper, np.linspace(0.0, TURN_RAD, _PICTURES)).coordinates
    lines = [
        {"part": "crank" if body.name == wiper.mechanism.driven else "link", "name": body.name}
        | _points(wiper, turn, [body.first_end, body.second_end])
        for body in _linkage(wiper)
    ]
    for side in wiper.sides:
        lines += [
            {"part": part, "name": side.name} | _points(wiper, turn, pins) for part, pins in _carried(wiper, side)
        ]
    pivots = [wiper.mechanism.point(turn[:1], pin)[0] for pin in _ground_pins(wiper)]
    return {"lines": lines, "pivots": np.round(pivots, _MICROMETRE).tolist(), "pictures": _PICTURES}


def _linkage(wiper: Wiper) -> list[Any]:
    carried = {name for side in wiper.sides for name in side.bodies}
    return [body for body in wiper.bodies if body.name not in carried and body.name != "ground"]


def _carried(wiper: Wiper, side: WiperSide) -> list[tuple[str, list[Pin]]]:
    bodies = {body.name: body for body in wiper.bodies}
    rods = [bodies[name] for name in side.bodies if "_arm_" in name]
    found = [("arm", [rods[0].first_end, *(rod.second_end for rod in rods)])]
    return [*found, ("blade", [side.tips[0], side.centre, side.tips[1]])] if side.tips else found


def _ground_pins(wiper: Wiper) -> list[Pin]:
    turning = [joint for joint in wiper.joints if isinstance(joint, Revolute)]
    return [pin for joint in turning for pin in (joint.first, joint.second) if pin[0] == "ground"]


def _points(wiper: Wiper, turn: Floats, pins: list[Pin]) -> dict[str, Any]:
    """Return x and y of each pin over the turn, [pictures][pins][2] flattened."""
    places = np.stack([wiper.mechanism.point(turn, pin) for pin in pins], axis=1)
    return {"points": len(pins), "xy": np.round(places.reshape(-1), _MICROMETRE - 2).tolist()}
