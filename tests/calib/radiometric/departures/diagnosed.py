"""Prints how far radiance is off by models that a diagnosis arrives at, as a Markdown table.

python -m tests.calib.radiometric.departures.diagnosed [RECORDINGS] [DEPARTURE ...]

Beside the errors that `trial` prints: (a) of sets without the departure, (b) with its true
parameters, (c) with parameters of the known departure fitted to the recording, (d) with the model
that the diagnosis of the recording ends with, whatever names are in it.
"""

import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from numpy.random import Generator, default_rng

from calib.diagnosis.answer.amended import amended_model
from calib.diagnosis.diagnose import diagnose
from calib.errors import DarkflatError
from calib.forward.departure import Departure
from calib.forward.model import Model
from calib.radiometric.calibrate import calibrate
from tests.calib.radiometric.departures.cases import CASES, Case, radiance_error, recording, scenes
from tests.calib.radiometric.departures.fitting import Fit
from tests.calib.radiometric.departures.trial import SCENE_LINES, rms
from tests.calib.radiometric.in_memory import InMemory


@dataclass(frozen=True)
class Outcome:
    """Of one recording: errors (a) to (d), percent, NaN where there is none; names found."""

    errors: tuple[float, float, float, float]
    names: tuple[str, ...]


def outcome(case: Case, rng: Generator) -> Outcome:
    """Draw a recording and scenes, and calibrate in four ways."""
    recorded, seen = recording(case.model, rng), scenes(case.model, rng, SCENE_LINES)
    found = diagnosed(recorded)
    names = tuple(sorted(e.name for e in found.effects if isinstance(e, Departure)))
    fitted = Fit(case, recorded).model() if case.fitted else None
    models = (None, case.model, fitted, found)
    a, b, c, d = (_error(recorded, seen, model) for model in models)
    return Outcome((a, b, c if case.fitted else float("nan"), d), names)


def diagnosed(recorded: InMemory) -> Model:
    """Return the model that `darkflat diagnose --model-out` writes."""
    found = diagnose(recorded)
    return Model.loads(amended_model(found.model, found.evidence, recorded.header.source).dumps())


def rows(recordings: int, cases: Sequence[Case]) -> Iterator[str]:
    """Yield the table's lines."""
    yield "| departure | found | (a) without, % | (b) true, % | (c) fitted, % | (d) diagnosed, % |"
    yield "|---|---|---|---|---|---|"
    rng = default_rng()
    for case in cases:
        every = [outcome(case, rng) for _ in range(recordings)]
        told = Counter(" + ".join(each.names) or "nothing" for each in every)
        found = ", ".join(f"{names} {n}" for names, n in told.most_common())
        a, b, c, d = (rms(column) for column in zip(*(e.errors for e in every), strict=True))
        fitted = f"{c:.3f}" if case.fitted else "–"
        yield f"| `{case.name}` | {found} | {a:.3f} | {b:.3f} | {fitted} | {d:.3f} |"


def _error(recorded: InMemory, seen: InMemory, model: Model | None) -> float:
    try:
        found = calibrate(recorded, model=model).coefficients
        return radiance_error(found, seen)
    except DarkflatError as refusal:
        sys.stderr.write(f"{refusal.code}: {refusal}\n")
        return float("nan")


if __name__ == "__main__":
    wanted = sys.argv[2:]
    chosen = [c for c in CASES if c.name in wanted or not wanted]
    for row in rows(int(sys.argv[1]) if len(sys.argv) > 1 else 3, chosen):
        sys.stdout.write(row + "\n")
        sys.stdout.flush()
