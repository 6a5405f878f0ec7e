"""A run that is killed half-way goes on where it was: every cost that was computed is kept in a file.

All searches are deterministic, so a run that begins again asks for the same sets in the same order. What the journal
holds is answered from it, at once; the rest is computed. The result is the same, bit for bit, for any optimiser, and
nothing of an optimiser's inside has to be stored.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np

from hilplant.arrays import Floats
from hilplant.atomic_write import cannot_be_written
from hilplant.failure import Failure


class Journal:
    """Costs in the order in which they were asked for, with a digest of each population.

    The file is replaced as a whole after each population, so a kill leaves the one before.
    """

    def __init__(self, path: Path, identity: str, resume: bool) -> None:
        self.path, self.identity = path, identity
        self._costs: list[Floats] = []
        self._digests: list[str] = []
        self._next = 0
        if resume and path.exists():
            self._read()

    def _read(self) -> None:
        try:
            with np.load(self.path, allow_pickle=False) as file:
                identity, digests = str(file["identity"]), [str(each) for each in file["digests"]]
                costs, lengths = file["costs"], file["lengths"]
        except (OSError, ValueError, KeyError, EOFError) as error:
            text = "is no journal of an identification; leave out --resume to begin anew"
            raise Failure(f"{self.path}: {text}") from error
        if identity != self.identity:
            text = "data, bench, seed or settings are others; begin anew without --resume"
            raise Failure(f"{self.path}: belongs to another identification: {text}")
        self._digests = digests
        self._costs = np.split(costs, np.cumsum(lengths)[:-1]) if len(lengths) else []

    @property
    def known(self) -> int:
        """How many populations it holds."""
        return len(self._costs)

    def answering(self, evaluate: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
        """Return `evaluate`, answered from the journal as long as that reaches, and kept in it from there on."""

        def answered(sets: Floats) -> Floats:
            digest = hashlib.sha256(np.ascontiguousarray(sets).tobytes()).hexdigest()[:16]
            if self._next < len(self._costs):
                if self._digests[self._next] != digest:
                    text = "a package that draws random numbers has changed; begin anew without --resume"
                    raise Failure(f"{self.path}: does not fit what is asked now: {text}")
            else:
                self._costs.append(np.array(evaluate(sets)))
                self._digests.append(digest)
                self._write()
            self._next += 1
            return self._costs[self._next - 1].copy()

        return answered

    def _write(self) -> None:
        new = self.path.with_name(f"{self.path.name}.new")
        lengths = np.array([len(each) for each in self._costs])
        try:
            with open(new, "wb") as file:
                np.savez(
                    file, identity=np.array(self.identity), digests=np.array(self._digests), lengths=lengths,
                    costs=np.concatenate(self._costs),
                )  # fmt: skip
                file.flush()
                os.fsync(file.fileno())
            os.replace(new, self.path)
        except OSError as error:
            raise cannot_be_written(self.path, error) from error

    def remove(self) -> None:
        """Delete the file: the run has come to its end."""
        self.path.unlink(missing_ok=True)
