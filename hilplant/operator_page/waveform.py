"""A supply that changes by itself: sine, repeated points, or a profile, played from the page's process."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from hilplant.failure import Failure
from hilplant.simulation.stimuli import Generated, Shape
from hilplant.simulation.supply_profiles import load_profile

#: How often a new value is sent [s]; what is to be exact to the tick belongs into a scenario.
EVERY_S = 0.01


class Waveform:
    """One waveform at a time, on one input."""

    def __init__(self, send: Callable[[str, float], Awaitable[Any]], ended: Callable[[str], None]) -> None:
        """`send` holds an input at a value; `ended` is told why the waveform is over."""
        self._send, self._ended = send, ended
        self._task: asyncio.Task[None] | None = None
        self.told: dict[str, Any] = {}

    def start(self, name: str, written: dict[str, Any]) -> None:
        """Play ``{"sine": {...}}``, ``{"repeat": {...}}`` or ``{"profile": "..."}`` on the input `name`.

        Raises
        ------
        Failure
            When it cannot be played.
        """
        shape, seconds = _shape(written)
        self.stop()
        self.told = {"input": name, "written": written, "seconds": seconds, "at_s": 0.0}
        self._task = asyncio.create_task(self._play(name, shape, seconds))

    def stop(self) -> None:
        """End it where it is."""
        if self._task is not None:
            self._task.cancel()
        self._task, self.told = None, {}

    async def _play(self, name: str, shape: Shape, seconds: float | None) -> None:
        clock = asyncio.get_running_loop().time
        began_s = clock()
        try:
            while seconds is None or clock() - began_s < seconds:
                self.told["at_s"] = clock() - began_s
                await self._send(name, float(shape(np.array([clock() - began_s]))[0]))
                await asyncio.sleep(EVERY_S)
            await self._send(name, float(shape(np.array([seconds]))[0]))
            self._over("is over")
        except Failure as failure:
            self._over(str(failure))

    def _over(self, why: str) -> None:
        self._task, self.told = None, {}
        self._ended(why)


def _shape(written: dict[str, Any]) -> tuple[Shape, float | None]:
    """Return the values over time and how long they last; None without end."""
    if set(written) - {"sine", "triangle", "square", "repeat", "profile"}:
        raise Failure("a waveform is a sine, triangle, square, repeat or profile")
    try:
        generated = Generated.model_validate(written)
    except ValidationError as error:
        first = error.errors()[0]
        raise Failure(f"waveform: {'.'.join(str(part) for part in first['loc'])}: {first['msg']}") from error
    if generated.profile is not None:
        if Path(generated.profile).name != generated.profile or Path(generated.profile).suffix:
            raise Failure("a profile is named, as in config/profiles")
        profile = load_profile(generated.profile)
        return profile.values, profile.seconds
    return generated.shape(Path()), None
