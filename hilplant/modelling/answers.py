"""What the page asks to be computed at once: simulations, drawings, curves."""

import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from pydantic import ValidationError

from hilplant.bench import Bench
from hilplant.bench.parts import MotorFile
from hilplant.checked_yaml.checked import text_of
from hilplant.failure import Failure
from hilplant.inventory.shipped_parts import cited, listed
from hilplant.modelling.linkage_panel import solve, wiper_drawing
from hilplant.modelling.motor_panel import MotorTest, run_motor
from hilplant.modelling.park_drawing import circuit_states
from hilplant.modelling.recordings import thinned
from hilplant.modelling.session import ModellingSession
from hilplant.simulation.air_forces import air_columns
from hilplant.simulation.crank_torque import WETNESS
from hilplant.simulation.friction_curves import bench_friction, blade_speeds, friction_columns, mu_over_speed
from hilplant.simulation.schema import KINDS, schema_text
from hilplant.units import RAD_PER_S_PER_RPM

Asked = Mapping[str, Any]

#: Crank speeds at which the blades' speeds are marked [turns a minute], forces of the wet curves [N].
TURNS_A_MINUTE, FORCES_N = (40.0, 60.0), (5.0, 10.0, 15.0)
_LIBRARY = ("benches", "motors", "linkages", "screens")


class Answers:
    """Computes what is asked about the model of a session."""

    def __init__(self, session: ModellingSession) -> None:
        """Take the session; `computing` has what can be asked for by its name."""
        self._session = session
        self.computing: dict[str, Callable[[Asked], Any]] = {
            "library": _library,
            "schema": lambda _: {kind: json.loads(schema_text(kind)) for kind in KINDS if kind in _SCHEMAS},
            "drawing": self._drawing,
            "motor": self._motor,
            "solve": self._solve,
            "friction": self._friction,
            "air": lambda _: air_columns(self._bench(), np.linspace(0.0, 40.0, 201)),
            "circuit": lambda asked: circuit_states(str(asked["circuit"])),
        }

    def _bench(self) -> Bench:
        bench = self._session.check().bench
        if bench is None:
            raise Failure("the model has problems; they are listed beside the text")
        return bench

    def _motor(self, asked: Asked) -> dict[str, Any]:
        found = self._session.check()
        numbers = {key: float(asked[key]) for key in asked if key != "switching"}
        test = MotorTest(**numbers, switching=bool(asked.get("switching")))
        section = found.bench.plant.section if found.bench is not None else None
        if test.switching and section is None:
            raise Failure("the switching system is that of the bench, which has problems; leave it out meanwhile")
        curves = run_motor(motor_of(found.values), test, section)
        rows = thinned(len(curves.time_s))
        columns = {name: getattr(curves, name)[rows] for name in ("time_s", "current_a", "output_speed_rad_s")}
        points = {"settled": curves.settled, "closed_form": curves.closed_form}
        named = {name: {mode: at._asdict() for mode, at in each.items()} for name, each in points.items()}
        return columns | named

    def _drawing(self, _: Asked) -> dict[str, Any]:
        bench = self._bench()
        made = wiper_drawing(bench)
        bodies = [{"name": body.name, "part": body.part, "points": body.points} for body in made.bodies]
        screen = bench.plant.screen
        return {
            "bodies": bodies,
            "crank_rad": made.crank_rad,
            "coordinates": made.coordinates,
            "pivots": made.pivots,
            "screen_angle_rad": screen.angle_rad if screen is not None else 0.0,
        }

    def _solve(self, asked: Asked) -> dict[str, Any]:
        numbers = [float(asked[key]) for key in ("crank_speed_rad_s", "seconds", "step_s")]
        solved, forces = solve(self._bench(), *numbers)
        columns = solved.columns()
        rows = thinned(len(solved.time_s)) if not asked.get("all") else np.arange(len(solved.time_s))
        return {
            "columns": {name: values[rows] for name, values in columns.items()},
            "bodies": [track.name for track in solved.tracks],
            "forces": {name: values[rows] for name, values in forces.items()},
        }

    def _friction(self, _: Asked) -> dict[str, Any]:
        bench = self._bench()
        speeds = {f"{turns:g}": blade_speeds(bench, turns * RAD_PER_S_PER_RPM)._asdict() for turns in TURNS_A_MINUTE}
        limit = bench.parameters.load.friction.velocity_limit_mm_s
        highest = 1.05 * max(limit, *(each["largest_mm_s"] for each in speeds.values()))
        grid = np.concatenate([np.linspace(0.0, 100.0, 201), np.linspace(100.0, highest, 300)[1:]])
        found = bench_friction(bench)
        wet = {
            f"mu_wet_{force:g}_n": mu_over_speed(found._replace(force_n=force), WETNESS["wet"], grid)
            for force in FORCES_N
        }
        return {
            "columns": friction_columns(bench, grid) | wet,
            "speeds": speeds,
            "velocity_limit_mm_s": limit,
            "force_n": found.force_n,
        }


_SCHEMAS = ("bench", "motor", "linkage", "screen")


def motor_of(values: Mapping[str, Any]) -> MotorFile:
    """Return the motor among a model's values, whatever else is wrong.

    Raises
    ------
    Failure
        When it is none.

    """
    try:
        return MotorFile.model_validate(values.get("plant", {}).get("motor"))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        raise Failure(f"motor: {'.'.join(map(str, first['loc']))} {text_of(first)}") from None


def _library(_: Asked) -> dict[str, Any]:
    return {
        kind: [{**part._asdict(), "source": cited(part.source)} for part in listed(kind)]
        for kind in _LIBRARY
    }  # fmt: skip
