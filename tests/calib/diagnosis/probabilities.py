"""Calibrates stated probabilities: by how much do fitted signatures err?

    python -m tests.calib.diagnosis.probabilities draw ORIGIN FIRST COUNT FINDINGS.jsonl
    python -m tests.calib.diagnosis.probabilities fit FINDINGS.jsonl ...

`draw` takes single effects, of shapes that the catalogue has and has not, from the concealed
generator, seeded by an origin of your own; it diagnoses each and writes what every name explains in
the place of what was found. `fit` prints the template error (see
`calib.diagnosis.signatures.template_error`) under which the true names are likeliest, with its
standard uncertainty, and how stated probabilities were kept on the other half of the findings.
"""

import json
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.diagnosis.diagnose import diagnose
from calib.diagnosis.naming.contest import Contest
from calib.diagnosis.naming.judgement import Explained, explained_by, told
from calib.diagnosis.signatures.template_error import TEMPLATE_ERROR, temper
from calib.diagnosis.simulation.fitted_responder import responder_of
from calib.recording.open import open_recording
from tests.concealed.generator.answer import take_case
from tests.concealed.generator.folder import write_folder
from tests.concealed.generator.suite import FULL, suite
from tests.concealed.scoring.intervals import Share

ERRORS = np.geomspace(1e-3, 0.3, 120)
BINS = 5


@dataclass(frozen=True)
class Found:
    """What each name explains, what the best does, and the truth."""

    names: dict[str, Explained]
    gain: float
    truth: str


def drawn(origin: str, first: int, count: int) -> Iterator[Found]:
    """Yield the strongest finding of each recording in which something was found."""
    singles = [case for case in suite(origin, FULL) if case.kind in {"single", "foreign"}]
    for case in singles[first : first + count]:
        with tempfile.TemporaryDirectory() as name:
            taken, answer = take_case(case)
            setting = case.setting
            write_folder(Path(name), setting.sensor, setting.plan, taken, case.rng("instruments"))
            seen = diagnose(open_recording(Path(name)))
        contest = Contest(seen.signatures, seen.evidence, responder_of(seen.evidence))
        gains = [contest.own_gain(seen.model, k) for k in range(len(seen.model.members))]
        if gains:
            k = int(np.argmax(gains))
            names = explained_by(k, seen.model, contest)
            yield Found(names, gains[k], answer.told["effects"][0]["name"])


def likelihood(found: Sequence[Found], error: float) -> float:
    """Return the logarithm of the probability of all truths that any name could have had."""
    total = 0.0
    for one in found:
        if one.truth in one.names:
            tempered = temper(one.gain, error)
            odds = {n: 0.5 * (tempered * e.deviance - e.price) for n, e in one.names.items()}
            top = max(odds.values())
            shares = np.exp([each - top for each in odds.values()])
            total += odds[one.truth] - top - float(np.log(shares.sum()))
    return total


def fit(found: Sequence[Found]) -> tuple[float, float]:
    """Return the likeliest template error, and how far it may be off in its logarithm."""
    curve = np.array([likelihood(found, error) for error in ERRORS])
    best = int(np.argmax(curve))
    near = np.log(ERRORS[curve > curve[best] - 0.5])
    return float(ERRORS[best]), float(np.ptp(near)) / 2.0


def reliability(found: Sequence[Found], error: float) -> Iterator[tuple[float, Share]]:
    """Yield stated probabilities, mean of each bin, and how many of them were right."""
    said = [
        (candidate.probability, candidate.effect == one.truth)
        for one in found
        for candidate in told(one.names, temper(one.gain, error))
    ]
    for k in range(BINS):
        inside = [(p, right) for p, right in said if min(int(p * BINS), BINS - 1) == k]
        if inside:
            yield float(np.mean([p for p, _ in inside])), Share.of(right for _, right in inside)


def main() -> None:
    """Draw, or fit."""
    if sys.argv[1] == "draw":
        origin, first, count, path = sys.argv[2:]
        with Path(path).open("a", encoding="utf-8") as out:
            for one in drawn(origin, int(first), int(count)):
                out.write(json.dumps([one.names, one.gain, one.truth]) + "\n")
                out.flush()
        return
    lines = [line for path in sys.argv[2:] for line in Path(path).read_text("utf-8").splitlines()]
    found = [
        Found({name: Explained(*each) for name, each in names.items()}, gain, truth)
        for names, gain, truth in map(json.loads, lines)
    ]
    error, off = fit(found[::2])
    missing = sum(one.truth not in one.names for one in found)
    print(f"{len(found)} findings, {missing} whose true name explains nothing in their place")
    print(f"template error {error:.4f}, times or over {np.exp(off):.2f}; used: {TEMPLATE_ERROR}")
    for stated, right in reliability(found[1::2], TEMPLATE_ERROR):
        print(f"stated {stated:.3f}, kept {right}")


if __name__ == "__main__":
    main()
