"""The study of Table 6-1 and Figure 6-7: networks of 1 to 20 neurons, the mean of three trainings each."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import astuple, dataclass, replace

import numpy as np

from hilplant.progress import OnProgress, ProgressReport, unseen
from hilplant.train.torque import Data, TrainingPlan, one_thread, train_once

#: Trainings of each size.
TRAININGS = 3


@dataclass(frozen=True, slots=True)
class Studied:
    """Means over the trainings of one size: errors [(N m)^2] and time of one training [s]."""

    neurons: int
    harmonics: int
    train: float
    validate: float
    test: float
    total: float
    validation: float
    worst_validation: float
    seconds: float


def study(data: Data, plan: TrainingPlan, sizes: Sequence[int], on_progress: OnProgress = unseen) -> Iterator[Studied]:
    """Yield the figures of each size, with the inputs of `plan`; an interrupt ends the study.

    `on_progress` is told before each training.
    """
    with one_thread():
        for neurons in sizes:
            found = _size(data, replace(plan, neurons=neurons), on_progress)
            if found is None:
                return
            yield found


def _size(data: Data, plan: TrainingPlan, on_progress: OnProgress) -> Studied | None:
    begin, errors = time.perf_counter(), []
    for number in range(TRAININGS):
        on_progress(ProgressReport(f"{plan.neurons} neurons, harmonics {plan.harmonics}, trainings", number, TRAININGS))
        trained = train_once(data, plan, number)
        if trained.interrupted:
            return None
        errors.append(astuple(trained.errors))
    seconds = (time.perf_counter() - begin) / TRAININGS
    train, validate, test, total, validation = (float(value) for value in np.mean(errors, axis=0))
    worst = float(np.max(errors, axis=0)[4])
    return Studied(plan.neurons, plan.harmonics, train, validate, test, total, validation, worst, seconds)
