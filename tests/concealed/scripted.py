"""A diagnosis of known behaviour: what scoring must find of it is known beforehand."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

from calib.recording.open import open_recording
from tests.concealed.generator.catalogue import LISTED, UNLISTED
from tests.concealed.scoring.outcome import Finding, Outcome, Truth
from tests.concealed.scoring.rates import ideal_threshold

NAMES = sorted(LISTED)


def consistent(recording: Path) -> dict[str, Any]:
    """Read every code, and find nothing."""
    opened = open_recording(recording)
    n = sum(len(dn) for b in opened.header.blocks for dn in opened.frames(b.block))
    assert n > 0
    assert opened.warnings == ()
    return {"verdict": "consistent", "findings": [], "unexplained": None, "not_testable": []}


def failing(recording: Path) -> dict[str, Any]:
    raise RuntimeError(f"no diagnosis of {len(recording.name)} letters")


def named(
    kind: str,
    truths: tuple[Truth, ...],
    findings: tuple[Finding, ...],
    *,
    unexplained: bool = False,
) -> Outcome:
    verdict = "explained" if findings else "unexplained" if unexplained else "consistent"
    return Outcome(0, kind, truths, verdict, findings, unexplained)


def truth(name: str, sigma: float, *, known_shape: bool = True) -> Truth:
    return Truth(name, name in LISTED, known_shape, 0.5, sigma)


def finding(name: str, probability: float, *others: str) -> Finding:
    rest = (1.0 - probability) / max(1, len(others))
    candidates = ((name, probability), *((other, rest) for other in others))
    return Finding(name, probability, candidates, 0.97)


def honest_run(rng: Generator, loss: float = 1.0, repeats: int = 60) -> Iterator[Outcome]:
    """A detector that needs `loss` times the ideal sight and keeps its stated probabilities."""
    for name in NAMES:
        for sigma in np.geomspace(0.5, 200.0, repeats):
            yield _single(rng, name, float(sigma), loss)
    for _ in range(300):
        alarm = (finding(str(rng.choice(NAMES)), 0.6, "lag"),) if rng.random() < 0.02 else ()
        yield named("clean", (), alarm)
    for name in UNLISTED:
        for _ in range(20):
            swallowed = rng.random() < 0.03
            swallower = (finding("lamp_drift", 0.9, "lag"),) if swallowed else ()
            yield named("unlisted", (truth(name, 40.0),), swallower, unexplained=not swallowed)
    for kind, n, rate in (("double", 2, 0.93), ("triple", 3, 0.8)):
        for _ in range(100):
            names = rng.choice(NAMES, n, replace=False)
            kept = names if rng.random() < rate else names[:-1]
            found = tuple(finding(str(one), 0.99, "lag") for one in kept)
            yield named(kind, tuple(truth(str(one), 20.0) for one in names), found)


def _single(rng: Generator, name: str, sigma: float, loss: float) -> Outcome:
    seen = abs(sigma / loss + rng.standard_normal()) > ideal_threshold()
    if not seen:
        return named("single", (truth(name, sigma),), ())
    probability = float(rng.uniform(0.5, 1.0))
    other = str(rng.choice([one for one in NAMES if one != name]))
    right = rng.random() < probability
    first, second = (name, other) if right else (other, name)
    return named("single", (truth(name, sigma),), (finding(first, probability, second),))
