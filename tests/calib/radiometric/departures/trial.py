"""Prints how far radiance is off with and without a departure's correction, as a Markdown table.

python -m tests.calib.radiometric.departures.trial [RECORDINGS]

Error of radiance in scenes of bars and steps, percent (`cases.radiance_error`), root mean square
over recordings: (a) of sets without the departure, (b) with its true parameters, (c) with
parameters that are fitted to the recording that is calibrated (`fitting`).
"""

import sys
from collections.abc import Iterator

import numpy as np
from numpy.random import Generator, default_rng
from numpy.typing import ArrayLike

from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from tests.calib.radiometric.departures.cases import (
    CASES,
    MODEL,
    Case,
    radiance_error,
    recording,
    scenes,
)
from tests.calib.radiometric.departures.fitting import Fit
from tests.calib.radiometric.in_memory import InMemory

SCENE_LINES = 4096


def one_recording(case: Case, rng: Generator) -> tuple[float, float, float]:
    """Errors (a), (b) and (c), percent; (c) NaN where nothing is to be fitted."""
    recorded, seen = recording(case.model, rng), _seen(case.model, rng)
    plain = radiance_error(calibrate(recorded).coefficients, seen)
    true = radiance_error(calibrate(recorded, model=case.model).coefficients, seen)
    fitted = float("nan")
    if case.fitted:
        found = calibrate(recorded, model=Fit(case, recorded).model())
        fitted = radiance_error(found.coefficients, seen)
    return plain, true, fitted


def rows(recordings: int) -> Iterator[str]:
    """Yield the table's lines."""
    rng = default_rng()
    floor = [
        radiance_error(calibrate(recording(MODEL, rng)).coefficients, _seen(MODEL, rng))
        for _ in range(recordings)
    ]
    yield f"A camera without departures: {rms(floor):.3f} % (noise of scenes and calibration)."
    yield ""
    yield "| departure | (a) without, % | (b) true, % | (c) fitted, % | (c) / (b) |"
    yield "|---|---|---|---|---|"
    for case in CASES:
        errors = np.array([one_recording(case, rng) for _ in range(recordings)])
        a, b, c = (rms(column) for column in errors.T)
        fitted = f"{c:.3f} | {c / b:.2f}" if case.fitted else "– | –"
        yield f"| `{case.name}` | {a:.3f} | {b:.3f} | {fitted} |"


def _seen(model: Model, rng: Generator) -> InMemory:
    return scenes(model, rng, SCENE_LINES)


def rms(values: ArrayLike) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


if __name__ == "__main__":
    for row in rows(int(sys.argv[1]) if len(sys.argv) > 1 else 3):
        sys.stdout.write(row + "\n")
        sys.stdout.flush()
